//! Estimates of the work of long chains of joints, to refuse what takes minutes or gigabytes before it
//! starts.
//!
//! The factors were measured on chains of 50 to 1000 revolute joints; the memory fits within a factor of two.

use costate::Coordinates;
use costate::derivative::{CHUNK, ForwardDynamics, FrameMotion, Function, InverseDynamics, PhaseVelocity};
use costate::kinematics::ReferenceFrame;
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, count};

/// The work of one state, or of a whole command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Floating-point operations; 0 where memory alone is the limit.
    operations: f64,
    /// Memory (bytes).
    bytes: f64,
}

/// Most operations that are started without being forced: about a minute.
const MOST_OPERATIONS: f64 = 5e10;

/// Most memory that is allocated without being forced (bytes).
const MOST_BYTES: f64 = 256e6;

/// Most joints for which the operations of one evaluation are counted. Beyond, that would take seconds and
/// hundreds of megabytes; for dynamics the factorisation of M, n^3/6 products and sums, then dominates and is
/// the estimate.
const MOST_COUNTED: usize = 300;

/// Products, and sums, of the motion of a frame for each joint, where they are not counted.
const OF_FRAME: f64 = 100.0;

/// Products, and sums, of inverse dynamics for each joint, likewise.
const OF_TORQUE: f64 = 100.0;

/// Memory of a number of an answer about a frame (bytes).
const ANSWERED: f64 = 35.0;

/// Real operations of one hyper-dual multiplication: nine products, five sums.
const HYPER_DUAL_PRODUCT: f64 = 14.0;

/// Real numbers in a hyper-dual number, so real operations of one sum.
const HYPER_DUAL_SUM: f64 = 4.0;

/// Real numbers in a dual number of `CHUNK`-fold dual numbers.
const NESTED_SUM: f64 = 2.0 * (CHUNK as f64 + 1.0);

/// Real operations of one multiplication of such numbers: three products of `CHUNK`-fold dual numbers and a
/// sum.
const NESTED_PRODUCT: f64 = 3.0 * (3.0 * CHUNK as f64 + 1.0) + CHUNK as f64 + 1.0;

/// Memory of the Christoffel coefficients and their derivatives, in f64 and in one dual number (bytes), for
/// each cube of the depth of a joint.
const TENSOR_BYTES: f64 = 25.0;

/// Time of an operation on dual numbers in Lagrangian coordinates, relative to Hamiltonian ones.
const LAGRANGIAN: f64 = 4.0;

/// Time of an operation on counting numbers, relative to one on f64.
const COUNTING: f64 = 15.0;

/// Size of a counting number, relative to f64.
const COUNTING_SIZE: f64 = 3.0;

/// Numbers that a comparison holds for each number of one evaluation: it runs on f64 and on counting numbers.
const COMPARING_SIZE: f64 = 2.0 * COUNTING_SIZE;

/// How derivatives are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// By hand, generic or as machine code.
    Analytic,
    /// Christoffel coefficients.
    Tensors,
    /// Hyper-dual numbers: one evaluation for each pair of inputs, all second derivatives stored.
    HyperDual,
    /// Dual numbers in dual numbers, `CHUNK` at once.
    Nested,
}

/// The derivatives that a state asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// First derivatives.
    First,
    /// Second ones too.
    Second,
}

impl Work {
    /// That of the answer to one state, its text included.
    pub fn of_state(robot: &Robot, coordinates: Coordinates, method: Method, order: Order) -> Self {
        let n = robot.dof() as f64;
        let second = usize::from(order == Order::Second);
        // Bytes for each entry of an n x n matrix, without and with second derivatives.
        let factor = match (coordinates, method) {
            (Coordinates::Hamiltonian, Method::Analytic | Method::Tensors) => [600.0, 800.0],
            (Coordinates::Lagrangian, Method::Analytic | Method::Tensors) => [950.0, 1500.0],
            (Coordinates::Hamiltonian, Method::HyperDual) => [1100.0, 1300.0],
            (Coordinates::Lagrangian, Method::HyperDual) => [1500.0, 2000.0],
            (Coordinates::Hamiltonian, Method::Nested) => [6200.0, 6400.0],
            (Coordinates::Lagrangian, Method::Nested) => [9500.0, 10_000.0],
        };
        let factorised = n.powi(3) / 6.0;
        let (work, slowness) = match coordinates {
            Coordinates::Hamiltonian => {
                (Self::automatic(&PhaseVelocity::new(robot), robot, method, order, factorised), 1.0)
            }
            Coordinates::Lagrangian => {
                (Self::automatic(&ForwardDynamics::new(robot), robot, method, order, factorised), LAGRANGIAN)
            }
        };
        Self { operations: slowness * work.operations, bytes: work.bytes + factor[second] * n * n }
    }

    /// That of the answer about one frame, its text included; second derivatives are those of its position.
    pub fn of_frame(robot: &Robot, method: Method, order: Order) -> Self {
        let n = robot.dof() as f64;
        let motion = FrameMotion::new(robot, robot.frames().len() - 1, ReferenceFrame::Local);
        let work = Self::automatic(&motion, robot, method, order, OF_FRAME * n);
        let second = if order == Order::Second { n * n } else { 0.0 };
        Self { bytes: work.bytes + ANSWERED * (12.0 + 6.0 * n + second), ..work }
    }

    /// The same several times.
    pub fn times(self, count: usize) -> Self {
        let count = count as f64;
        Self { operations: count * self.operations, bytes: count * self.bytes }
    }

    /// The work of both.
    pub fn and(self, other: Self) -> Self {
        Self { operations: self.operations + other.operations, bytes: self.bytes + other.bytes }
    }

    /// That of counting the operations of all methods in Hamiltonian coordinates.
    pub fn of_count(robot: &Robot) -> Self {
        let hamiltonian = |method| Self::of_state(robot, Coordinates::Hamiltonian, method, Order::Second);
        let (hyper_dual, nested) = (hamiltonian(Method::HyperDual), hamiltonian(Method::Nested));
        Self {
            // The hyper-dual numbers are evaluated twice.
            operations: COUNTING * (2.0 * hyper_dual.operations + nested.operations),
            bytes: COUNTING_SIZE * (hyper_dual.bytes + tensor_bytes(robot)) + nested.bytes,
        }
    }

    /// That of comparing all methods in both coordinates at one state, with counting numbers to bound their
    /// rounding.
    pub fn of_check(robot: &Robot) -> Self {
        let methods = [Method::Analytic, Method::HyperDual, Method::Nested];
        let all = Coordinates::ALL.into_iter().flat_map(|coordinates| methods.map(|m| (coordinates, m)));
        // Counting numbers are as fast in either coordinates.
        let slowness = |coordinates| if coordinates == Coordinates::Lagrangian { LAGRANGIAN } else { 1.0 };
        let works = all.map(|(coordinates, method)| {
            let work = Self::of_state(robot, coordinates, method, Order::Second);
            Self { operations: work.operations / slowness(coordinates), ..work }
        });
        let (method, order) = (Method::HyperDual, Order::Second);
        let uncounted = OF_TORQUE * robot.dof() as f64;
        let torque = Self::automatic(&InverseDynamics::new(robot), robot, method, order, uncounted);
        let start = Self { operations: 0.0, bytes: tensor_bytes(robot) };
        let start = start.and(torque).and(Self::of_frame(robot, method, order));
        let sum = works.fold(start, Self::and);
        Self { operations: COUNTING * sum.operations, bytes: COMPARING_SIZE * sum.bytes }
    }

    /// Scales the operations of one evaluation of the function, of which robots with too many joints to count
    /// them have `uncounted` products and sums; the memory is that of what grows faster than n^2.
    fn automatic(
        function: &impl Function,
        robot: &Robot,
        method: Method,
        order: Order,
        uncounted: f64,
    ) -> Self {
        let (inputs, outputs) = (function.inputs() as f64, function.outputs() as f64);
        let pairs = inputs * (inputs + 1.0) / 2.0;
        let of_evaluation = || if robot.dof() > MOST_COUNTED { [uncounted; 2] } else { operations(function) };
        match method {
            Method::Analytic => Self { operations: 0.0, bytes: 0.0 },
            Method::Tensors => Self { operations: 0.0, bytes: tensor_bytes(robot) },
            // All second derivatives are computed in either case.
            Method::HyperDual => {
                let [products, sums] = of_evaluation();
                Self {
                    operations: pairs * (HYPER_DUAL_PRODUCT * products + HYPER_DUAL_SUM * sums),
                    bytes: 8.0 * outputs * pairs,
                }
            }
            Method::Nested if order == Order::First => Self { operations: 0.0, bytes: 0.0 },
            Method::Nested => {
                let [products, sums] = of_evaluation();
                let evaluations = inputs * (inputs / CHUNK as f64).ceil();
                Self { operations: evaluations * (NESTED_PRODUCT * products + NESTED_SUM * sums), bytes: 0.0 }
            }
        }
    }

    /// Whether it exceeds the limits, so that `--force` is needed.
    pub fn is_excessive(&self) -> bool {
        self.operations > MOST_OPERATIONS || self.bytes > MOST_BYTES
    }
}

/// Refuses to compare all methods at a state of robots for which that is excessive.
///
/// # Errors
/// A message with the estimate, unless `force` is set.
pub fn refuse_excessive(robot: &Robot, force: bool) -> Result<(), String> {
    refuse(robot, Work::of_check(robot), "for each state", force)
}

/// Refuses to count the operations of all methods for robots for which that is excessive.
///
/// # Errors
/// A message with the estimate, unless `force` is set.
pub fn refuse_excessive_count(robot: &Robot, force: bool) -> Result<(), String> {
    refuse(robot, Work::of_count(robot), "in all", force)
}

fn refuse(robot: &Robot, work: Work, each: &str, force: bool) -> Result<(), String> {
    if force || !work.is_excessive() {
        return Ok(());
    }
    Err(format!(
        "{} joints are too many for all methods, which this command runs: {work} {each}; use a smaller robot, or \
         --force",
        robot.dof()
    ))
}

/// Memory of the Christoffel route (bytes): of each joint with all triples of the joints that move it.
fn tensor_bytes(robot: &Robot) -> f64 {
    let mut depths: Vec<f64> = Vec::with_capacity(robot.joints().len());
    for joint in robot.joints() {
        depths.push(1.0 + joint.parent.map_or(0.0, |parent| depths[parent]));
    }
    TENSOR_BYTES * depths.iter().map(|depth| depth.powi(3)).sum::<f64>()
}

/// Multiplications and additions of one evaluation.
fn operations(function: &impl Function) -> [f64; 2] {
    let inputs = function.inputs();
    let mut workspace = function.workspace::<Count>();
    let x: Vec<Count> = (0..inputs).map(|k| Count::variable(0.1 + 0.01 * k as f64)).collect();
    let mut y = vec![Count::zero(); function.outputs()];
    // A singular state ends the evaluation early and makes the estimate too low.
    let (_, counted) = count(|| function.evaluate(&mut workspace, &x, &mut y));
    let products = counted.mul + counted.div + counted.sqrt + counted.sincos + counted.exp;
    [products as f64, counted.add as f64]
}

impl std::fmt::Display for Work {
    /// With the limits, for messages.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { operations, bytes } = self;
        let (megabytes, most) = ((bytes / 1e6).ceil(), MOST_BYTES / 1e6);
        if *operations == 0.0 {
            return write!(f, "about {megabytes} MB (the limit is {most} MB)");
        }
        write!(
            f,
            "about {operations:.0e} operations and {megabytes} MB (the limits are {MOST_OPERATIONS:.0e} and {most} MB)"
        )
    }
}

#[cfg(test)]
#[path = "work/tests.rs"]
mod tests;
