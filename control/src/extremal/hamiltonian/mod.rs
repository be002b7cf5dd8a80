//! Extremals of a robot: `z = (q, p, y_q, y_p)`.

pub(crate) mod ends;
pub(crate) mod equations;

use crate::extremal::actuation::{Actuation, Switching};
use crate::extremal::differences::{Differenced, Differences};
use crate::extremal::hamiltonian::ends::Ends;
use crate::extremal::hamiltonian::equations::{Equations, Outputs, Running};
use crate::extremal::relaxable::{Relaxable, RelaxedParts};
use crate::extremal::{
    BoundaryValueProblem, BoundedControls, ControlLaw, ControlRange, HamiltonianTerms, Homotopy, Relaxation,
    SideChange,
};
use crate::options::JacobianRoute;
use crate::problem::check::CheckedProblem;
use costate::EvalError;
use costate::hamiltonian::HamiltonianSecondOrder;

/// The extremals of a [`Problem`](crate::Problem), z = (x, y), x = (q, p):
///
/// $$ x' = F + \begin{pmatrix} 0 \\\\ B u \end{pmatrix}, \quad y' = -F_x^\top y + l_x, \quad
///    u = \mathrm{clip}(R^{-1} B y_p), \qquad
///    g_z = \begin{pmatrix} F_x & \begin{matrix} 0 & 0 \\\\ 0 & B R^{-1} B \end{matrix} \\\\
///    l_{xx} - y^\top F_{xx} & -F_x^\top \end{pmatrix} $$
///
/// with zeros in $B R^{-1} B$ for controls at a bound. Penalties and [user terms](crate::UserTerm) depend on
/// q and $v = F^q(x)$. With $E = \begin{pmatrix} 1 & 0 \\\\ V_q & V_p \end{pmatrix}$, $V = F^q_x$, we have
/// $l_x = E^\top (l_q, l_v)$, so that $y^\top F_x - l_x = (y_q - l_v, y_p)^\top F_x - (l_q, 0)$ and $y^\top
/// F_{xx} - l_{xx} = (y_q - l_v, y_p)^\top F_{xx} - E^\top l_{zz} E$ with z = (q, v): no new tensor.
/// Evaluations do not allocate.
#[derive(Clone, Debug)]
pub struct RobotExtremal {
    pub(crate) equations: Equations<f64>,
    pub(crate) actuation: Actuation,
    relaxable: Relaxable,
    ends: Ends,
    jacobian: JacobianRoute,
    differences: Differences,
}

impl RobotExtremal {
    /// The extremals of a problem.
    ///
    /// # Errors
    /// A mass matrix that is singular at the start or the end.
    pub fn new(problem: CheckedProblem<'_>, jacobian: JacobianRoute) -> Result<Self, EvalError> {
        let n = problem.robot.dof();
        Ok(Self {
            equations: Equations::new(&problem, HamiltonianSecondOrder::new(&problem.robot)),
            actuation: Actuation::new(&problem),
            relaxable: Relaxable::new(&problem),
            ends: Ends::new(&problem)?,
            jacobian,
            differences: Differences::new(4 * n),
        })
    }

    /// Smooths controls without effort by this [weight](Relaxation::effort), as a new original problem.
    pub(crate) fn smooth(&mut self, effort: f64) {
        self.relaxable.smooth(effort);
        self.actuation = self.relaxable.original().clone();
    }

    /// Momenta `p = M(q) v`.
    pub(crate) fn momentum(&mut self, q: &[f64], v: &[f64]) -> Result<&[f64], EvalError> {
        self.equations.second.first().momentum(q, v)
    }

    /// Rates `v = M(q)^-1 p`.
    pub(crate) fn velocity(&mut self, x: &[f64]) -> Result<&[f64], EvalError> {
        let (q, p) = x.split_at(x.len() / 2);
        self.equations.second.first().velocity(q, p)
    }
}

impl Differenced for RobotExtremal {
    fn differences(&mut self) -> &mut Differences {
        &mut self.differences
    }

    fn linearise_with(
        &mut self,
        hessian: bool,
        z: &[f64],
        law: ControlLaw<'_>,
        Outputs { g, jacobian }: Outputs<'_, f64>,
    ) -> Result<HamiltonianTerms, EvalError> {
        let actuation = &self.actuation;
        let control = |i, y_p| actuation.control(i, y_p, law);
        let l = self.equations.linearise(z, control, hessian, Outputs { g: &mut *g, jacobian })?;
        Ok(with_hamiltonian(z, g, l))
    }
}

impl BoundaryValueProblem for RobotExtremal {
    fn states(&self) -> usize {
        2 * self.equations.force.len()
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let actuation = &self.actuation;
        let l = self.equations.evaluate(z, |i, y_p| actuation.control(i, y_p, law), g)?;
        Ok(with_hamiltonian(z, g, l))
    }

    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.linearise_by(self.jacobian, z, law, Outputs { g, jacobian })
    }

    fn linearise_exactly(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        self.linearise_with(true, z, law, Outputs { g, jacobian })
    }

    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.ends.start(z, residual, jacobian)
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.ends.end(z, residual, jacobian)
    }

    fn time_cost(&self) -> f64 {
        self.equations.time_cost
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends.are_fixed()
    }

    /// Positions, momenta, and their costates.
    fn group(&self, component: usize) -> usize {
        component / self.equations.force.len()
    }
}

impl BoundedControls for RobotExtremal {
    fn controls(&self) -> usize {
        self.equations.force.len()
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        let n = self.equations.force.len();
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.unbounded(i, z[3 * n + i]));
    }

    fn controls_at(&mut self, z: &[f64], law: ControlLaw<'_>, u: &mut [f64]) {
        let n = self.equations.force.len();
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.control(i, z[3 * n + i], law).u);
    }

    fn bounds(&self, control: usize) -> ControlRange {
        self.actuation.reached_bounds(self.relaxable.original(), control)
    }

    fn switching(&mut self, control: usize, change: SideChange, z: &[f64], gradient: &mut [f64]) -> f64 {
        let at = 3 * self.equations.force.len() + control;
        gradient.fill(0.0);
        let Switching { value, slope } = self.actuation.switching(control, change, z[at]);
        gradient[at] = slope;
        value
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let n = self.equations.force.len();
        let Equations { second, force, gain, .. } = &mut self.equations;
        force.iter_mut().zip(gain).zip(u).for_each(|((force, gain), u)| *force = *gain * u);
        f.copy_from_slice(second.first().evaluate(&x[..n], &x[n..], force)?);
        Ok(())
    }
}

impl Homotopy for RobotExtremal {
    fn relaxation(&self) -> Relaxation {
        self.relaxable.current()
    }

    fn set_relaxation(&mut self, relaxation: Relaxation) {
        let Equations { penalties, terms, .. } = &mut self.equations;
        self.ends.set_goal(relaxation.goal);
        self.relaxable.apply(relaxation, RelaxedParts { actuation: &mut self.actuation, penalties, terms });
    }

    fn easiest(&self) -> Relaxation {
        self.relaxable.easiest()
    }

    /// Exact without gravity, springs, friction and limits, where the cost of effort falls like $T^{-3}$.
    fn stretch(&self, z: &mut [f64], factor: f64) {
        stretch(z, factor);
    }
}

/// `H* = y'f - l` and l.
pub(crate) fn with_hamiltonian(z: &[f64], g: &[f64], l: Running<f64>) -> HamiltonianTerms {
    let states = z.len() / 2;
    let hamiltonian = costate::matrix::dot(&z[states..], &g[..states]) - l.cost - l.penalty - l.smoothing;
    HamiltonianTerms { hamiltonian, cost: l.cost, penalty: l.penalty, smoothing: l.smoothing }
}

/// Scales positions, rates or momenta, and their costates to a motion that takes `factor` times as long.
pub(crate) fn stretch(z: &mut [f64], factor: f64) {
    let parts = z.chunks_exact_mut(z.len() / 4).zip([0, -1, -3, -2]);
    parts.for_each(|(part, power)| part.iter_mut().for_each(|z| *z *= factor.powi(power)));
}
