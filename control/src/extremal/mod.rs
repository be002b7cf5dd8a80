//! Extremals of Pontryagin's principle as a differential equation with conditions at both ends.

pub(crate) mod actuation;
pub(crate) mod differences;
pub(crate) mod generated;
pub(crate) mod hamiltonian;
pub(crate) mod lagrangian;
pub(crate) mod legendre;
pub(crate) mod penalty;
pub(crate) mod program;
pub(crate) mod user_terms;

use costate::EvalError;

/// Where a bounded control stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Side {
    /// At its lower bound.
    Low,
    /// Between the bounds.
    Inside,
    /// At its upper bound.
    High,
}

/// Which of the controls are at a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law<'a> {
    /// Each where the maximum of the Hamiltonian asks it to be.
    Maximal,
    /// As given, one entry for each control: what is inside is not clipped.
    Given(&'a [Side]),
}

/// What goes with the rate of change at one point of an extremal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rate {
    /// `H* = y'f - l`.
    pub hamiltonian: f64,
    /// Running cost l without penalties.
    pub cost: f64,
    /// Penalties.
    pub penalty: f64,
    /// The rest of l: what only an easier problem costs.
    pub smoothing: f64,
}

impl Rate {
    /// `|y'f| + |l|`: what H* is small against.
    pub fn magnitude(&self) -> f64 {
        let l = self.cost + self.penalty + self.smoothing;
        (self.hamiltonian + l).abs() + l.abs()
    }
}

/// An easier problem in place of the one asked for, and a way from one to the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ease {
    /// Part of the way from the start to the end.
    pub goal: f64,
    /// Factor of the penalties and of user terms.
    pub penalty: f64,
    /// Weight of the effort of controls that cost nothing, in parts of one that makes it matter; 0 for none.
    pub effort: f64,
    /// Factor of the distance between bounds; infinite for none.
    pub bounds: f64,
}

impl Ease {
    /// The problem itself.
    pub const NONE: Self = Self { goal: 1.0, penalty: 1.0, effort: 0.0, bounds: 1.0 };
}

/// `z' = g(z)`, `z = (x, y)`, of a maximised Hamiltonian `H*(x, y) = max_u [ y'f(x, u) - l(x, u) ]`:
///
/// ```text
/// x' = H*_y     y' = -H*_x
/// ```
///
/// with N conditions at each end, N being the length of x and of the costate y. Matrices are written row by row.
pub trait Extremal {
    /// Length N of x.
    fn states(&self) -> usize;

    /// Number of controls; those without bounds need not be counted.
    fn controls(&self) -> usize {
        0
    }

    /// g(z), 2N entries.
    ///
    /// # Errors
    /// What stands against an evaluation at z.
    fn rate(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError>;

    /// g(z) and its Jacobian, 2N x 2N.
    ///
    /// # Errors
    /// What stands against an evaluation at z.
    fn linear(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<Rate, EvalError>;

    /// The N conditions at the start, zero where they hold, and their Jacobian, N x 2N.
    ///
    /// # Errors
    /// What stands against an evaluation at z.
    fn start(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError>;

    /// The N conditions at the end, zero where they hold, and their Jacobian, N x 2N.
    ///
    /// # Errors
    /// What stands against an evaluation at z.
    fn end(&mut self, z: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError>;

    /// c_t, the part of l that does not depend on z: the price of time.
    fn time_cost(&self) -> f64 {
        0.0
    }

    /// Whether the start and the end fix all of x.
    fn ends_are_fixed(&self) -> bool {
        true
    }

    /// How easy the problem is now.
    fn ease(&self) -> Ease {
        Ease::NONE
    }

    /// Makes the problem easier, or, with [`Ease::NONE`], itself again. What does not exist is left aside.
    fn set_ease(&mut self, _: Ease) {}

    /// What `set_ease` can change: entries other than those of [`Ease::NONE`] say which, and how far.
    fn easiest(&self) -> Ease {
        Ease::NONE
    }

    /// A guess of z for a motion that takes `factor` times as long, from that at the same part of the time.
    fn stretch(&self, _z: &mut [f64], _factor: f64) {}

    /// Whether numbers of the same kind: components of one group are scaled by no less than a part of the largest of them.
    fn group(&self, component: usize) -> usize {
        component / self.states().max(1)
    }

    /// The controls at z before they are cut to their bounds; infinite where only the sign of a costate decides, and not a
    /// number where they cannot be computed.
    fn unbounded_controls(&mut self, _z: &[f64], _u: &mut [f64]) {}

    /// The bounds of a control.
    fn bounds(&self, _control: usize) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// What vanishes where `control` leaves or reaches a bound, given the sides before and after, and its gradient (2N).
    fn switching(&mut self, _control: usize, _sides: (Side, Side), _z: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        0.0
    }

    /// The controls of the law, as they act.
    fn controls_at(&mut self, z: &[f64], law: Law<'_>, u: &mut [f64]) {
        self.unbounded_controls(z, u);
        for (i, u) in u.iter_mut().enumerate() {
            let (low, high) = self.bounds(i);
            *u = match law {
                Law::Maximal => u.clamp(low, high),
                Law::Given(sides) => match sides[i] {
                    Side::Low => low,
                    Side::Inside => *u,
                    Side::High => high,
                },
            };
        }
    }

    /// `dx/dt = f(x, u)` for any control, N entries: what a found motion is integrated with again.
    ///
    /// # Errors
    /// What stands against an evaluation at x.
    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError>;
}
