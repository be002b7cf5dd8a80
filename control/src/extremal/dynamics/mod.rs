//! Extremals of any model that is affine in its controls.

mod controls;
mod guess;
pub(crate) mod problem;
pub(crate) mod response;

use crate::extremal::actuation::Actuation;
use crate::extremal::component_ends::{ComponentEnds, GivenComponents};
use crate::extremal::dynamics::problem::{DynamicsProblem, DynamicsProblemError, EndState};
use crate::extremal::dynamics::response::{Response, eval_error, is_affine};
use crate::extremal::hamiltonian::equations::Running;
use crate::extremal::hamiltonian::with_hamiltonian;
use crate::extremal::relaxable::Relaxable;
use crate::extremal::{BoundaryValueProblem, ControlLaw, HamiltonianTerms};
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics, QuadraticCost};
use costate::matrix::add_scaled;

/// The extremals of a [`DynamicsProblem`]: of a drone, a car, any [`Dynamics`] that is affine in u.
///
/// With $w = f_u^\top y$ the optimal control is $u_i = w_i / r_i$, clipped to its bounds. Inside the bounds
/// it changes by $du = R^{-1} (f_u^\top dy + W\\, dx)$,
/// $W = \partial^2 (y^\top f) / \partial u\\, \partial x$, and with S = $R^{-1}$ restricted to these controls
///
/// $$ x' = f, \quad y' = -f_x^\top y + l_x, \qquad
///    g_z = \begin{pmatrix} f_x + f_u S W & f_u S f_u^\top \\\\
///    l_{xx} - y^\top f_{xx} - W^\top S W & -f_x^\top - W^\top S f_u^\top \end{pmatrix} $$
///
/// The running cost l(x) is any [`Cost`] without controls. An error of the model becomes
/// [`EvalError::Model`].
///
/// ```
/// use costate::derivative::Function;
/// use costate::dynamics::Automatic;
/// use costate::scalar::Scalar;
/// use costate_control::{
///     DynamicsExtremal, DynamicsProblem, EndState, FinalTime, SolverOptions, solve_dynamics,
/// };
///
/// /// A cart: x = (position, rate), u = force per mass.
/// #[derive(Clone)]
/// struct Cart;
///
/// impl Function for Cart {
///     type Workspace<S: Scalar> = ();
///     type Error = std::convert::Infallible;
///     fn inputs(&self) -> usize { 3 }
///     fn outputs(&self) -> usize { 2 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
///         (f[0], f[1]) = (z[1], z[2]);
///         Ok(())
///     }
/// }
///
/// let (start, end) = (EndState::fixed(&[0.0, 0.0]), EndState::fixed(&[1.0, 0.0]));
/// let problem = DynamicsProblem::new(start, end, FinalTime::Fixed(1.0), 1);
/// let mut extremal = DynamicsExtremal::new(Automatic::<Cart>::new(Cart), &problem)?;
/// let motion = solve_dynamics(&mut extremal, &SolverOptions::default()).motion;
/// assert!(motion.status.is_converged() && (motion.cost - 6.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DynamicsExtremal<D, C = QuadraticCost> {
    model: D,
    running_cost: Option<C>,
    problem: DynamicsProblem,
    actuation: Actuation,
    relaxable: Relaxable,
    ends: ComponentEnds,
    /// w.
    pull: Vec<f64>,
    u: Vec<f64>,
    /// S.
    slopes: Vec<f64>,
    l_x: Vec<f64>,
    /// One row of W and of f_u'.
    response: Response,
}

impl<D: Dynamics<f64>> DynamicsExtremal<D> {
    /// The extremals without further running cost.
    ///
    /// # Errors
    /// A problem that does not fit the model, or a model that is not affine in u at the start.
    pub fn new(model: D, problem: &DynamicsProblem) -> Result<Self, DynamicsProblemError> {
        Self::build(model, None, problem)
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> DynamicsExtremal<D, C> {
    /// The extremals with a running cost l(x): a [`Cost`] without controls.
    ///
    /// # Errors
    /// A problem that does not fit the model, a cost of controls, or a model that is not affine in u at the
    /// start.
    pub fn with_running_cost(
        model: D,
        cost: C,
        problem: &DynamicsProblem,
    ) -> Result<Self, DynamicsProblemError> {
        let (expected, found) = (model.states(), cost.states());
        if cost.controls() > 0 {
            return Err(DynamicsProblemError::CostOfControls);
        }
        if found != expected {
            let field = "x of the running cost";
            return Err(DynamicsProblemError::WrongLength { field, expected, found });
        }
        Self::build(model, Some(cost), problem)
    }

    fn build(
        mut model: D,
        running_cost: Option<C>,
        problem: &DynamicsProblem,
    ) -> Result<Self, DynamicsProblemError> {
        let (states, controls) = (model.states(), model.controls());
        problem.check(states, controls, running_cost.is_some(), false)?;
        // A costate without symmetry finds every second derivative in u.
        let y: Vec<f64> = (1..=states).map(|i| (i as f64).sqrt()).collect();
        let all = model.contract(&problem.start.x, &vec![0.0; controls], &y).map_err(eval_error)?;
        if !is_affine(&all) {
            return Err(DynamicsProblemError::NotAffine);
        }
        let actuation =
            Actuation::of_parts(vec![1.0; controls], problem.cost.effort.clone(), problem.bounds.as_ref());
        Ok(Self {
            model,
            running_cost,
            relaxable: Relaxable::of_actuation(actuation.clone(), problem.cost.time),
            actuation,
            ends: ComponentEnds::new(components(&problem.start), components(&problem.end)),
            problem: problem.clone(),
            pull: vec![0.0; controls],
            u: vec![0.0; controls],
            slopes: vec![0.0; controls],
            l_x: vec![0.0; states],
            response: Response::new(states),
        })
    }

    /// The problem.
    pub fn problem(&self) -> &DynamicsProblem {
        &self.problem
    }

    /// w at z.
    fn set_pull(&mut self, z: &[f64]) -> Result<(), EvalError> {
        let (x, y) = z.split_at(self.l_x.len());
        // f_u does not depend on u.
        let first = self.model.linearise(x, &self.u).map_err(eval_error)?;
        self.pull.fill(0.0);
        for (&y, row) in y.iter().zip(first.f_u.iter_rows()) {
            add_scaled(&mut self.pull, y, row);
        }
        Ok(())
    }

    /// Controls and their cost at z.
    fn set_controls(&mut self, z: &[f64], law: ControlLaw<'_>) -> Result<Running<f64>, EvalError> {
        self.set_pull(z)?;
        let mut l = Running { cost: self.problem.cost.time, penalty: 0.0, smoothing: 0.0 };
        for (i, &pull) in self.pull.iter().enumerate() {
            let control = self.actuation.control(i, pull, law);
            (self.u[i], self.slopes[i]) = (control.u, control.slope);
            l.cost += control.cost;
            l.smoothing += control.smoothing;
        }
        Ok(l)
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> BoundaryValueProblem for DynamicsExtremal<D, C> {
    fn states(&self) -> usize {
        self.l_x.len()
    }

    fn evaluate(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let mut l = self.set_controls(z, law)?;
        let (x, y) = z.split_at(self.l_x.len());
        let (f, y_rate) = g.split_at_mut(x.len());
        let first = self.model.linearise(x, &self.u).map_err(eval_error)?;
        f.copy_from_slice(first.f);
        y_rate.fill(0.0);
        y.iter().zip(first.f_x.iter_rows()).for_each(|(&y, row)| add_scaled(y_rate, -y, row));
        if let Some(cost) = &mut self.running_cost {
            let gradient = cost.gradient(x, &[]).map_err(eval_error)?;
            l.cost += gradient.value;
            add_scaled(y_rate, 1.0, gradient.x);
        }
        Ok(with_hamiltonian(z, g, l))
    }

    fn linearise(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let mut l = self.set_controls(z, law)?;
        let states = self.l_x.len();
        let (x, y) = z.split_at(states);
        let width = 2 * states;
        let (f, y_rate) = g.split_at_mut(states);
        let all = self.model.contract(x, &self.u, y).map_err(eval_error)?;
        if !is_affine(&all) {
            return Err(EvalError::Model { reason: DynamicsProblemError::NotAffine.to_string() });
        }
        f.copy_from_slice(all.first.f);
        y_rate.fill(0.0);
        jacobian.fill(0.0);
        for (i, (row, hessian)) in all.first.f_x.iter_rows().zip(all.xx.iter_rows()).enumerate() {
            add_scaled(y_rate, -y[i], row);
            jacobian[i * width..i * width + states].copy_from_slice(row);
            for (j, &entry) in row.iter().enumerate() {
                jacobian[(states + j) * width + states + i] = -entry;
            }
            let target = (states + i) * width;
            add_scaled(&mut jacobian[target..target + states], -1.0, hessian);
        }
        for (control, &slope) in self.slopes.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
            self.response.set(&all, control);
            self.response.add(slope, jacobian);
        }
        if let Some(cost) = &mut self.running_cost {
            let hessian = cost.hessian(x, &[]).map_err(eval_error)?;
            l.cost += hessian.gradient.value;
            add_scaled(y_rate, 1.0, hessian.gradient.x);
            for (i, row) in hessian.xx.iter_rows().enumerate() {
                let target = (states + i) * width;
                add_scaled(&mut jacobian[target..target + states], 1.0, row);
            }
        }
        Ok(with_hamiltonian(z, g, l))
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
        self.problem.cost.time
    }

    fn ends_are_fixed(&self) -> bool {
        self.ends.are_fixed()
    }
}

fn components(EndState { x, free, given }: &EndState) -> GivenComponents {
    GivenComponents::new(x, (0..x.len()).map(|i| free.contains(&i)).collect(), given)
}
