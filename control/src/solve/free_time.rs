//! A final time that is free.

use crate::bvp::timed::Clock;
use crate::bvp::values::Values;
use crate::extremal::Extremal;
use crate::search::LOOSE;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// From a solution for a fixed time to one with H* = 0.
///
/// `dJ/dT = -H*`. Where all of the cost but c_t T falls like T^-3 (no gravity, no limits), `H* + c_t` falls like T^-4: this
/// leads near the right time; then T is one more unknown.
pub(crate) fn free_time<E: Extremal>(
    mut at: Extremum,
    extremal: &mut E,
    tolerance: f64,
    context: &mut Context<'_>,
) -> Extremum {
    let price = extremal.time_cost();
    for _ in 0..12 {
        if !at.status.is_converged() {
            return at;
        }
        let Clock::Fixed(time) = at.clock else { break };
        let energy = at.mean_hamiltonian() + price;
        let factor = if price > 0.0 && energy > 0.0 { (energy / price).powf(0.25) } else { 1.0 };
        let factor = factor.clamp(0.4, 2.5);
        if (factor - 1.0).abs() < 0.1 {
            break;
        }
        at = at.with_clock(extremal, Clock::Fixed(time * factor)).solve(
            extremal,
            LOOSE.max(tolerance),
            context,
        );
    }
    if !at.status.is_converged() {
        return at;
    }
    context.phase = "free time";
    let found = at.with_clock(extremal, Clock::Free).solve(extremal, tolerance, context);
    let positive = found.final_time(extremal) > 0.0;
    if positive { found } else { Extremum { status: Status::NewtonFailed, ..found } }
}

impl Extremum {
    /// The same values under another clock, not yet solved. A change of a fixed time stretches the motion.
    pub(crate) fn with_clock<E: Extremal>(&self, extremal: &mut E, clock: Clock) -> Self {
        let z_len = 2 * extremal.states();
        let durations = self.durations(z_len);
        let (mesh, points) = (self.equations.mesh.clone(), self.equations.method.len());
        let mut w = vec![0.0; self.equations.m];
        let mut starts = vec![0.0];
        durations.iter().for_each(|duration| starts.push(starts[starts.len() - 1] + duration));
        let arcs = (clock, self.arcs.clone());
        let mut found = Self::guess(extremal, arcs, mesh, points, |arc, s, target| {
            self.equations.sample(arc, s, &mut w);
            target[..z_len].copy_from_slice(&w[..z_len]);
            match &mut target[z_len..] {
                [theta] => *theta = durations[arc],
                [theta, t] => (*theta, *t) = (durations[arc], starts[arc] + s * durations[arc]),
                _ => {}
            }
        });
        if let (Clock::Fixed(old), Clock::Fixed(new)) = (self.clock, clock) {
            let Values { nodes, inner, .. } = &mut found.equations.current;
            let all = nodes.chunks_exact_mut(z_len).chain(inner.chunks_exact_mut(z_len));
            all.for_each(|z| extremal.stretch(z, new / old));
        }
        found
    }

    /// Mean of H* over the nodes.
    pub(crate) fn mean_hamiltonian(&self) -> f64 {
        let rates = &self.equations.rates.0;
        rates.iter().map(|rate| rate.hamiltonian).sum::<f64>() / rates.len() as f64
    }
}
