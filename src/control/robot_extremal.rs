//! Extremals of a robot: `z = (q, p, y_q, y_p)`.

use super::actuation::Actuation;
use super::ends::Ends;
use super::extremal::{Ease, Extremal, Law, Rate, Side};
use super::options::Jacobian;
use super::penalty::Penalties;
use super::problem::Problem;
use crate::error::EvalError;
use crate::hamiltonian::SecondOrder;

/// The extremals of a [`Problem`]:
///
/// ```text
/// x' = F + (0, B u)      y' = -F_x'y + l_x      u = clip(R^-1 B y_p)
/// Jacobian  [ F_x             B R^-1 B where not at a bound ]
///           [ l_xx - y'F_xx   -F_x'                         ]
/// ```
///
/// Penalties depend on q and v = F^q(x): with `E = [ 1 0 ; V ]`, `V = F^q_x`, `l_x = E'(l_q, l_v)`. So
/// `y'F_x - l_x = (y_q - l_v, y_p)'F_x - (l_q, 0)`, and likewise `y'F_xx - l_xx = (y_q - l_v, y_p)'F_xx - E' l_zz E`: no new
/// tensor. Built once; evaluations do not allocate.
#[derive(Clone, Debug)]
pub struct RobotExtremal {
    pub(super) second: SecondOrder<f64>,
    pub(super) actuation: Actuation,
    /// Actuation and weight of the penalties of the problem itself.
    asked: (Actuation, f64),
    pub(super) penalties: Penalties,
    ends: Ends,
    /// c_t.
    time_cost: f64,
    pub(super) jacobian: Jacobian,
    /// B u.
    pub(super) force: Vec<f64>,
    /// du / d(b y_p).
    pub(super) slopes: Vec<f64>,
    /// `(y_q - l_v, y_p)`.
    pub(super) shifted: Vec<f64>,
    pub(super) l_q: Vec<f64>,
    pub(super) l_qq: Vec<f64>,
    pub(super) l_vv: Vec<f64>,
    /// For differences.
    pub(super) point: Vec<f64>,
    pub(super) beside: [Vec<f64>; 2],
}

impl RobotExtremal {
    /// The extremals of a problem that was [checked](Problem::check).
    ///
    /// # Errors
    /// A mass matrix that is singular at the start or the end.
    pub fn new(problem: &Problem, jacobian: Jacobian) -> Result<Self, EvalError> {
        let n = problem.robot.len();
        Ok(Self {
            second: SecondOrder::new(&problem.robot),
            actuation: Actuation::new(problem),
            asked: (Actuation::new(problem), problem.penalty.as_ref().map_or(0.0, |penalty| penalty.weight)),
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            ends: Ends::new(problem)?,
            time_cost: problem.cost.time,
            jacobian,
            force: vec![0.0; n],
            slopes: vec![0.0; n],
            shifted: vec![0.0; 2 * n],
            l_q: vec![0.0; n],
            l_qq: vec![0.0; n],
            l_vv: vec![0.0; n],
            point: vec![0.0; 4 * n],
            beside: [vec![0.0; 4 * n], vec![0.0; 4 * n]],
        })
    }

    /// Momenta `p = M(q) v`.
    pub(super) fn momentum(&mut self, q: &[f64], v: &[f64]) -> Result<&[f64], EvalError> {
        self.second.first().momentum(q, v)
    }

    /// Rates `v = M(q)^-1 p`.
    pub(super) fn velocity(&mut self, x: &[f64]) -> Result<&[f64], EvalError> {
        let (q, p) = x.split_at(x.len() / 2);
        self.second.first().velocity(q, p)
    }

    /// Controls, penalties and the shifted costate at z.
    fn prepare(&mut self, z: &[f64], law: Law<'_>) -> Result<Rate, EvalError> {
        let n = self.force.len();
        let (x, y) = z.split_at(2 * n);
        let mut rate = Rate { cost: self.time_cost, ..Rate::default() };
        self.shifted.copy_from_slice(y);
        for i in 0..n {
            let control = self.actuation.control(i, y[n + i], law);
            self.force[i] = self.actuation.gain[i] * control.u;
            self.slopes[i] = control.slope;
            rate.cost += control.cost;
            rate.penalty += control.smoothing;
        }
        if self.penalties.any() {
            for (i, &q) in x[..n].iter().enumerate() {
                let term = self.penalties.position(i, q);
                rate.penalty += term.value;
                (self.l_q[i], self.l_qq[i]) = (term.first, term.second);
            }
        }
        if self.penalties.limit_rates() {
            let v = self.second.first().velocity(&x[..n], &x[n..])?;
            for (i, &v) in v.iter().enumerate() {
                let term = self.penalties.rate(i, v);
                rate.penalty += term.value;
                self.shifted[i] -= term.first;
                self.l_vv[i] = term.second;
            }
        }
        Ok(rate)
    }
}

impl Extremal for RobotExtremal {
    fn states(&self) -> usize {
        2 * self.force.len()
    }

    fn controls(&self) -> usize {
        self.force.len()
    }

    fn rate(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError> {
        let n = self.force.len();
        let mut rate = self.prepare(z, law)?;
        let adjoint = self.second.first().adjoint(&z[..n], &z[n..2 * n], &self.force, &self.shifted)?;
        g[..2 * n].copy_from_slice(adjoint.f);
        g[2 * n..].iter_mut().zip(adjoint.y_f_x).for_each(|(g, product)| *g = -product);
        if self.penalties.any() {
            g[2 * n..3 * n].iter_mut().zip(&self.l_q).for_each(|(g, l_q)| *g += l_q);
        }
        rate.hamiltonian = hamiltonian(z, g, &rate);
        Ok(rate)
    }

    fn linear(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<Rate, EvalError> {
        if self.jacobian == Jacobian::Differences {
            self.differences(z, law, jacobian)?;
            return self.rate(z, law, g);
        }
        let mut rate = self.prepare(z, law)?;
        self.exact(z, g, jacobian)?;
        rate.hamiltonian = hamiltonian(z, g, &rate);
        Ok(rate)
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.ends.start(z, residual, jacobian)
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.ends.end(z, residual, jacobian)
    }

    fn time_cost(&self) -> f64 {
        self.time_cost
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends.are_fixed()
    }

    fn set_ease(&mut self, ease: Ease) {
        self.ends.set_goal(ease.goal);
        self.penalties.set_weight(ease.penalty * self.asked.1);
        self.actuation.ease(&self.asked.0, self.time_cost, ease);
    }

    fn easiest(&self) -> Ease {
        let Actuation { effort, bounds, .. } = &self.asked.0;
        Ease {
            goal: 0.1,
            penalty: if self.asked.1 > 0.0 { 0.0 } else { 1.0 },
            effort: if effort.contains(&0.0) { 1.0 } else { 0.0 },
            bounds: if bounds.iter().any(|(low, high)| low.is_finite() || high.is_finite()) { f64::INFINITY } else { 1.0 },
        }
    }

    /// Exact without gravity, springs, friction and limits, where the cost of effort falls like T^-3.
    fn stretch(&self, z: &mut [f64], factor: f64) {
        let parts = z.chunks_exact_mut(self.force.len()).zip([0, -1, -3, -2]);
        parts.for_each(|(part, power)| part.iter_mut().for_each(|z| *z *= factor.powi(power)));
    }

    /// Positions, momenta, and the costates of each.
    fn group(&self, component: usize) -> usize {
        component / self.force.len()
    }

    fn unbounded_controls(&self, z: &[f64], u: &mut [f64]) {
        let n = self.force.len();
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.unbounded(i, z[3 * n + i]));
    }

    fn controls_at(&self, z: &[f64], law: Law<'_>, u: &mut [f64]) {
        let n = self.force.len();
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.control(i, z[3 * n + i], law).u);
    }

    fn bounds(&self, control: usize) -> (f64, f64) {
        self.actuation.bounds[control]
    }

    fn switching(&self, control: usize, sides: (Side, Side), z: &[f64], gradient: &mut [f64]) -> f64 {
        let at = 3 * self.force.len() + control;
        gradient.fill(0.0);
        let (value, slope) = self.actuation.switching(control, sides, z[at]);
        gradient[at] = slope;
        value
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let n = self.force.len();
        for (i, force) in self.force.iter_mut().enumerate() {
            *force = self.actuation.gain[i] * u[i];
        }
        f.copy_from_slice(self.second.first().phase_velocity(&x[..n], &x[n..], &self.force)?);
        Ok(())
    }
}

/// `y'f - l`.
fn hamiltonian(z: &[f64], g: &[f64], rate: &Rate) -> f64 {
    let states = z.len() / 2;
    crate::matrix::dot(&z[states..], &g[..states]) - rate.cost - rate.penalty
}
