//! The sweep from the last stage to the first.
//!
//! With A = Phi_x and B = Phi_u of a stage, V_x and V_xx of the stage after it:
//!
//! ```text
//! Q_x  = l_x + A'V_x     Q_xx = l_xx + A'V_xx A + V_x'Phi_xx
//! Q_u  = l_u + B'V_x     Q_ux = l_ux + B'V_xx A + V_x'Phi_ux
//!                        Q_uu = l_uu + B'V_xx B + V_x'Phi_uu
//!
//! d = argmin 1/2 d'Q_uu d + Q_u'd  in the box,   K = -Q_uu^-1 Q_ux  in the free rows, 0 in the held ones
//!
//! V_x  = Q_x + K'(Q_u + Q_uu d) + Q_ux'd,        V_xx = Q_xx + K'Q_uu K + K'Q_ux + Q_ux'K
//! ```
//!
//! Exact DDP keeps the three terms V_x'Phi; iLQR, its Gauss-Newton variant, drops them. This is the only
//! difference. The gradient of the total cost comes from the costate y: `y = l_x + A'y`, `dJ/du = l_u + B'y`.

use super::box_qp::{self, Indefinite};
use costate::dynamics::CostHessian;
use costate::matrix::Block;
use costate::step::{StepContraction, StepLinearisation};
use nalgebra::{DMatrix, DVector};

/// Derivatives at one stage. The end of the trajectory is a stage without controls.
pub struct Stage {
    /// Phi_x and Phi_u.
    pub a: DMatrix<f64>,
    pub b: DMatrix<f64>,
    /// l_x, l_u and l_xx, l_ux, l_uu.
    pub l_x: DVector<f64>,
    pub l_u: DVector<f64>,
    pub l_xx: DMatrix<f64>,
    pub l_ux: DMatrix<f64>,
    pub l_uu: DMatrix<f64>,
    /// The used part of V_x'Phi_xx, V_x'Phi_ux and V_x'Phi_uu; zero for Gauss-Newton.
    pub xx: DMatrix<f64>,
    pub ux: DMatrix<f64>,
    pub uu: DMatrix<f64>,
    /// Whether all but the last three belong to the current trajectory.
    pub fresh: bool,
}

impl Stage {
    pub fn zeros(states: usize, controls: usize) -> Self {
        let [xx, ux, uu] = [(states, states), (controls, states), (controls, controls)]
            .map(|(rows, columns)| DMatrix::zeros(rows, columns));
        Self {
            a: xx.clone(),
            b: ux.transpose(),
            l_x: DVector::zeros(states),
            l_u: DVector::zeros(controls),
            l_xx: xx.clone(),
            l_ux: ux.clone(),
            l_uu: uu.clone(),
            xx,
            ux,
            uu,
            fresh: false,
        }
    }

    /// Stores `h` times the derivatives of a cost.
    pub fn set_cost(&mut self, cost: &CostHessian<'_, f64>, h: f64) {
        self.l_x.iter_mut().zip(cost.gradient.x).for_each(|(to, from)| *to = h * from);
        self.l_u.iter_mut().zip(cost.gradient.u).for_each(|(to, from)| *to = h * from);
        set(&mut self.l_xx, cost.xx, h);
        set(&mut self.l_uu, cost.uu, h);
        set_or_clear(&mut self.l_ux, cost.ux, h);
    }

    /// Stores the Jacobians of a step.
    pub fn set_step(&mut self, step: &StepLinearisation<'_, f64>) {
        set(&mut self.a, step.phi_x, 1.0);
        set(&mut self.b, step.phi_u, 1.0);
    }

    /// Stores `share` times the second derivatives of a step.
    pub fn set_curvature(&mut self, step: &StepContraction<'_, f64>, share: f64) {
        set(&mut self.xx, step.xx, share);
        set_or_clear(&mut self.ux, step.ux, share);
        set_or_clear(&mut self.uu, step.uu, share);
    }

    /// Stores zero second derivatives.
    pub fn drop_curvature(&mut self) {
        [&mut self.xx, &mut self.ux, &mut self.uu].into_iter().for_each(|block| block.fill(0.0));
    }

    /// One stage of the recursion: V_x, V_xx and y of the stage after it become those of this one.
    ///
    /// `mu` is added to the diagonal of Q_uu; the box is that of the step in u.
    ///
    /// # Errors
    /// Q_uu, with `mu`, is not positive definite in the free controls.
    pub fn recur(
        &self,
        value: &mut Value,
        mu: f64,
        bounds: [&DVector<f64>; 2],
    ) -> Result<Policy, Indefinite> {
        let Value { v_x, v_xx, y } = value;
        let (a, b) = (&self.a, &self.b);
        let (v_a, v_b) = (&*v_xx * a, &*v_xx * b);
        let q_x = &self.l_x + a.tr_mul(v_x);
        let q_u = &self.l_u + b.tr_mul(v_x);
        let q_xx = &self.l_xx + &self.xx + a.tr_mul(&v_a);
        let q_ux = &self.l_ux + &self.ux + b.tr_mul(&v_a);
        let q_uu = &self.l_uu + &self.uu + b.tr_mul(&v_b);

        let mut regular = q_uu.clone();
        (0..q_u.len()).for_each(|i| regular[(i, i)] += mu);
        let minimum = box_qp::minimise(&regular, &q_u, bounds)?;
        let gain = minimum.gain(&q_ux);
        let d = minimum.d;

        let q_uu_d = &q_uu * &d;
        let promise = Promise { slope: q_u.dot(&d), curvature: q_uu_d.dot(&d) };
        let terms = (0..q_u.len()).map(|j| {
            self.l_u[j].abs() + b.column(j).iter().zip(&*y).map(|(b, y)| (b * y).abs()).sum::<f64>()
        });
        let gradient_terms = terms.fold(0.0, f64::max);
        let gradient = &self.l_u + b.tr_mul(y);

        *y = &self.l_x + a.tr_mul(y);
        *v_x = q_x + gain.tr_mul(&(q_u + q_uu_d)) + q_ux.tr_mul(&d);
        let half = gain.tr_mul(&(0.5 * q_uu * &gain + q_ux)) + 0.5 * q_xx;
        *v_xx = half.transpose() + half;
        Ok(Policy { d, gain, gradient, gradient_terms, promise })
    }
}

/// The result of the later stages that a stage needs.
pub struct Value {
    /// Gradient and Hessian of the value, the cost from here to the end under the new policy.
    pub v_x: DVector<f64>,
    pub v_xx: DMatrix<f64>,
    /// Costate: the gradient of the cost from here to the end under the current controls.
    pub y: DVector<f64>,
}

impl Value {
    /// At the end of the trajectory.
    pub fn at_end(end: &Stage) -> Self {
        Self { v_x: end.l_x.clone(), v_xx: end.l_xx.clone(), y: end.l_x.clone() }
    }
}

/// The policy of one stage: `u + alpha d + K (x - x_before)`, projected to the box.
pub struct Policy {
    pub d: DVector<f64>,
    /// K.
    pub gain: DMatrix<f64>,
    /// Gradient of the total cost in the controls of this stage, with all others fixed.
    pub gradient: DVector<f64>,
    /// Size of the terms that cancel in it at a minimum: the scale of its rounding error.
    pub gradient_terms: f64,
    /// The contribution of this stage to the prediction.
    pub promise: Promise,
}

impl Policy {
    /// The policy that changes nothing.
    pub fn none(states: usize, controls: usize) -> Self {
        let zero = DVector::zeros(controls);
        Self {
            d: zero.clone(),
            gain: DMatrix::zeros(controls, states),
            gradient: zero,
            gradient_terms: 0.0,
            promise: Promise::default(),
        }
    }
}

/// The prediction of the quadratic model for a step of length alpha: a change of
/// `alpha slope + alpha^2 / 2 curvature`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Promise {
    pub slope: f64,
    pub curvature: f64,
}

impl Promise {
    /// The predicted change of the cost; not positive for alpha from 0 to 1.
    pub fn change(&self, alpha: f64) -> f64 {
        alpha * (self.slope + 0.5 * alpha * self.curvature)
    }
}

/// Copies a block that may be zero by structure, up to its number of columns.
fn set_or_clear(to: &mut DMatrix<f64>, from: Option<Block<'_, f64>>, factor: f64) {
    to.fill(0.0);
    if let Some(from) = from {
        set(to, from, factor);
    }
}

fn set(to: &mut DMatrix<f64>, from: Block<'_, f64>, factor: f64) {
    for (mut to, from) in to.row_iter_mut().zip(from.iter_rows()) {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = factor * from);
    }
}
