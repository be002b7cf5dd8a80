//! Turning points, and the change of arcs along a branch.

use super::TurningPoint;
use super::walk::{Aim, Found, Walker};
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::{Arcs, Clock};
use crate::constants::branch::{FLAT, TURNING_ROUNDS};
use crate::extremal::BoundaryValueProblem;
use crate::extremal::hamiltonian::RobotExtremal;
use crate::solve::arcs::solve_arcs;
use crate::solve::{Discretisation, Layout};
use crate::status::Status;

/// A length along the branch, and ds/d(length) there.
#[derive(Clone, Copy)]
struct Bracket {
    length: f64,
    slope: f64,
}

impl Walker<'_, '_> {
    /// The turning point between a point and the one that `step` leads to, beyond it: where ds/d(length)
    /// vanishes, by regula falsi (Illinois).
    pub fn turn(&mut self, before: &Found, after: &Found, step: f64) -> TurningPoint {
        let mut near = Bracket { length: 0.0, slope: before.slope };
        let mut far = Bracket { length: step, slope: after.slope };
        let (mut least, mut turn) = (after.slope.abs(), self.turning_point(after));
        for _ in 0..TURNING_ROUNDS {
            let middle = (near.length * far.slope - far.length * near.slope) / (far.slope - near.slope);
            let aim = Aim::Along { step: middle, direction: before.slope };
            let Ok(found) = self.go(before, aim) else { break };
            let bracket = Bracket { length: middle, slope: found.slope };
            // The end that stays counts half.
            if found.slope * near.slope > 0.0 {
                near = bracket;
                far.slope *= 0.5;
            } else {
                far = bracket;
                near.slope *= 0.5;
            }
            if found.slope.abs() < least {
                (least, turn) = (found.slope.abs(), self.turning_point(&found));
            }
            if least < FLAT {
                break;
            }
        }
        turn
    }

    /// The point on the arcs that its controls show.
    ///
    /// # Errors
    /// [`Status::SwitchesNotRefined`] if there are none that the solution agrees with.
    pub fn on_its_arcs(&mut self, found: Found) -> Result<Found, Status> {
        let (states, tolerance) = (self.extremal.states(), self.attempt.tolerance);
        let at = &found.solved.found;
        let on_arcs = !at.arcs.switches.is_empty();
        let forward = at.durations(2 * states).iter().all(|&duration| duration > 0.0);
        let reaches = !at.crossings(&mut self.extremal).is_empty();
        if forward && if on_arcs { at.agrees_with_arcs(&mut self.extremal) } else { !reaches } {
            let loose = self.attempt_for(at).tolerance > tolerance;
            let Found { solved, .. } = found;
            let solved = if loose {
                solved.found.solve(&mut self.extremal, &self.attempt, &mut self.recorder)
            } else {
                solved
            };
            return if solved.is_converged() { Ok(Found { solved, ..found }) } else { Err(solved.status) };
        }
        if let Some(solved) = solve_arcs(at, &mut self.extremal, &self.attempt, &mut self.recorder) {
            return Ok(Found { solved, ..found });
        }
        // Perhaps no control reaches a bound any more.
        if !on_arcs || self.family.problem.cost.effort.contains(&0.0) {
            return Err(Status::SwitchesNotRefined);
        }
        let one = at.on_one_arc(&mut self.extremal);
        let one = one.solve(&mut self.extremal, &self.attempt, &mut self.recorder);
        let whole = one.is_converged() && one.found.crossings(&mut self.extremal).is_empty();
        if whole { Ok(Found { solved: one, ..found }) } else { Err(Status::SwitchesNotRefined) }
    }
}

impl Discretisation {
    /// The same motion without arcs.
    fn on_one_arc(&self, extremal: &mut RobotExtremal) -> Self {
        let z = 2 * extremal.states();
        let durations = self.durations(z);
        let total: f64 = durations.iter().sum();
        let mut lengths = Vec::new();
        for span in &self.equations.mesh.spans {
            if let Span::Interval { arc, length } = *span {
                lengths.push((length * durations[arc] / total).max(f64::EPSILON));
            }
        }
        let clock = match self.clock {
            Clock::Split(time) => Clock::Fixed(time),
            clock => clock,
        };
        let mut old = vec![0.0; self.equations.m];
        let (mesh, points) = (Mesh::from_lengths([lengths]), self.equations.method.len());
        let layout = Layout { clock, arcs: Arcs::one(), mesh, points };
        Self::new(extremal, layout, |_, s, w| {
            let (mut left, mut arc) = (s * total, 0);
            while arc + 1 < durations.len() && left > durations[arc] {
                left -= durations[arc];
                arc += 1;
            }
            self.equations.sample(arc, (left / durations[arc]).clamp(0.0, 1.0), &mut old);
            w[..z].copy_from_slice(&old[..z]);
            w[z..].fill(total);
        })
    }
}
