//! Free final time.
//!
//! At zero costates the condition `H* = 0` does not determine T. So the problem is solved for fixed times
//! first. With
//! $$ \frac{dJ}{dT} = -H^\ast $$
//! and all of the cost but `c_t T` falling like `T^-3` (no gravity, no limits), `H* + c_t` falls like `T^-4`.
//! This leads near the optimal time; then T is one more unknown, and `H*(T) = 0` one more condition.

use crate::bvp::timed::Clock;
use crate::bvp::values::Values;
use crate::constants::free_time::{LARGEST_FACTOR, LEAST_FACTOR, NEAR, POWER, ROUNDS};
use crate::extremal::Extremal;
use crate::progress::Phase;
use crate::solve::{Attempt, Discretisation, Layout, Recorder, Solved};
use crate::status::Status;

/// From a solution for a fixed time to one with H* = 0.
pub(crate) fn free_time(
    mut at: Solved,
    extremal: &mut dyn Extremal,
    attempt: &Attempt,
    recorder: &mut Recorder<'_>,
) -> Solved {
    let price = extremal.time_cost();
    for _ in 0..ROUNDS {
        if !at.is_converged() {
            return at;
        }
        let Clock::Fixed(time) = at.found.clock else { break };
        let energy = at.found.mean_hamiltonian() + price;
        let factor = if price > 0.0 && energy > 0.0 { (energy / price).powf(POWER) } else { 1.0 };
        let factor = factor.clamp(LEAST_FACTOR, LARGEST_FACTOR);
        if (factor - 1.0).abs() < NEAR {
            break;
        }
        let next = at.found.with_clock(extremal, Clock::Fixed(time * factor));
        at = next.solve(extremal, &attempt.loose(), recorder);
    }
    if !at.is_converged() {
        return at;
    }
    let free = at.found.with_clock(extremal, Clock::Free);
    let free = free.solve(extremal, &attempt.in_phase(Phase::FreeTime), recorder);
    let positive = free.found.final_time(extremal) > 0.0;
    if positive { free } else { free.with_status(Status::NewtonFailed) }
}

impl Discretisation {
    /// The same values under another clock. A change of a fixed time stretches the motion.
    pub fn with_clock(&self, extremal: &mut dyn Extremal, clock: Clock) -> Self {
        let z_len = 2 * extremal.states();
        let durations = self.durations(z_len);
        let mut w = vec![0.0; self.equations.m];
        let mut starts = vec![0.0];
        durations.iter().for_each(|duration| starts.push(starts[starts.len() - 1] + duration));
        let layout = Layout { clock, ..self.layout() };
        let mut found = Self::new(extremal, layout, |arc, s, target| {
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
}
