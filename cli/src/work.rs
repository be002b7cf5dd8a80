//! Estimates of the work of automatic second derivatives, to refuse chains of hundreds of joints early.

use costate::derivative::{CHUNK, ForwardDynamics, Function, PhaseVelocity};
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, count};

/// The work of one evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Work {
    /// Floating-point operations.
    operations: f64,
    /// Memory for results (bytes).
    bytes: f64,
}

/// Most operations that are started without being forced: about half a minute.
const MOST_OPERATIONS: f64 = 3e10;

/// Most memory that is allocated without being forced (bytes).
const MOST_BYTES: f64 = 256e6;

/// Most joints for which the operations of one evaluation are counted. Beyond, that would take seconds and
/// hundreds of megabytes; the factorisation of M, n^3/6 products and sums, then dominates and is the
/// estimate.
const MOST_COUNTED: usize = 300;

/// Real operations of one hyper-dual multiplication: nine products, five sums.
const HYPER_DUAL_PRODUCT: f64 = 14.0;

/// Real numbers in a hyper-dual number, so real operations of one sum.
const HYPER_DUAL_SUM: f64 = 4.0;

/// Real numbers in a dual number of `CHUNK`-fold dual numbers.
const NESTED_SUM: f64 = 2.0 * (CHUNK as f64 + 1.0);

/// Real operations of one multiplication of such numbers: three products of `CHUNK`-fold dual numbers and a
/// sum.
const NESTED_PRODUCT: f64 = 3.0 * (3.0 * CHUNK as f64 + 1.0) + CHUNK as f64 + 1.0;

/// How second derivatives are computed automatically.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Hyper-dual numbers: one evaluation for each pair of inputs, all second derivatives stored.
    HyperDual,
    /// Dual numbers in dual numbers, `CHUNK` at once.
    Nested,
}

impl Work {
    /// That of all second derivatives of F(q, p).
    pub fn hamiltonian(robot: &Robot, method: Method) -> Self {
        Self::of(&PhaseVelocity::new(robot), robot.dof(), method)
    }

    /// That of all second derivatives of the acceleration a(q, v, u).
    pub fn lagrangian(robot: &Robot, method: Method) -> Self {
        Self::of(&ForwardDynamics::new(robot), robot.dof(), method)
    }

    /// Scales the operations of one evaluation of the function.
    fn of(function: &impl Function, joints: usize, method: Method) -> Self {
        let (inputs, outputs) = (function.inputs() as f64, function.outputs() as f64);
        let [products, sums] = operations(function, joints);
        let pairs = inputs * (inputs + 1.0) / 2.0;
        match method {
            Method::HyperDual => Self {
                operations: pairs * (HYPER_DUAL_PRODUCT * products + HYPER_DUAL_SUM * sums),
                bytes: 8.0 * outputs * pairs,
            },
            Method::Nested => {
                let evaluations = inputs * (inputs / CHUNK as f64).ceil();
                Self {
                    operations: evaluations * (NESTED_PRODUCT * products + NESTED_SUM * sums),
                    bytes: 8.0 * inputs * inputs,
                }
            }
        }
    }

    /// Whether it exceeds the limits, so that `--force` is needed.
    pub fn is_excessive(&self) -> bool {
        self.operations > MOST_OPERATIONS || self.bytes > MOST_BYTES
    }
}

/// Refuses to compare or count all methods for robots whose automatic second derivatives are excessive.
///
/// # Errors
/// A message with the estimate, unless `force` is set.
pub fn refuse_excessive(robot: &Robot, force: bool) -> Result<(), String> {
    let work = Work::lagrangian(robot, Method::HyperDual);
    if force || !work.is_excessive() {
        return Ok(());
    }
    Err(format!(
        "{} joints are too many for hyper-dual numbers, which this command runs among all methods: {work}; use a \
         smaller robot, or --force",
        robot.dof()
    ))
}

/// Multiplications and additions of one evaluation.
fn operations(function: &impl Function, joints: usize) -> [f64; 2] {
    if joints > MOST_COUNTED {
        return [(joints as f64).powi(3) / 6.0; 2];
    }
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
        let megabytes = (bytes / 1e6).ceil();
        write!(
            f,
            "about {operations:.0e} operations and {megabytes} MB for each state (the limits are {MOST_OPERATIONS:.0e} \
             and {} MB)",
            MOST_BYTES / 1e6
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{Method, Work, refuse_excessive};
    use costate::robot::{JointSpec, LinkInertia, Robot};

    fn chain(n: usize) -> Robot {
        let joint = |k: usize| {
            let spec = JointSpec::revolute(format!("j{k}")).axis([0.0, 1.0, 0.3]);
            let spec = spec.carrying(LinkInertia::point(1.0, [0.1, 0.0, -0.3])).armature(0.1);
            if k == 0 { spec } else { spec.on(format!("j{}", k - 1)) }
        };
        (0..n)
            .map(joint)
            .fold(Robot::builder("chain"), |builder, joint| builder.joint(joint))
            .build()
            .unwrap()
    }

    #[test]
    fn long_chains_are_excessive_and_robots_are_not() {
        for (n, excessive) in [(6, false), (12, false), (30, false), (200, true)] {
            for method in [Method::HyperDual, Method::Nested] {
                assert_eq!(Work::hamiltonian(&chain(n), method).is_excessive(), excessive, "{n} {method:?}");
                assert_eq!(Work::lagrangian(&chain(n), method).is_excessive(), excessive, "{n} {method:?}");
            }
            assert_eq!(refuse_excessive(&chain(n), false).is_err(), excessive, "{n}");
            assert!(refuse_excessive(&chain(n), true).is_ok(), "{n}");
        }
    }
}
