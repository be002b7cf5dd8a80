//! Derivatives of positions, twists and Jacobians, contracted with a weight.

use super::body::Body;
use super::columns::{Column, Point};
use super::frame::Placed;
use super::term::Term;
use super::{Kinematics, ReferenceFrame, put};
use crate::error::{EvalError, check_length};
use crate::matrix::Matrix;
use crate::robot::TreeFrame;
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// Derivatives of `h = W . J v` for one pair of joints, i nearer to the base than j.
struct Pair<S> {
    /// `h_,q_i q_j`.
    qq: S,
    /// `h_,v_j q_i = W . J_j,i`.
    outer_moved: S,
    /// `h_,v_i q_j = W . J_i,j`.
    inner_moved: S,
}

impl<S: Scalar> Kinematics<S> {
    /// `w'x_qq` for the position x of the origin of a frame, n x n, symmetric:
    /// `w . (w_i x c_j)` for i nearer to the base; O(d^2) products for d joints on the path.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn position_hessian(&mut self, frame: usize, w: &[S; 3]) -> Result<&Matrix<S>, EvalError> {
        self.pair_positions(frame, w)?;
        Ok(self.fill_pairs())
    }

    /// `(w'x_qq) d` for d of length n, to `product` (n): O(d), without the matrix.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn position_hessian_product(
        &mut self,
        frame: usize,
        w: &[S; 3],
        d: &[S],
        product: &mut [S],
    ) -> Result<(), EvalError> {
        self.check(&[("d", d)])?;
        check_length("product", product, self.dof())?;
        self.pair_positions(frame, w)?;
        self.multiply_pairs(d, product);
        Ok(())
    }

    /// `sum over k, l of W_kl R_kl,qq` for the orientation R of a frame, n x n, symmetric, W given by rows:
    /// `w_i . (B w_j - tr(B) w_j)`, `B = R W'`, for i nearer to the base, since then
    /// `R_,ij = w_i x (w_j x R)`; O(d^2) products for d joints on the path.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn rotation_hessian(&mut self, frame: usize, w: &[[S; 3]; 3]) -> Result<&Matrix<S>, EvalError> {
        let rows = self.pose(frame)?.rotation.map(Vec3::from);
        let weights = w.map(Vec3::from);
        let (frame, _) = self.see(frame, ReferenceFrame::LocalWorldAligned)?;
        self.pairs.take_path(&self.tree, frame.joint);
        let trace = (0..3).fold(S::zero(), |sum, k| sum + rows[k].dot(weights[k]));
        for j in self.tree.path(frame.joint) {
            let axis = self.columns[j].motion.angular;
            let [x, y, z] = axis.to_array();
            let weighted = weights[0].scaled(x) + weights[1].scaled(y) + weights[2].scaled(z);
            let turned = Vec3::from(rows.map(|row| row.dot(weighted)));
            (self.pairs.inner[j], self.pairs.outer[j]) = (axis, turned - axis.scaled(trace));
        }
        Ok(self.fill_pairs())
    }

    /// `dV/dq` of the [`twist`](Self::twist) V at fixed v, 6 x n. Its derivative by v is J.
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn twist_jacobian(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        let (frame, placed) = self.see(frame, axes)?;
        self.jacobian_rate.all.fill_zero();
        for j in self.tree.path(frame.joint) {
            let Motion { angular, linear } = self.twist_slope(j, axes, &placed);
            let local = axes == ReferenceFrame::Local;
            let seen = |a: Vec3<S>| if local { placed.frame.in_frame(a) } else { a };
            put(&mut self.jacobian_rate.all, 0, j, seen(angular));
            put(&mut self.jacobian_rate.all, 3, j, seen(linear));
        }
        self.jacobian_rate.sum_columns(&self.tree);
        Ok(self.jacobian_rate.get())
    }

    /// `(J'W)_q`, n x n, for a weight W = (moment; force) that is constant in the axes of the convention: row
    /// j belongs to column j of J. Not symmetric, except for a force in axes of the world.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn force_jacobian(
        &mut self,
        frame: usize,
        axes: ReferenceFrame,
        weight: &Force<S>,
    ) -> Result<&Matrix<S>, EvalError> {
        let frame = self.frame(frame)?;
        Ok(self.contract_columns(&frame, axes, weight))
    }

    /// The same for a frame of the tree.
    #[inline(never)]
    pub(super) fn contract_columns(
        &mut self,
        frame: &TreeFrame,
        axes: ReferenceFrame,
        weight: &Force<S>,
    ) -> &Matrix<S> {
        let k = self.take_terms(frame, axes, weight);
        self.square.all.fill_zero();
        for j in self.tree.path(k) {
            for i in self.tree.path(Some(j)) {
                let Pair { outer_moved, inner_moved, .. } = self.pair(i, j, axes);
                self.square.all[(j, i)] = outer_moved;
                self.square.all[(i, j)] = inner_moved;
            }
        }
        self.square.sum(&self.tree);
        self.square.get()
    }

    /// The second derivatives of `W . V` in x = (q, v), V the [`twist`](Self::twist), for a weight W that is
    /// constant in the axes of the convention: 2n x 2n, symmetric; the block of (v, v) is zero.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn twist_hessian(
        &mut self,
        frame: usize,
        axes: ReferenceFrame,
        weight: &Force<S>,
    ) -> Result<&Matrix<S>, EvalError> {
        let frame = self.frame(frame)?;
        Ok(self.contract_power(&frame, axes, weight))
    }

    /// The same for a frame of the tree.
    #[inline(never)]
    pub(super) fn contract_power(
        &mut self,
        frame: &TreeFrame,
        axes: ReferenceFrame,
        weight: &Force<S>,
    ) -> &Matrix<S> {
        let (k, n) = (self.take_terms(frame, axes, weight), self.tree.joints().len());
        self.whole.all.fill_zero();
        for j in self.tree.path(k) {
            for i in self.tree.path(Some(j)) {
                let Pair { qq, outer_moved, inner_moved } = self.pair(i, j, axes);
                for (row, column, entry) in [(i, j, qq), (n + j, i, outer_moved), (n + i, j, inner_moved)] {
                    self.whole.all[(row, column)] = entry;
                    self.whole.all[(column, row)] = entry;
                }
            }
        }
        self.whole.sum_blocks(&self.tree);
        self.whole.get()
    }

    /// `a_i = w x w_i`, `b_j = c_j`.
    fn pair_positions(&mut self, frame: usize, w: &[S; 3]) -> Result<(), EvalError> {
        let (frame, _) = self.see(frame, ReferenceFrame::LocalWorldAligned)?;
        self.pairs.take_path(&self.tree, frame.joint);
        let w = Vec3::from(*w);
        for j in self.tree.path(frame.joint) {
            let Motion { angular, linear } = self.columns[j].motion;
            (self.pairs.inner[j], self.pairs.outer[j]) = (w.cross(angular), linear);
        }
        Ok(())
    }

    /// Columns and terms of the joints on the path of a frame, and its joint. The axes of the convention
    /// `Local` are those of the world turned with the frame: all vectors and W have axes of the world.
    fn take_terms(&mut self, frame: &TreeFrame, axes: ReferenceFrame, weight: &Force<S>) -> Option<usize> {
        let placed = self.look(frame, axes);
        let weight = placed.seen_from_world(axes, weight);
        let Self { tree, columns, bodies, terms, .. } = self;
        for j in tree.path(frame.joint) {
            let column = &columns[j];
            let twist = twist_slope(column, &bodies[j], axes, &placed);
            let (weighted, weighted_rate) = match axes {
                ReferenceFrame::Local => (weight.before(column.motion), weight.before(twist)),
                ReferenceFrame::World => (weight.before(column.motion), Force::zero()),
                ReferenceFrame::LocalWorldAligned => (
                    Force {
                        moment: weight.moment.cross(column.motion.angular),
                        force: weight.force.cross(column.motion.angular),
                    },
                    Force { moment: Vec3::zero(), force: weight.force.cross(column.rate.angular) },
                ),
            };
            terms[j] = Term { twist, weighted, weighted_rate };
        }
        frame.joint
    }

    /// `dV/dq_j` in axes of the world.
    fn twist_slope(&self, j: usize, axes: ReferenceFrame, placed: &Placed<S>) -> Motion<S> {
        twist_slope(&self.columns[j], &self.bodies[j], axes, placed)
    }

    /// With J_i, J_j in axes of the world, V_i the twist of link i:
    ///
    /// ```text
    /// frame:    W . ((V_i x J_i) x J_j)                            J_i,j = J_i x J_j    J_j,i = 0
    /// world:    W . (J_i x V_,j)                                   J_j,i = J_i x J_j    J_i,j = 0
    /// aligned:  m . (w_i x V_,j) + f . (w_i' x c_j + w_i x c_j')   J_j,i = (w_i x w_j ; w_i x c_j)
    ///                                                              J_i,j = (0 ; w_i x c_j)
    /// ```
    fn pair(&self, i: usize, j: usize, axes: ReferenceFrame) -> Pair<S> {
        let (inner, outer, moved) = (&self.terms[i], &self.terms[j], self.columns[j].motion);
        let zero = S::zero();
        match axes {
            ReferenceFrame::Local => {
                let inner_moved = if i == j { zero } else { inner.weighted.dot(moved) };
                Pair { qq: inner.weighted_rate.dot(moved), outer_moved: zero, inner_moved }
            }
            ReferenceFrame::World => {
                let outer_moved = if i == j { zero } else { inner.weighted.dot(moved) };
                Pair { qq: inner.weighted.dot(outer.twist), outer_moved, inner_moved: zero }
            }
            ReferenceFrame::LocalWorldAligned => {
                let linear = inner.weighted.force.dot(moved.linear);
                let turned = if i == j { zero } else { inner.weighted.moment.dot(moved.angular) };
                Pair {
                    qq: inner.weighted.dot(outer.twist) + inner.weighted_rate.force.dot(moved.linear),
                    outer_moved: turned + linear,
                    inner_moved: linear,
                }
            }
        }
    }
}

/// `dV/dq_j`, in axes of the world, with the column J_j at the point of the convention:
///
/// ```text
/// frame:    V_j x J_j             V_j the twist of link j at the origin of the frame
/// world:    J_j x (V - V_j)       V, V_j at the origin of the world
/// aligned:  (w_j x (w - w(j)) ; c_j')     w, w(j) the angular velocities of the frame and of link j
/// ```
fn twist_slope<S: Scalar>(
    column: &Column<S>,
    body: &Body<S>,
    axes: ReferenceFrame,
    placed: &Placed<S>,
) -> Motion<S> {
    let twist_at = |body: &Body<S>, point: Vec3<S>| Motion {
        angular: body.angular,
        linear: Point::on(body, point - body.position).velocity,
    };
    match axes {
        ReferenceFrame::Local => twist_at(body, placed.point.position).cross(column.motion),
        ReferenceFrame::World => {
            let (whole, here) = (twist_at(&placed.frame, Vec3::zero()), twist_at(body, Vec3::zero()));
            column.motion.cross(whole - here)
        }
        ReferenceFrame::LocalWorldAligned => Motion {
            angular: column.motion.angular.cross(placed.frame.angular - body.angular),
            linear: column.rate.linear,
        },
    }
}
