//! Extremals of a robot in Lagrangian coordinates: `z = (q, v, y_q, y_v)`.

pub(crate) mod jacobian;

use crate::extremal::actuation::{Actuation, Switching};
use crate::extremal::component_ends::{ComponentEnds, GivenComponents};
use crate::extremal::differences::{Differenced, Differences};
use crate::extremal::hamiltonian::equations::{Outputs, Running};
use crate::extremal::hamiltonian::{stretch, with_hamiltonian};
use crate::extremal::penalty::Penalties;
use crate::extremal::relaxable::{Relaxable, RelaxedParts};
use crate::extremal::user_terms::UserTerms;
use crate::extremal::{
    BoundaryValueProblem, BoundedControls, ControlLaw, ControlRange, HamiltonianTerms, Homotopy, Relaxation,
    SideChange,
};
use crate::options::JacobianRoute;
use crate::problem::check::CheckedProblem;
use costate::EvalError;
use costate::lagrangian::LagrangianSecondOrder;

/// The extremals of a [`Problem`](crate::Problem) with x = (q, v), for comparison with
/// [`RobotExtremal`](crate::RobotExtremal):
///
/// $$ x' = (v, a(q, v, B u)), \quad y' = -f_x^\top y + l_x, \quad
///    u = \mathrm{clip}(R^{-1} B w), \quad w = M^{-1} y_v $$
///
/// The actuation acts through $M^{-1}$, so that u depends on q, which adds to all blocks of the Jacobian.
/// With $H = y^\top f - l$ at a given u and $W = w_z = ( y_v^\top a_{uq}, 0, 0, M^{-1} )$
///
/// $$ g_z = \begin{pmatrix} H^\ast_{yx} & H^\ast_{yy} \\\\ -H^\ast_{xx} & -H^\ast_{xy} \end{pmatrix}, \qquad
///    H^\ast_{zz} = H_{zz} + W^\top B R^{-1} B W, \qquad
///    H_{xx} = y_v^\top a_{xx} - l_{xx}, \quad H_{yx} = f_x, \quad H_{yy} = 0 $$
///
/// with zeros in $B R^{-1} B$ for controls at a bound. Penalties and [user terms](crate::UserTerm) depend on
/// x itself. Free components of an end have costate zero. [`JacobianRoute::WithoutHessian`] omits
/// $y_v^\top a_{xx}$ and $y_v^\top a_{uq}$, and so the change of u with q. Evaluations do not allocate.
#[derive(Clone, Debug)]
pub struct LagrangianExtremal {
    pub(crate) second: LagrangianSecondOrder<f64>,
    pub(crate) actuation: Actuation,
    relaxable: Relaxable,
    pub(crate) penalties: Penalties,
    pub(crate) terms: UserTerms<f64>,
    ends: ComponentEnds,
    /// c_t.
    time_cost: f64,
    jacobian: JacobianRoute,
    /// w.
    pub(crate) pull: Vec<f64>,
    /// B u.
    pub(crate) force: Vec<f64>,
    /// du / d(b w).
    pub(crate) slopes: Vec<f64>,
    /// l_x, and the diagonal of l_xx that penalties have.
    pub(crate) l_x: Vec<f64>,
    pub(crate) l_xx: Vec<f64>,
    differences: Differences,
}

impl LagrangianExtremal {
    /// The extremals of a problem.
    ///
    /// # Errors
    /// A mass matrix that is singular at the start or the end.
    pub fn new(problem: CheckedProblem<'_>, jacobian: JacobianRoute) -> Result<Self, EvalError> {
        let n = problem.robot.dof();
        let mut second = LagrangianSecondOrder::new(&problem.robot);
        for q in [&problem.start.q, &problem.end.q] {
            second.first().solve_mass_matrix(q, &mut vec![0.0; n])?;
        }
        Ok(Self {
            second,
            actuation: Actuation::new(&problem),
            relaxable: Relaxable::new(&problem),
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            terms: UserTerms::new(n, &problem.terms),
            ends: ComponentEnds::new(
                GivenComponents::of_robot(&problem.start),
                GivenComponents::of_robot(&problem.end),
            ),
            time_cost: problem.cost.time,
            jacobian,
            pull: vec![0.0; n],
            force: vec![0.0; n],
            slopes: vec![0.0; n],
            l_x: vec![0.0; 2 * n],
            l_xx: vec![0.0; 2 * n],
            differences: Differences::new(4 * n),
        })
    }

    /// Computes w, controls and penalties at z, and factors M(q).
    fn prepare(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        curvature: bool,
    ) -> Result<Running<f64>, EvalError> {
        let n = self.force.len();
        self.pull.copy_from_slice(&z[3 * n..]);
        self.second.first().solve_mass_matrix(&z[..n], &mut self.pull)?;
        let mut l = Running { cost: self.time_cost, penalty: 0.0, smoothing: 0.0 };
        self.l_x.fill(0.0);
        for i in 0..n {
            let control = self.actuation.control(i, self.pull[i], law);
            self.force[i] = self.actuation.gain[i] * control.u;
            self.slopes[i] = control.slope;
            l.cost += control.cost;
            l.smoothing += control.smoothing;
        }
        if self.penalties.any() {
            for i in 0..n {
                let terms =
                    [(i, self.penalties.position(i, z[i])), (n + i, self.penalties.rate(i, z[n + i]))];
                for (at, term) in terms {
                    l.penalty += term.value;
                    (self.l_x[at], self.l_xx[at]) = (term.first, term.second);
                }
            }
        }
        if self.terms.any() {
            let (q, v) = z[..2 * n].split_at(n);
            if curvature {
                self.terms.second(q, v)
            } else {
                self.terms.first(q, v)
            }
            l.cost += self.terms.value;
            self.l_x.iter_mut().zip(&self.terms.gradient).for_each(|(l_x, term)| *l_x += term);
        }
        Ok(l)
    }

    /// Computes w alone; NaN where the mass matrix is singular.
    fn pull_at(&mut self, z: &[f64]) {
        let n = self.force.len();
        self.pull.copy_from_slice(&z[3 * n..]);
        if self.second.first().solve_mass_matrix(&z[..n], &mut self.pull).is_err() {
            self.pull.fill(f64::NAN);
        }
    }
}

impl BoundaryValueProblem for LagrangianExtremal {
    fn states(&self) -> usize {
        2 * self.force.len()
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let n = self.force.len();
        let l = self.prepare(z, law, false)?;
        let (f, y_rate) = g.split_at_mut(2 * n);
        self.second.first().adjoint_factored([&z[..n], &z[n..2 * n], &self.force, &self.pull], f, y_rate)?;
        y_rate.iter_mut().for_each(|product| *product = -*product);
        y_rate[n..].iter_mut().zip(&z[2 * n..3 * n]).for_each(|(rate, y_q)| *rate -= y_q);
        y_rate.iter_mut().zip(&self.l_x).for_each(|(rate, l_x)| *rate += l_x);
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
        self.ends.start(z, residual, jacobian);
        Ok(())
    }

    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        self.ends.end(z, residual, jacobian);
        Ok(())
    }

    fn time_cost(&self) -> f64 {
        self.time_cost
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends.are_fixed()
    }

    /// Positions, rates, and their costates.
    fn group(&self, component: usize) -> usize {
        component / self.force.len()
    }
}

impl BoundedControls for LagrangianExtremal {
    fn controls(&self) -> usize {
        self.force.len()
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        self.pull_at(z);
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.unbounded(i, self.pull[i]));
    }

    fn controls_at(&mut self, z: &[f64], law: ControlLaw<'_>, u: &mut [f64]) {
        self.pull_at(z);
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.control(i, self.pull[i], law).u);
    }

    fn bounds(&self, control: usize) -> ControlRange {
        self.actuation.reached_bounds(self.relaxable.original(), control)
    }

    /// $b_i w_i - r_i u_i$ at the bound, with the exact gradient for every [`JacobianRoute`].
    fn switching(&mut self, control: usize, change: SideChange, z: &[f64], gradient: &mut [f64]) -> f64 {
        let n = self.force.len();
        self.pull_at(z);
        let Switching { value, slope } = self.actuation.switching(control, change, self.pull[control]);
        gradient.fill(0.0);
        self.force.fill(0.0);
        let Ok(all) = self.second.contract_forward_dynamics(&z[..n], &z[n..2 * n], &self.force, &z[3 * n..])
        else {
            return f64::NAN;
        };
        for (part, row) in [(0, all.uq().row(control)), (3 * n, all.forward_dynamics().a_u().row(control))] {
            gradient[part..part + n].iter_mut().zip(row).for_each(|(to, &from)| *to = slope * from);
        }
        value
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        let n = self.force.len();
        for (i, force) in self.force.iter_mut().enumerate() {
            *force = self.actuation.gain[i] * u[i];
        }
        f.copy_from_slice(self.second.first().evaluate(&x[..n], &x[n..], &self.force)?);
        Ok(())
    }
}

impl Homotopy for LagrangianExtremal {
    fn relaxation(&self) -> Relaxation {
        self.relaxable.current()
    }

    fn set_relaxation(&mut self, relaxation: Relaxation) {
        let Self { ends, relaxable, actuation, penalties, terms, .. } = self;
        ends.set_goal(relaxation.goal);
        relaxable.apply(relaxation, RelaxedParts { actuation, penalties, terms });
    }

    fn easiest(&self) -> Relaxation {
        self.relaxable.easiest()
    }

    /// Exact without gravity, springs, friction and limits, where the cost of effort falls like $T^{-3}$.
    fn stretch(&self, z: &mut [f64], factor: f64) {
        stretch(z, factor);
    }
}
