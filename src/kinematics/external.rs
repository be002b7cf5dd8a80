//! Generalised forces of wrenches from outside, with their derivatives.
//!
//! A wrench W = (moment; force) at a frame, constant in its axes or in those of the world, has the
//! generalised force `J'W`: with the power `W . V` of the twist V = J v, its second derivative contracted
//! with y is that of `W . J y`.

use super::{Kinematics, ReferenceFrame};
use crate::error::EvalError;
use crate::kernels::Coupled;
use crate::matrix::Matrix;
use crate::robot::{Tree, TreeFrame, WrenchAxes};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};

/// Workspace for the sum of the generalised forces of all wrenches of a robot; no call allocates.
#[derive(Clone, Debug)]
pub struct ExternalForces<S: Scalar> {
    kinematics: Kinematics<S>,
    wrenches: Vec<Applied<S>>,
    tau: Coupled<Vec<S>>,
    tau_q: Matrix<S>,
    y_tau_qq: Matrix<S>,
}

/// One wrench, where it acts and in which axes it is given.
#[derive(Clone, Copy, Debug)]
struct Applied<S> {
    frame: TreeFrame,
    axes: ReferenceFrame,
    wrench: Force<S>,
}

impl<S: Scalar> ExternalForces<S> {
    /// For the wrenches of a tree; `None` if there are none.
    pub fn new(tree: &Tree) -> Option<Box<Self>> {
        let applied: Vec<_> = tree
            .wrenches()
            .iter()
            .filter_map(|one| {
                let axes = match one.wrench.axes {
                    WrenchAxes::Frame => ReferenceFrame::Local,
                    WrenchAxes::World => ReferenceFrame::LocalWorldAligned,
                };
                let (moment, force) = (Vec3::constant(one.wrench.moment), Vec3::constant(one.wrench.force));
                let frame = *tree.frames().get(one.frame)?;
                Some(Applied { frame, axes, wrench: Force { moment, force } })
            })
            .collect();
        let n = tree.dof();
        (!applied.is_empty()).then(|| {
            Box::new(Self {
                wrenches: applied,
                kinematics: Kinematics::from_tree(tree.clone()),
                tau: Coupled::row(tree),
                tau_q: Matrix::zeros(n, n),
                y_tau_qq: Matrix::zeros(n, n),
            })
        })
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

    /// `tau(q) = sum of J'W`, n (N m, N), at q of length n.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn evaluate(&mut self, q: &[S]) -> Result<&[S], EvalError> {
        self.kinematics.check(&[("q", q)])?;
        Ok(self.force(q))
    }

    /// `tau_q = sum of (J'W)_q`, n x n: row j belongs to `tau_j`.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn linearise(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.check(&[("q", q)])?;
        Ok(self.slopes(q))
    }

    /// `sum_k y_k d2 tau_k / dq dq`, n x n, symmetric, for y of length n.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] or [`EvalError::NonFinite`].
    pub fn contract(&mut self, q: &[S], y: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.kinematics.check(&[("q", q), ("y", y)])?;
        Ok(self.curvature(q, y))
    }

    /// As [`evaluate`](Self::evaluate), without a check.
    #[inline(never)]
    pub(crate) fn force(&mut self, q: &[S]) -> &[S] {
        let Self { kinematics, wrenches, tau, .. } = self;
        kinematics.place_still(q);
        tau.all.fill(S::zero());
        for Applied { frame, axes, wrench } in wrenches {
            let placed = kinematics.look(frame, *axes);
            let seen = placed.seen_from_world(*axes, wrench);
            for j in kinematics.tree.path(frame.joint) {
                tau.all[j] += seen.dot(kinematics.columns[j].motion);
            }
        }
        tau.sum(&kinematics.tree);
        self.tau.get()
    }

    /// As [`linearise`](Self::linearise), without a check.
    #[inline(never)]
    pub(crate) fn slopes(&mut self, q: &[S]) -> &Matrix<S> {
        let Self { kinematics, wrenches, tau_q, .. } = self;
        kinematics.place_still(q);
        tau_q.fill_zero();
        for Applied { frame, axes, wrench } in wrenches {
            add(tau_q, kinematics.contract_columns(frame, *axes, wrench));
        }
        &self.tau_q
    }

    /// As [`contract`](Self::contract), without a check.
    #[inline(never)]
    pub(crate) fn curvature(&mut self, q: &[S], y: &[S]) -> &Matrix<S> {
        let Self { kinematics, wrenches, y_tau_qq, .. } = self;
        kinematics.place_moving(q, y);
        y_tau_qq.fill_zero();
        for Applied { frame, axes, wrench } in wrenches {
            add(y_tau_qq, kinematics.contract_power(frame, *axes, wrench));
        }
        &self.y_tau_qq
    }
}

/// Adds the first rows and columns of `part`.
fn add<S: Scalar>(sum: &mut Matrix<S>, part: &Matrix<S>) {
    for i in 0..sum.rows() {
        sum.row_mut(i).iter_mut().zip(part.row(i)).for_each(|(sum, &part)| *sum += part);
    }
}
