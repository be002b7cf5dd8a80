//! Second derivatives of the momentum of the whole robot.

use super::Kinematics;
use super::body::Body;
use super::columns::{Column, Point};
use super::momentum_term::MomentumTerm;
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::{Force, Inertia, Motion, Vec3};

impl<S: Scalar> Kinematics<S> {
    /// The second derivatives of `k . L + l . P` in x = (q, v), 2n x 2n, symmetric: L the angular
    /// [`momentum`](Self::momentum) about the centre of mass, P the linear one. The block of (v, v) is zero.
    ///
    /// About a point that stays where the centre of mass c is, with `m = (k; l)` and i nearer to the base
    /// than j, the second derivatives of `m . h` are
    ///
    /// ```text
    /// q_i q_j:  n_i . g_j + psi_i . r_j      v_j q_i:  n_i . F_j      v_i q_j:  s_i . r_j
    /// n = m x s    psi = V x s    F = I s    g = s x* h + I psi    r = I n + s x* (I m)
    /// ```
    ///
    /// for the inertia I and momentum h of all that a joint carries: O(n d) products; the motion of c, which
    /// depends on all joints, makes it O(n^2). That c moves subtracts
    /// the second derivatives of `k . (c x P)` at fixed `c = 0`.
    ///
    /// # Errors
    /// [`EvalError::Massless`].
    #[inline(never)]
    pub fn momentum_hessian(&mut self, k: &[S; 3], l: &[S; 3]) -> Result<&Matrix<S>, EvalError> {
        let (mass, total) = self.sum_moments()?;
        self.sum_inertias();
        let (k, l) = (Vec3::from(*k), Vec3::from(*l));
        let [position, velocity, acceleration] = total.centre(mass);
        let linear = self.fill_momentum_terms(
            &Point { position, velocity, acceleration },
            mass,
            Motion { angular: k, linear: l },
        );
        let n = self.tree.joints().len();
        let turned = linear.cross(k);
        self.whole.all.fill_zero();
        for j in 0..n {
            let outer = self.momentum_terms[j];
            for i in self.tree.path(Some(j)) {
                let inner = self.momentum_terms[i];
                let moved = turned.dot(inner.unit.angular.cross(outer.centre));
                let qq = outer.slope.dot(inner.weighted) + outer.pull.dot(inner.rate) - moved;
                self.whole.all[(i, j)] = qq;
                self.whole.all[(j, i)] = qq;
                self.whole.all[(n + i, j)] = outer.pull.dot(inner.unit);
                self.whole.all[(n + j, i)] = outer.momentum.dot(inner.weighted);
            }
        }
        for i in 0..n {
            let MomentumTerm { centre, linear_slope, .. } = self.momentum_terms[i];
            for j in 0..n {
                // k . (c_,i x P_,j) = P_,j . (k x c_,i)
                let across = k.cross(centre);
                let qq = across.dot(self.momentum_terms[j].linear_slope)
                    + k.cross(self.momentum_terms[j].centre).dot(linear_slope);
                self.whole.all[(i, j)] -= qq;
                let vq = across.dot(self.momentum_terms[j].centre).times(mass);
                self.whole.all[(n + j, i)] -= vq;
            }
        }
        for i in 0..n {
            for j in 0..n {
                self.whole.all[(i, n + j)] = self.whole.all[(n + j, i)];
            }
        }
        self.whole.sum_blocks(&self.tree);
        Ok(self.whole.get())
    }

    /// The terms of all joints about a point that stays where `centre` is; the linear momentum of all.
    fn fill_momentum_terms(&mut self, centre: &Point<S>, mass: f64, weight: Motion<S>) -> Vec3<S> {
        let fixed = Point { velocity: Vec3::zero(), acceleration: Vec3::zero(), ..*centre };
        for (j, joint) in self.tree.joints().iter().enumerate() {
            let body = &self.bodies[j];
            let unit = Column::new(&self.tree, &self.bodies, j, &fixed).motion;
            let here = Motion {
                angular: body.angular,
                linear: Point::on(body, centre.position - body.position).velocity,
            };
            let [centre_slope, moved] = self.moment_column(j);
            self.momentum_terms[j] = MomentumTerm {
                unit,
                rate: here.cross(unit),
                weighted: weight.cross(unit),
                slope: momentum_about(&joint.inertia.lift(), body, centre, here),
                centre: centre_slope.times(mass.recip()),
                linear_slope: moved,
                ..MomentumTerm::zero()
            };
        }
        let mut linear = Vec3::zero();
        for (j, joint) in self.tree.joints().iter().enumerate().rev() {
            let own = self.momentum_terms[j];
            match joint.parent {
                Some(parent) => {
                    let sum = &mut self.momentum_terms[parent].slope;
                    *sum = *sum + own.slope;
                }
                None => linear = linear + own.slope.force,
            }
            let (body, composite) = (&self.bodies[j], &self.composites[j]);
            let apply = |motion| momentum_about(composite, body, centre, motion);
            let term = &mut self.momentum_terms[j];
            term.momentum = apply(own.unit);
            term.slope = transported(own.unit, own.slope) + apply(own.rate);
            term.pull = apply(own.weighted) + transported(own.unit, apply(weight));
        }
        linear
    }
}

/// `s x* f = (w x n + c x f ; w x f)`: the rate of a force that moves with s.
fn transported<S: Scalar>(s: Motion<S>, f: Force<S>) -> Force<S> {
    Force { moment: s.angular.cross(f.moment) + s.linear.cross(f.force), force: s.angular.cross(f.force) }
}

/// `I V` in axes of the world about a point, for an inertia in the frame of a body and a motion V given at
/// this point.
fn momentum_about<S: Scalar>(
    inertia: &Inertia<S>,
    body: &Body<S>,
    point: &Point<S>,
    motion: Motion<S>,
) -> Force<S> {
    let arm = body.position - point.position;
    let linear = motion.linear + motion.angular.cross(arm);
    let own = inertia.apply(Motion { angular: body.in_frame(motion.angular), linear: body.in_frame(linear) });
    let force = body.in_world(own.force);
    Force { moment: body.in_world(own.moment) + arm.cross(force), force }
}
