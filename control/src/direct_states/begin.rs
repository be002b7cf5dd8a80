//! Where the iteration begins, and what the cost is measured by.

use super::guess::Guess;
use super::points::{Layout, POINTS, Radau};
use super::problem::{DirectDynamics, DirectDynamicsError};
use crate::extremal::dynamics::problem::DynamicsProblemError;
use crate::problem::FinalTime;
use costate::dynamics::{Cost, Dynamics};

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// Begins with this motion instead of a straight line between the ends: x and u at the times t (s), which
    /// increase; straight lines between them. A fixed duration stretches it; a free one begins with its own.
    /// Fixed components of the ends are those of the problem, and values beyond limits are moved inside.
    ///
    /// # Errors
    /// Lists of different or wrong lengths, fewer than two times or times that do not increase, numbers that
    /// are not finite.
    pub fn with_guess(self, t: &[f64], x: &[Vec<f64>], u: &[Vec<f64>]) -> Result<Self, DirectDynamicsError> {
        let (n, m) = (self.model.states(), self.model.controls());
        let wrong = |field, expected, found| DynamicsProblemError::WrongLength { field, expected, found };
        for (field, rows, size) in [("x of the guess", x, n), ("u of the guess", u, m)] {
            if rows.len() != t.len() {
                return Err(DirectDynamicsError::GuessLength { times: t.len(), field, found: rows.len() });
            }
            if let Some(row) = rows.iter().find(|row| row.len() != size) {
                return Err(wrong(field, size, row.len()).into());
            }
            if let Some(&value) = rows.iter().flatten().find(|value| !value.is_finite()) {
                let range = "must be finite";
                return Err(DynamicsProblemError::OutOfRange { field, value, range }.into());
            }
        }
        // Not true for NaN.
        let increases = |pair: &[f64]| pair[0] < pair[1] && (pair[1] - pair[0]).is_finite();
        if t.len() < 2 || !t.windows(2).all(increases) {
            return Err(DirectDynamicsError::GuessTimes);
        }
        Ok(Self { guess: Some(Guess { t: t.to_vec(), x: x.to_vec(), u: u.to_vec() }), ..self })
    }

    /// The unknowns of the guess: a straight line between the ends, controls at zero, or what was given.
    pub(super) fn unknowns(&self, layout: &Layout) -> Vec<f64> {
        let mut w = vec![0.0; layout.count()];
        let size = layout.n + layout.m;
        let (start, end) = (&self.problem.start.x, &self.problem.end.x);
        let at = |s: f64, out: &mut [f64]| match &self.guess {
            Some(guess) => guess.at(s, out),
            None => {
                let line = start.iter().zip(end).map(|(start, end)| start + s * (end - start));
                out.iter_mut().zip(line).for_each(|(out, x)| *out = x);
            }
        };
        let mut first = vec![0.0; size];
        at(0.0, &mut first);
        w[..layout.n].copy_from_slice(&first[..layout.n]);
        let radau = Radau::new();
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                let s = (k as f64 + radau.places[j + 1]) / layout.intervals as f64;
                at(s, &mut w[layout.point(k, j)..][..size]);
            }
        }
        w[layout.time()] = match (&self.guess, &self.problem.time) {
            (Some(guess), FinalTime::Free { .. }) => guess.t[guess.t.len() - 1] - guess.t[0],
            _ => self.problem.time.value(),
        };
        w
    }

    /// The size of J before anything is known: along the guess
    ///
    /// $$ c_t T + \int_0^T \left( |\tfrac12 u^\top R u + l| +
    ///    \tfrac12 \sum_i |l_{u_i u_i} + r_i| \\, \bar u_i^2 \right) dt $$
    ///
    /// with $\bar u_i$ half the range of a control, at most 1. If that is zero the same with $l_{xx}$ at
    /// states of size 1, or one if nothing is left.
    pub(super) fn size_of_cost(&mut self, layout: &Layout, w: &[f64]) -> f64 {
        let (n, size, time) = (layout.n, layout.n + layout.m, w[layout.time()]);
        let half = |i: usize| (0.5 * (self.u_limits[1][i] - self.u_limits[0][i])).min(1.0);
        let squares: Vec<f64> = (0..layout.m).map(|i| half(i).powi(2)).collect();
        let (mut first, mut second) = (vec![0.0; size], vec![0.0; size * size]);
        let (mut cost, mut of_states) = (self.problem.cost.time * time, 0.0);
        let weights = Radau::new().weights;
        for k in 0..layout.intervals {
            for (j, weight) in weights.iter().enumerate() {
                let (x, u) = w[layout.point(k, j)..][..size].split_at(n);
                let Ok(l) = self.running_derivatives(x, u, &mut first, &mut second) else { return 1.0 };
                let weight = weight * time / layout.intervals as f64;
                let curvature = |i: usize| 0.5 * second[i * size + i].abs();
                let of_controls: f64 = squares.iter().enumerate().map(|(i, u)| curvature(n + i) * u).sum();
                cost += weight * (l.abs() + of_controls);
                of_states += weight * (0..n).map(curvature).sum::<f64>();
            }
        }
        // Not true for NaN.
        [cost, of_states].into_iter().find(|&size| size > 0.0 && size.is_finite()).unwrap_or(1.0)
    }
}
