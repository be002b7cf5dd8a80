//! The kinematic quantities of one frame as a function of (q, v), for automatic differentiation.

use costate::EvalError;
use costate::derivative::{ByCalls, Function, Hessian, SecondDerivatives};
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::{FrameSpec, Placement, Robot};
use costate::scalar::Scalar;
use costate::spatial::Motion;
use costate_test_support::random_robot::Case;
use costate_test_support::reach::Reach;
use nalgebra::{DMatrix, Rotation3, Vector3};

/// Where the outputs of [`Quantities`] begin.
pub const POSITION: usize = 0;
pub const ORIENTATION: usize = 3;
pub const TWISTS: usize = 6;
pub const CENTRE: usize = 24;
pub const CENTRE_VELOCITY: usize = 27;
pub const ANGULAR: usize = 30;
pub const LINEAR: usize = 33;
const OUTPUTS: usize = 36;

/// Position, orientation error, twists by all three conventions, centre of mass and its velocity, momentum.
#[derive(Clone)]
pub struct Quantities {
    pub robot: Robot,
    pub frame: usize,
    pub desired: Rotation3<f64>,
}

impl Quantities {
    /// For a frame in general position on the last link; the desired orientation is near or far.
    pub fn new(case: &Case) -> Self {
        let on_last = Placement::from_xyz_rpy([0.3, -0.2, 0.5], [0.4, -1.0, 2.0]);
        let tool = FrameSpec::new("tool").on(format!("j{}", case.parts.len() - 1)).placed(on_last);
        let robot = case.robot().with_frame(tool).unwrap();
        let frame = robot.frame_index("tool").unwrap();
        let desired = Rotation3::from_scaled_axis(Vector3::new(case.y[0], case.u[0], -case.y[1]));
        Self { robot, frame, desired }
    }

    /// Magnitudes at a state of the case.
    pub fn reach(&self, case: &Case) -> Reach {
        Reach::of_case(&self.robot, case)
    }

    pub fn kinematics(&self, q: &[f64], v: &[f64]) -> Kinematics<f64> {
        let mut kinematics = Kinematics::new(&self.robot);
        kinematics.set_state(q, v).unwrap();
        kinematics
    }
}

impl Function for Quantities {
    type Workspace<S: Scalar> = Kinematics<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.robot.dof()
    }

    fn outputs(&self) -> usize {
        OUTPUTS
    }

    fn workspace<S: Scalar>(&self) -> Kinematics<S> {
        Kinematics::new(&self.robot)
    }

    fn evaluate<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        x: &[S],
        y: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, v) = x.split_at(self.robot.dof());
        kinematics.set_state(q, v)?;
        let mut put = |start: usize, value: [S; 3]| y[start..start + 3].copy_from_slice(&value);
        put(POSITION, kinematics.pose(self.frame)?.position);
        put(ORIENTATION, kinematics.orientation_error(self.frame, &self.desired)?.vector);
        for (k, axes) in ReferenceFrame::ALL.into_iter().enumerate() {
            let Motion { angular, linear } = kinematics.twist(self.frame, axes)?;
            put(TWISTS + 6 * k, angular.to_array());
            put(TWISTS + 6 * k + 3, linear.to_array());
        }
        let momentum = kinematics.momentum()?;
        put(ANGULAR, momentum.angular);
        put(LINEAR, momentum.linear);
        let centre = kinematics.centre_of_mass()?;
        put(CENTRE, centre.position);
        put(CENTRE_VELOCITY, centre.velocity);
        Ok(())
    }
}

/// All first and second derivatives of the quantities by hyper-dual numbers.
pub struct Judged {
    n: usize,
    value: Vec<f64>,
    jacobian: DMatrix<f64>,
    hessians: Vec<DMatrix<f64>>,
}

impl Judged {
    pub fn at(quantities: &Quantities, q: &[f64], v: &[f64]) -> Self {
        let mut hessian = Hessian::new(ByCalls(quantities.clone()));
        let second = hessian.hessian_tensor(&[q, v].concat()).unwrap();
        Self::from(&second, q.len())
    }

    fn from(second: &SecondDerivatives<'_, f64>, n: usize) -> Self {
        let hessian = |k| DMatrix::from_fn(2 * n, 2 * n, |i, j| second.entry(k, i, j));
        Self {
            n,
            value: second.value().to_vec(),
            jacobian: DMatrix::from_fn(OUTPUTS, 2 * n, |k, i| second.jacobian()[(k, i)]),
            hessians: (0..OUTPUTS).map(hessian).collect(),
        }
    }

    pub fn value(&self, start: usize, count: usize) -> &[f64] {
        &self.value[start..start + count]
    }

    /// The derivatives by q of some outputs.
    pub fn by_q(&self, start: usize, count: usize) -> DMatrix<f64> {
        self.jacobian.view((start, 0), (count, self.n)).into_owned()
    }

    /// The derivatives by v of some outputs.
    pub fn by_v(&self, start: usize, count: usize) -> DMatrix<f64> {
        self.jacobian.view((start, self.n), (count, self.n)).into_owned()
    }

    /// `sum_k w_k d2 y_k` in (q, v).
    pub fn contracted(&self, start: usize, w: &[f64]) -> DMatrix<f64> {
        let zero = DMatrix::zeros(2 * self.n, 2 * self.n);
        w.iter().zip(&self.hessians[start..]).fold(zero, |sum, (&w, hessian)| sum + hessian * w)
    }

    /// The same in q alone.
    pub fn contracted_q(&self, start: usize, w: &[f64]) -> DMatrix<f64> {
        self.contracted(start, w).view((0, 0), (self.n, self.n)).into_owned()
    }
}

/// The acceleration of a frame as a function of (q, v, a).
pub struct Accelerations {
    pub robot: Robot,
    pub frame: usize,
    pub axes: ReferenceFrame,
}

impl Function for Accelerations {
    type Workspace<S: Scalar> = Kinematics<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        3 * self.robot.dof()
    }

    fn outputs(&self) -> usize {
        6
    }

    fn workspace<S: Scalar>(&self) -> Kinematics<S> {
        Kinematics::new(&self.robot)
    }

    fn evaluate<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        z: &[S],
        y: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, rest) = z.split_at(self.robot.dof());
        let (v, a) = rest.split_at(self.robot.dof());
        kinematics.set_motion(q, v, a)?;
        let Motion { angular, linear } = kinematics.acceleration(self.frame, self.axes)?;
        y[..3].copy_from_slice(&angular.to_array());
        y[3..].copy_from_slice(&linear.to_array());
        Ok(())
    }
}
