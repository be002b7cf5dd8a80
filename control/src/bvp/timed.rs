//! Extremals over a scaled time, with the durations of arcs as unknowns.
//!
//! $$ \frac{dw}{ds} = (\theta g(z), 0, \theta), \qquad w = (z, \theta, t), \qquad 0 \le s \le 1 $$
//!
//! on each arc; which of `theta` and `t` are among the unknowns depends on the [`Clock`]. Source: U. M.
//! Ascher, R. M. M. Mattheij, R. D. Russell, *Numerical Solution of Boundary Value Problems for ODEs*, SIAM
//! 1995, section 11.

use crate::extremal::{BoundSide, ControlLaw, Extremal, HamiltonianTerms, SideChange};
use costate::EvalError;

/// What is known about the final time and the durations of arcs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Clock {
    /// One arc of a given duration (s).
    Fixed(f64),
    /// Durations are unknown: w = (z, theta), theta' = 0 on each arc, H* = 0 at the end.
    Free,
    /// Durations are unknown, their sum T (s) is given: w = (z, theta, t), t' = theta, t = T at the end.
    Split(f64),
}

/// The arcs of an extremal: on each a scaled time runs through a range of length 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arcs {
    /// On each arc which controls are at a bound; `None` where the maximum of the Hamiltonian decides.
    pub sides: Vec<Option<Vec<BoundSide>>>,
    /// Between two arcs.
    pub switches: Vec<Switch>,
}

/// A control changes sides between two arcs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Switch {
    pub control: usize,
    pub change: SideChange,
}

impl Arcs {
    /// One arc with controls that maximise the Hamiltonian.
    pub fn one() -> Self {
        Self { sides: vec![None], switches: Vec::new() }
    }

    pub fn law(&self, arc: usize) -> ControlLaw<'_> {
        self.sides[arc].as_deref().map_or(ControlLaw::Maximal, ControlLaw::Given)
    }
}

/// `dw/ds = theta g(z)`: a problem with m unknowns w at each point of a scaled time s.
pub(crate) struct Timed<'a, E: ?Sized = dyn Extremal + 'a> {
    pub extremal: &'a mut E,
    pub clock: Clock,
    pub arcs: Arcs,
    /// Jacobian of g.
    small: Vec<f64>,
    gradient: Vec<f64>,
}

impl<'a, E: Extremal + ?Sized> Timed<'a, E> {
    pub fn new(extremal: &'a mut E, clock: Clock, arcs: Arcs) -> Self {
        let z = 2 * extremal.states();
        Self { extremal, clock, arcs, small: vec![0.0; z * z], gradient: vec![0.0; z] }
    }

    /// Length of z.
    pub fn z_len(&self) -> usize {
        2 * self.extremal.states()
    }

    /// Number of unknowns m at each point.
    pub fn len(&self) -> usize {
        let further = match self.clock {
            Clock::Fixed(_) => 0,
            Clock::Free => 1,
            Clock::Split(_) => 2,
        };
        self.z_len() + further
    }

    /// Number of conditions at the start.
    pub fn at_start(&self) -> usize {
        self.extremal.states() + usize::from(matches!(self.clock, Clock::Split(_)))
    }

    /// Duration of the arc that w lies on.
    pub fn duration(&self, w: &[f64]) -> f64 {
        match self.clock {
            Clock::Fixed(time) => time,
            _ => w[self.z_len()],
        }
    }

    /// dw/ds.
    pub fn evaluate(&mut self, w: &[f64], arc: usize, g: &mut [f64]) -> Result<HamiltonianTerms, EvalError> {
        let (z, duration) = (self.z_len(), self.duration(w));
        let rate = self.extremal.evaluate(&w[..z], self.arcs.law(arc), &mut g[..z])?;
        self.scale(duration, g);
        Ok(rate)
    }

    fn scale(&self, duration: f64, g: &mut [f64]) {
        let (of_z, rest) = g.split_at_mut(self.z_len());
        of_z.iter_mut().for_each(|g| *g *= duration);
        match rest {
            [theta] => *theta = 0.0,
            [theta, t] => (*theta, *t) = (0.0, duration),
            _ => {}
        }
    }

    /// dw/ds and its Jacobian, m x m.
    pub fn linearise(
        &mut self,
        w: &[f64],
        arc: usize,
        g: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<HamiltonianTerms, EvalError> {
        let (z, m, duration) = (self.z_len(), self.len(), self.duration(w));
        let law = self.arcs.law(arc);
        let rate = self.extremal.linearise(&w[..z], law, &mut g[..z], &mut self.small)?;
        jacobian.fill(0.0);
        for i in 0..z {
            let (row, small) = (&mut jacobian[i * m..(i + 1) * m], &self.small[i * z..(i + 1) * z]);
            row.iter_mut().zip(small).for_each(|(to, &from)| *to = duration * from);
            if m > z {
                row[z] = g[i];
            }
        }
        if m == z + 2 {
            jacobian[(z + 1) * m + z] = 1.0;
        }
        self.scale(duration, g);
        Ok(rate)
    }

    /// Conditions at the start and their Jacobian, `at_start x m`.
    pub fn start(&mut self, w: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        let (z, m, states) = (self.z_len(), self.len(), self.extremal.states());
        self.extremal.start(&w[..z], &mut residual[..states], &mut self.small[..states * z])?;
        self.widen(states, jacobian);
        if m == z + 2 {
            residual[states] = w[z + 1];
            jacobian[states * m + z + 1] = 1.0;
        }
        Ok(())
    }

    /// Conditions at the end and their Jacobian, `(m - at_start) x m`.
    ///
    /// H* has the gradient `(-y', x')`.
    pub fn end(&mut self, w: &[f64], residual: &mut [f64], jacobian: &mut [f64]) -> Result<(), EvalError> {
        let (z, m, states) = (self.z_len(), self.len(), self.extremal.states());
        self.extremal.end(&w[..z], &mut residual[..states], &mut self.small[..states * z])?;
        self.widen(states, jacobian);
        match self.clock {
            Clock::Fixed(_) => {}
            Clock::Free => {
                let last = self.arcs.sides.len() - 1;
                let rate = self.extremal.evaluate(&w[..z], self.arcs.law(last), &mut self.gradient)?;
                residual[states] = rate.hamiltonian;
                let row = &mut jacobian[states * m..(states + 1) * m];
                for i in 0..states {
                    row[i] = -self.gradient[states + i];
                    row[states + i] = self.gradient[i];
                }
            }
            Clock::Split(time) => {
                residual[states] = w[z + 1] - time;
                jacobian[states * m + z + 1] = 1.0;
            }
        }
        Ok(())
    }

    /// Rows of z entries into rows of m.
    fn widen(&self, rows: usize, jacobian: &mut [f64]) {
        let (z, m) = (self.z_len(), self.len());
        jacobian.fill(0.0);
        for i in 0..rows {
            jacobian[i * m..i * m + z].copy_from_slice(&self.small[i * z..(i + 1) * z]);
        }
    }

    /// The switching function between arc and arc + 1 and its gradient, z entries.
    pub fn switching(&mut self, arc: usize, w: &[f64]) -> (f64, &[f64]) {
        let Switch { control, change } = self.arcs.switches[arc];
        let z = self.gradient.len();
        let value = self.extremal.switching(control, change, &w[..z], &mut self.gradient);
        (value, &self.gradient)
    }
}
