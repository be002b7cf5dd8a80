//! The power of fixed weights on all frames, as one function for the comparison of methods.

use super::function::Function;
use super::row::matrix;
use crate::error::{EvalError, check_length};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::matrix::Matrix;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};

/// `(q, v) -> sum of W . V` over frames and conventions, from 2n inputs to one output.
///
/// Its first derivatives consist of the Jacobians of the frames and of the derivatives of their twists, its
/// second ones of those of the Jacobians and of the twists. The frames are the last one on each link, and
/// those that a wrench acts on.
#[derive(Clone, Debug)]
pub(super) struct FramePower {
    tree: Tree,
    weighted: Vec<(usize, ReferenceFrame, Force<f64>)>,
}

impl FramePower {
    pub fn new(robot: &Robot) -> Self {
        let last = |i: usize| robot.frames().iter().rposition(|frame| frame.joint == Some(i));
        let mut frames: Vec<usize> = (0..robot.joints().len()).filter_map(last).collect();
        frames.extend(robot.wrenches().iter().map(|applied| applied.frame));
        frames.sort_unstable();
        frames.dedup();
        let all = frames.into_iter().flat_map(|frame| ReferenceFrame::ALL.map(|axes| (frame, axes)));
        // Numbers between -1 and 1 that belong to no symmetry of a robot.
        let weight = |k: usize| [0, 1, 2].map(|part| (1.0 + 2.3 * (3 * k + part) as f64).sin());
        let weighted = all.enumerate().map(|(k, (frame, axes))| {
            let (moment, force) = (Vec3::constant(weight(2 * k)), Vec3::constant(weight(2 * k + 1)));
            (frame, axes, Force { moment, force })
        });
        Self { tree: Tree::from(robot), weighted: weighted.collect() }
    }

    /// The first derivatives, 1 x 2n, and the second ones, 2n x 2n, by the formulas of the workspace.
    #[inline]
    pub fn derivatives<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        q: &[S],
        v: &[S],
    ) -> Result<[Matrix<S>; 2], EvalError> {
        let n = q.len();
        let (mut first, mut second) = (Matrix::zeros(1, 2 * n), Matrix::zeros(2 * n, 2 * n));
        kinematics.set_state(q, v)?;
        for (frame, axes, weight) in &self.weighted {
            let (weight, lifted) = (flat(weight), lift(weight));
            let mut add = |start: usize, rows: &Matrix<S>| {
                for j in 0..n {
                    let terms = weight.iter().enumerate();
                    first[(0, start + j)] +=
                        terms.fold(S::zero(), |sum, (k, &w)| sum + rows[(k, j)].times(w));
                }
            };
            add(0, kinematics.twist_jacobian(*frame, *axes)?);
            add(n, kinematics.jacobian(*frame, *axes)?);
            let hessian = kinematics.twist_hessian(*frame, *axes, &lifted)?;
            second = matrix(2 * n, 2 * n, |i, j| second[(i, j)] + hessian[(i, j)]);
        }
        Ok([first, second])
    }
}

fn flat(weight: &Force<f64>) -> [f64; 6] {
    let ([a, b, c], [d, e, f]) = (weight.moment.to_array(), weight.force.to_array());
    [a, b, c, d, e, f]
}

fn lift<S: Scalar>(weight: &Force<f64>) -> Force<S> {
    Force { moment: Vec3::constant(weight.moment.to_array()), force: Vec3::constant(weight.force.to_array()) }
}

impl Function for FramePower {
    type Workspace<S: Scalar> = Kinematics<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Kinematics<S> {
        Kinematics::from_tree(self.tree.clone())
    }

    fn evaluate<S: Scalar>(
        &self,
        kinematics: &mut Kinematics<S>,
        z: &[S],
        power: &mut [S],
    ) -> Result<(), EvalError> {
        check_length("z", z, self.inputs())?;
        check_length("power", power, self.outputs())?;
        let (q, v) = z.split_at(self.tree.dof());
        kinematics.set_state(q, v)?;
        power[0] = S::zero();
        for (frame, axes, weight) in &self.weighted {
            power[0] += lift::<S>(weight).dot(kinematics.twist(*frame, *axes)?);
        }
        Ok(())
    }
}
