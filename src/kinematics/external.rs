//! Generalised forces of wrenches from outside, with their derivatives.
//!
//! A wrench W = (moment; force) at a frame, constant in its axes or in those of the world, has the
//! generalised force `J'W`: with the power `W . V` of the twist V = J v, its second derivative contracted
//! with y is that of `W . J y`.

use super::{Kinematics, ReferenceFrame};
use crate::error::EvalError;
use crate::kernels::Coupled;
use crate::matrix::Matrix;
use crate::robot::{AppliedWrench, Robot, Tree, TreeFrame, WrenchAxes};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};

/// Workspace for the sum of the generalised forces of all wrenches of a robot; no call allocates.
#[derive(Clone, Debug)]
pub struct ExternalForces<S: Scalar> {
    kinematics: Kinematics<S>,
    wrenches: Vec<Applied<S>>,
    force: Coupled<Vec<S>>,
    force_q: Matrix<S>,
    y_force_qq: Matrix<S>,
}

/// One wrench, where it acts and in which axes it is given.
#[derive(Clone, Copy, Debug)]
struct Applied<S> {
    frame: TreeFrame,
    axes: ReferenceFrame,
    wrench: Force<S>,
}

impl<S: Scalar> ExternalForces<S> {
    /// For the wrenches of a robot, in their order.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(&Tree::from(robot))
    }

    /// For the wrenches of a tree; `None` if there are none.
    pub(crate) fn where_any(tree: &Tree) -> Option<Box<Self>> {
        (!tree.wrenches().is_empty()).then(|| Box::new(Self::from_tree(tree)))
    }

    fn from_tree(tree: &Tree) -> Self {
        let applied = |one: &AppliedWrench| {
            let axes = match one.wrench.axes {
                WrenchAxes::Local => ReferenceFrame::Local,
                WrenchAxes::Aligned => ReferenceFrame::LocalWorldAligned,
            };
            let (moment, force) = (Vec3::constant(one.wrench.moment), Vec3::constant(one.wrench.force));
            Applied { frame: tree.frames()[one.frame], axes, wrench: Force { moment, force } }
        };
        let n = tree.dof();
        Self {
            wrenches: tree.wrenches().iter().map(applied).collect(),
            kinematics: Kinematics::from_tree(tree.clone()),
            force: Coupled::row(tree),
            force_q: Matrix::zeros(n, n),
            y_force_qq: Matrix::zeros(n, n),
        }
    }

    /// Changes wrench `k` of [`Robot::wrenches`](crate::robot::Robot::wrenches) to this moment (N m) and
    /// force (N), in the axes that it was given in.
    ///
    /// # Errors
    /// [`EvalError::NoWrench`], or [`EvalError::BadWrench`] for numbers that are not finite.
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        let count = self.wrenches.len();
        let applied = self.wrenches.get_mut(k).ok_or(EvalError::NoWrench { wrench: k, count })?;
        if S::CHECKED && moment.iter().chain(force).any(|entry| !entry.is_finite()) {
            return Err(EvalError::BadWrench { wrench: k });
        }
        applied.wrench = Force { moment: Vec3::from(*moment), force: Vec3::from(*force) };
        Ok(())
    }

    /// `Q(q) = sum of J'W`, n (N m, N), at q of length n.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn evaluate(&mut self, q: &[S]) -> Result<&[S], EvalError> {
        self.kinematics.check(&[("q", q)])?;
        Ok(self.force(q))
    }

    /// `Q_q = sum of (J'W)_q`, n x n: row j belongs to `Q_j`.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn jacobian(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.check(&[("q", q)])?;
        Ok(self.slopes(q))
    }

    /// `sum_k y_k d2 Q_k / dq dq`, n x n, symmetric, for y of length n.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn hessian(&mut self, q: &[S], y: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.check(&[("q", q), ("y", y)])?;
        Ok(self.curvature(q, y))
    }

    /// As [`evaluate`](Self::evaluate), without a check.
    #[inline(never)]
    pub(crate) fn force(&mut self, q: &[S]) -> &[S] {
        let Self { kinematics, wrenches, force, .. } = self;
        kinematics.place_still(q);
        force.all.fill(S::zero());
        for Applied { frame, axes, wrench } in wrenches {
            let placed = kinematics.look(frame, *axes);
            let seen = placed.seen_from_world(*axes, wrench);
            for j in kinematics.tree.path(frame.joint) {
                force.all[j] += seen.dot(kinematics.columns[j].motion);
            }
        }
        force.sum(&kinematics.tree);
        self.force.get()
    }

    /// As [`jacobian`](Self::jacobian), without a check.
    #[inline(never)]
    pub(crate) fn slopes(&mut self, q: &[S]) -> &Matrix<S> {
        let Self { kinematics, wrenches, force_q, .. } = self;
        kinematics.place_still(q);
        force_q.fill_zero();
        for Applied { frame, axes, wrench } in wrenches {
            add(force_q, kinematics.contract_columns(frame, *axes, wrench));
        }
        &self.force_q
    }

    /// As [`hessian`](Self::hessian), without a check.
    #[inline(never)]
    pub(crate) fn curvature(&mut self, q: &[S], y: &[S]) -> &Matrix<S> {
        let Self { kinematics, wrenches, y_force_qq, .. } = self;
        kinematics.place_moving(q, y);
        y_force_qq.fill_zero();
        for Applied { frame, axes, wrench } in wrenches {
            add(y_force_qq, kinematics.contract_power(frame, *axes, wrench));
        }
        &self.y_force_qq
    }
}

/// Adds the first rows and columns of `part`.
fn add<S: Scalar>(sum: &mut Matrix<S>, part: &Matrix<S>) {
    for i in 0..sum.rows() {
        sum.row_mut(i).iter_mut().zip(part.row(i)).for_each(|(sum, &part)| *sum += part);
    }
}
