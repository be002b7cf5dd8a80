//! Kinematics: poses, velocities and accelerations of frames, Jacobians, the centre of mass, momentum, and
//! their contracted second derivatives.
//!
//! For a frame at the point x on the link of joint k, only the joints on the path from the base to k count.
//! With the axis $z\_i$ of joint i through $o\_i$, the column i of its Jacobian has an angular part $w\_i$
//! and a linear part $c\_i = x\_{,i}$:
//!
//! $$ w\_i = z\_i, \quad c\_i = z\_i \times (x - o\_i) \quad\text{(revolute)}, \qquad
//! w\_i = 0, \quad c\_i = z\_i \quad\text{(prismatic)} $$
//!
//! A joint turns everything beyond it as one rigid body. Where i is j or nearer to the base,
//!
//! $$ x\_{,ij} = w\_i \times c\_j, \qquad w\_{j,i} = w\_i \times w\_j, \qquad w\_{i,j} = 0 \quad (i \ne j) $$
//!
//! so that every contracted second derivative is one product for each pair of joints on the path: O(n d) for
//! n joints on paths of d. [`Kinematics`] computes all of this for any scalar.
//!
//! All vectors have the axes of the world of the robot, as in [`Robot::poses`], if not said otherwise. In
//! six-vectors the angular part comes first, as in [`Motion`](crate::spatial::Motion).

mod body;
mod centroidal;
mod columns;
mod contraction;
mod external;
mod frame;
mod joints;
mod logarithm;
mod moment;
mod momentum;
mod momentum_hessian;
mod momentum_term;
mod orientation;
mod pairs;
mod reference_frame;
mod second_order;
mod sweep;
mod term;

pub use centroidal::CentreOfMass;
pub use external::ExternalForces;
pub use frame::Pose;
pub(crate) use joints::Seat;
pub(crate) use logarithm::{curvature, quaternion, rotation_vector};
pub use momentum::Momentum;
pub use orientation::{OrientationContraction, OrientationError};
pub use reference_frame::ReferenceFrame;
pub use second_order::KinematicsSecondOrder;

use crate::error::EvalError;
use crate::kernels::{Coupled, check_entries, rates};
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree, TreeFrame};
use crate::scalar::Scalar;
use crate::spatial::{Inertia, Quaternion, Vec3};
use body::Body;
use columns::Column;
use moment::Moment;
use momentum_term::MomentumTerm;
use pairs::OrderedPairs;
use term::Term;

/// Workspace for the kinematics of one robot; no call allocates.
///
/// [`set_position`](Self::set_position), [`set_state`](Self::set_state) or
/// [`set_motion`](Self::set_motion) place the robot; all other methods read from there. Before the first of
/// them the robot is at rest at q = 0. Frames are given by their position in [`Robot::frames`], which
/// [`Robot::frame_index`] finds. Every method that takes one can fail with [`EvalError::NoFrame`]; those that
/// take slices fail with [`EvalError::WrongLength`] or [`EvalError::NonFinite`]. Weights and desired
/// orientations are factors of the result and not checked: what is not finite in them is not finite in the
/// result.
///
/// ```
/// use costate::kinematics::{Kinematics, ReferenceFrame};
/// use costate::robot::Robot;
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let arm = Robot::from_file("robots/ur5.urdf")?;
/// let tool = arm.frame_index("tool0")?;
/// let mut kinematics = Kinematics::<f64>::new(&arm);
/// kinematics.set_state(&[0.3, -1.2, 0.8, 0.1, 0.5, 0.0], &[0.1; 6])?;
/// let pose = kinematics.pose(tool)?;
/// let twist = kinematics.twist(tool, ReferenceFrame::LocalWorldAligned)?;
/// println!("the tool is at {:?} and moves with {:?}", pose.position, twist.linear);
/// let jacobian = kinematics.jacobian(tool, ReferenceFrame::Local)?;
/// println!("J = {}", jacobian.view().as_nalgebra());
/// // The curvature of the height of the tool over the joint space.
/// let height_qq = kinematics.position_hessian(tool, &[0.0, 0.0, 1.0])?;
/// assert!((height_qq[(1, 2)] - height_qq[(2, 1)]).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Kinematics<S: Scalar> {
    tree: Tree,
    bodies: Vec<Body<S>>,
    /// What the frame or the centre of mass that was asked for last needs of each joint.
    columns: Vec<Column<S>>,
    terms: Vec<Term<S>>,
    pairs: OrderedPairs<S>,
    moments: Vec<Moment<S>>,
    momentum_terms: Vec<MomentumTerm<S>>,
    composites: Vec<Inertia<S>>,
    zero: Vec<S>,
    /// Which joints the quaternions of floating and spherical joints turn, and how.
    orientations: Vec<(usize, Quaternion<S>)>,
    /// Positions, velocities and accelerations of all joints.
    all: [Vec<S>; 3],
    /// A direction and a product with it.
    direction: Vec<S>,
    product: Coupled<Vec<S>>,
    /// 6 x n.
    jacobian: Coupled<Matrix<S>>,
    /// 6 x n.
    jacobian_rate: Coupled<Matrix<S>>,
    /// 3 x n.
    rows: Coupled<Matrix<S>>,
    /// 3 x n.
    rows_rate: Coupled<Matrix<S>>,
    /// n x n.
    square: Coupled<Matrix<S>>,
    /// 2n x 2n.
    whole: Coupled<Matrix<S>>,
}

impl<S: Scalar> Kinematics<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    #[inline(never)]
    pub fn from_tree(tree: Tree) -> Self {
        let n = tree.joints().len();
        let mut kinematics = Self {
            bodies: filled(Body::still(), n),
            columns: filled(Column::zero(), n),
            terms: filled(Term::zero(), n),
            pairs: OrderedPairs::new(n),
            moments: filled(Moment::zero(), n),
            momentum_terms: filled(MomentumTerm::zero(), n),
            composites: tree.joints().iter().map(|joint| joint.inertia.lift()).collect(),
            zero: filled(S::zero(), tree.dof()),
            orientations: tree
                .free()
                .iter()
                .map(|free| (free.joint.turned, Quaternion::constant([0.0, 0.0, 0.0, 1.0])))
                .collect(),
            all: [(); 3].map(|()| filled(S::zero(), n)),
            direction: filled(S::zero(), n),
            product: Coupled::row(&tree),
            jacobian: Coupled::columns(&tree, 6),
            jacobian_rate: Coupled::columns(&tree, 6),
            rows: Coupled::columns(&tree, 3),
            rows_rate: Coupled::columns(&tree, 3),
            square: Coupled::square(&tree),
            whole: Coupled::blocks(&tree),
            tree,
        };
        let zero = std::mem::take(&mut kinematics.zero);
        kinematics.place(&zero, &zero, &zero);
        kinematics.zero = zero;
        kinematics
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// The model.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// Places the robot at q (rad, m; length n), at rest.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn set_position(&mut self, q: &[S]) -> Result<(), EvalError> {
        self.check(&[("q", q)])?;
        self.place_still(q);
        Ok(())
    }

    /// Places the robot at q, v (rad/s, m/s; length n), with the accelerations of the joints zero: every
    /// acceleration is then the bias `Jdot v`.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn set_state(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        self.place_moving(q, v);
        Ok(())
    }

    /// Places the robot at q, v, a (rad/s^2, m/s^2; length n).
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn set_motion(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<(), EvalError> {
        self.check(&[("q", q), ("v", v), ("a", a)])?;
        self.place(q, v, a);
        Ok(())
    }

    /// As [`set_position`](Self::set_position), without a check.
    pub(crate) fn place_still(&mut self, q: &[S]) {
        let zero = std::mem::take(&mut self.zero);
        self.place(q, &zero, &zero);
        self.zero = zero;
    }

    /// These links alone, parents before children, at q (nq), of which `chart` are the [coordinates of
    /// chains](Tree::chart_coordinates) (n).
    pub(crate) fn pose_chart(&mut self, q: &[S], chart: &[S], links: &[usize]) {
        self.orient(q);
        self.pose_links(chart, links);
    }

    /// The same with velocities and accelerations of the chains.
    pub(crate) fn place_moving_chart(&mut self, q: &[S], chart: &[S], [v, a]: [&[S]; 2]) {
        self.orient(q);
        self.place(chart, v, a);
    }

    /// Takes the orientations of floating and spherical joints.
    fn orient(&mut self, q: &[S]) {
        let both = self.orientations.iter_mut().zip(self.tree.free());
        both.for_each(|((_, orientation), free)| *orientation = free.orientation(q));
    }

    /// As [`set_state`](Self::set_state), without a check.
    fn place_moving(&mut self, q: &[S], v: &[S]) {
        let zero = std::mem::take(&mut self.zero);
        self.place(q, v, &zero);
        self.zero = zero;
    }

    /// The matrix of the pairs.
    fn fill_pairs(&mut self) -> &Matrix<S> {
        self.pairs.fill(&self.tree, &mut self.square.all);
        self.square.sum_symmetric(&self.tree);
        self.square.get()
    }

    /// The product of that matrix with d, n.
    fn multiply_pairs(&mut self, d: &[S], product: &mut [S]) {
        rates(&self.tree, d, &mut self.direction);
        self.pairs.multiply(&self.tree, &self.direction, &mut self.product.all);
        self.product.sum(&self.tree);
        product.copy_from_slice(self.product.get());
    }

    /// The frame of this number.
    fn frame(&self, frame: usize) -> Result<TreeFrame, EvalError> {
        let frames = self.tree.frames();
        let last = frames.len().saturating_sub(1);
        frames.get(frame).copied().ok_or(EvalError::NoFrame { frame, last })
    }

    /// The body that carries a frame; `None` for the world.
    fn carrier(&self, frame: &TreeFrame) -> Option<&Body<S>> {
        frame.joint.map(|k| &self.bodies[k])
    }

    /// Every argument has n finite entries.
    fn check(&self, arguments: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        self.tree.refuse_free()?;
        let n = self.tree.dof();
        arguments.iter().try_for_each(|&(what, values)| check_entries(&self.tree, what, values, n))
    }
}

/// Writes a vector to column j of three rows of a matrix.
fn put<S: Scalar>(matrix: &mut Matrix<S>, first: usize, j: usize, value: Vec3<S>) {
    for (row, entry) in value.to_array().into_iter().enumerate() {
        matrix[(first + row, j)] = entry;
    }
}
