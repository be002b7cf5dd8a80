//! Optimal-control problems of any model.

use crate::extremal::given_rows::GivenRows;
use crate::problem::free_end::orientation_rows;
use crate::problem::{Bounds, FinalTime, Objective};

/// State at one end of a motion, some components possibly free.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct EndState {
    /// x. Free components only shape the first guess.
    pub x: Vec<f64>,
    /// Indices of free components: $y_i = 0$ there, but for what is given of them together.
    pub free: Vec<usize>,
    /// Rows c of linear functions of the free components that are given: $c^\top x$ is that of
    /// [`x`](Self::x), and y is a sum of these rows there. Of the end of a motion only.
    pub given: Vec<Vec<f64>>,
}

impl EndState {
    /// This state, nothing free.
    pub fn fixed(x: &[f64]) -> Self {
        Self { x: x.to_vec(), free: Vec::new(), given: Vec::new() }
    }

    /// With these components free.
    #[must_use]
    pub fn with_free(self, components: &[usize]) -> Self {
        Self { free: components.to_vec(), ..self }
    }

    /// With these rows of linear functions given, of components that are free.
    #[must_use]
    pub fn with_given(self, given: Vec<Vec<f64>>) -> Self {
        Self { given, ..self }
    }

    /// With the orientation of a quaternion $a = (x, y, z, w)$ given, and not its length: the four components
    /// from `first` on are free, and the three functions $\mathrm{vec}(\bar a_T \circ a)$ zero, $a_T$ that
    /// of [`x`](Self::x). So $y^\top a_T = 0$. A motion that keeps |a|, such as those of
    /// [`QuaternionDynamics`](costate::dynamics::QuaternionDynamics), ends at $\pm a_T$; with four fixed
    /// components its equations would be singular.
    #[must_use]
    pub fn with_orientation(mut self, first: usize) -> Self {
        let at = |k: usize| self.x.get(first + k).copied().unwrap_or(0.0);
        for row in orientation_rows([at(0), at(1), at(2), at(3)]) {
            let mut whole = vec![0.0; self.x.len()];
            whole.iter_mut().skip(first).zip(row).for_each(|(entry, value)| *entry = value);
            self.given.push(whole);
        }
        self.free.extend(first..first + 4);
        self
    }
}

/// Find u(t) that moves a model $x' = f(x, u)$ from its start to its end and minimises
///
/// $$ J = c_t T + \int_0^T \left( \tfrac12 \sum_i r_i u_i^2 + l \right) dt, \qquad
///    u_{min} \le u \le u_{max} $$
///
/// The model and the further running cost l are given to [`DirectDynamics`](crate::DirectDynamics), for any f
/// and l(x, u) and with limits of x, or to [`DynamicsExtremal`](crate::DynamicsExtremal), for f affine in u
/// and l(x).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct DynamicsProblem {
    /// State at the start.
    pub start: EndState,
    /// State at the end.
    pub end: EndState,
    /// Duration of the motion.
    pub time: FinalTime,
    /// Weights of time and effort.
    pub cost: Objective,
    /// Bounds on u.
    pub bounds: Option<Bounds>,
}

impl DynamicsProblem {
    /// From one state to another, with cost $\frac12 |u|^2$ per second of so many controls, and no bounds.
    pub fn new(start: EndState, end: EndState, time: FinalTime, controls: usize) -> Self {
        Self { start, end, time, cost: Objective::new(0.0, vec![1.0; controls]), bounds: None }
    }

    /// With these weights of time and effort.
    #[must_use]
    pub fn with_cost(self, cost: Objective) -> Self {
        Self { cost, ..self }
    }

    /// With these bounds on u.
    #[must_use]
    pub fn with_bounds(self, bounds: Bounds) -> Self {
        Self { bounds: Some(bounds), ..self }
    }
}

/// Why a [`DynamicsProblem`] was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DynamicsProblemError {
    /// A list of the wrong length.
    #[error("{field} has length {found}, the model needs {expected}")]
    WrongLength {
        /// The field.
        field: &'static str,
        /// The length of x or u.
        expected: usize,
        /// The length found.
        found: usize,
    },
    /// A number out of range.
    #[error("{field} = {value}: {range}")]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// The value.
        value: f64,
        /// The valid range.
        range: &'static str,
    },
    /// The model is not affine in u.
    #[error(
        "f(x, u) is not affine in u, so that the optimal control has no closed form; take the derivative of u as a new \
         control, and u as a state"
    )]
    NotAffine,
    /// The running cost depends on u.
    #[error("the running cost must be a function of x alone; give the cost of controls by cost.effort")]
    CostOfControls,
    /// A cost of mechanical energy.
    #[error("cost.energy is the work of joints of a robot: give the cost of a model by its running cost")]
    Energy,
    /// A cost of jerks or of rates of torques.
    #[error(
        "cost.jerk and cost.torque_rate are those of joints of a robot: make rates of u states of the model"
    )]
    Rates,
    /// A control that costs nothing and is not bounded on both sides.
    #[error(
        "cost.effort[{control}] is zero and u[{control}] is not bounded on both sides: give it a weight, or bounds"
    )]
    UnboundedEffort {
        /// Index of the control.
        control: usize,
    },
    /// Nothing depends on the motion.
    #[error(
        "nothing is left to minimise: give weights of effort, a running cost, or free the time at a cost"
    )]
    NothingToMinimise,
    /// The model cannot be evaluated at the start.
    #[error(transparent)]
    Eval(#[from] costate::EvalError),
}

impl DynamicsProblem {
    /// Checks lengths and ranges for a model of so many states and controls.
    pub(crate) fn check(
        &self,
        states: usize,
        controls: usize,
        running_cost: bool,
        cost_of_controls: bool,
    ) -> Result<(), DynamicsProblemError> {
        use DynamicsProblemError as Error;
        let length = |field, found: usize, expected| {
            if found == expected { Ok(()) } else { Err(Error::WrongLength { field, expected, found }) }
        };
        let finite = |field, values: &[f64]| match values.iter().find(|value| !value.is_finite()) {
            Some(&value) => Err(Error::OutOfRange { field, value, range: "must be finite" }),
            None => Ok(()),
        };
        for (field, end) in [("start", &self.start), ("end", &self.end)] {
            length(field, end.x.len(), states)?;
            finite(field, &end.x)?;
            if let Some(&component) = end.free.iter().find(|&&component| component >= states) {
                let range = "free components are indices of x";
                return Err(Error::OutOfRange { field, value: component as f64, range });
            }
        }
        self.check_given(states)?;
        let Objective { time, effort, .. } = &self.cost;
        if self.cost.has_energy() {
            return Err(Error::Energy);
        }
        if self.cost.first_of_rates().is_some() {
            return Err(Error::Rates);
        }
        length("cost.effort", effort.len(), controls)?;
        let positive = |value: f64| value > 0.0 && value.is_finite();
        if !positive(self.time.value()) {
            let range = "must be positive and finite";
            return Err(Error::OutOfRange { field: "time", value: self.time.value(), range });
        }
        for (field, &value) in effort.iter().map(|r| ("cost.effort", r)).chain([("cost.time", time)]) {
            if value != 0.0 && !positive(value) {
                let range = "must be neither negative nor infinite";
                return Err(Error::OutOfRange { field, value, range });
            }
        }
        if let Some(Bounds { u_min, u_max }) = &self.bounds {
            length("bounds.u_min", u_min.len(), controls)?;
            length("bounds.u_max", u_max.len(), controls)?;
            if let Some((&value, _)) =
                u_min.iter().zip(u_max).find(|(low, high)| low >= high || low.is_nan() || high.is_nan())
            {
                let range = "must be less than bounds.u_max";
                return Err(Error::OutOfRange { field: "bounds.u_min", value, range });
            }
        }
        let bounded = |i: usize| {
            let bounds = self.bounds.as_ref();
            bounds.is_some_and(|bounds| bounds.u_min[i].is_finite() && bounds.u_max[i].is_finite())
        };
        if let Some(control) = (0..controls).find(|&i| effort[i] == 0.0 && !bounded(i) && !cost_of_controls) {
            return Err(Error::UnboundedEffort { control });
        }
        let costs = running_cost
            || match self.time {
                FinalTime::Fixed(_) => effort.iter().any(|&weight| weight > 0.0),
                FinalTime::Free { .. } => *time > 0.0,
            };
        if costs { Ok(()) } else { Err(Error::NothingToMinimise) }
    }

    /// Linear functions that are given are those of the end, and independent.
    fn check_given(&self, states: usize) -> Result<(), DynamicsProblemError> {
        use DynamicsProblemError as Error;
        if !self.start.given.is_empty() {
            let (value, range) = (self.start.given.len() as f64, "functions are given at the end only");
            return Err(Error::OutOfRange { field: "start.given", value, range });
        }
        for row in &self.end.given {
            let (field, expected, found) = ("end.given", states, row.len());
            if found != expected {
                return Err(Error::WrongLength { field, expected, found });
            }
            if let Some(&value) = row.iter().find(|value| !value.is_finite()) {
                return Err(Error::OutOfRange { field, value, range: "must be finite" });
            }
        }
        let free: Vec<bool> = (0..states).map(|i| self.end.free.contains(&i)).collect();
        match GivenRows::new(&self.end.given, &free).dependent {
            Some(row) => Err(Error::OutOfRange {
                field: "end.given",
                value: row as f64,
                range: "this row depends on the rows before it and the fixed components; remove it",
            }),
            None => Ok(()),
        }
    }
}
