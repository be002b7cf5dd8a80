//! Steps along a branch of solutions.

use super::bordered::Bordered;
use super::parameter::Parameter;
use super::{Branch, BranchPoint, TurningPoint};
use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::error::{estimate, next_mesh};
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::{Arcs, Clock, Timed};
use crate::bvp::{Failure, Solvable};
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::{BoundaryValueProblem, Homotopy};
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::search::LOOSE;
use crate::solve::arcs::solve_arcs;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// Most Newton steps for one point.
const STEPS: usize = 10;
/// Smallest damping: what needs a smaller one may lead to another branch.
const DAMPING: f64 = 0.1;
/// Most meshes for one point.
const MESHES: usize = 8;

/// Where to look for the next point.
#[derive(Clone, Copy)]
pub(crate) enum Aim {
    /// So far along the branch; its direction has this sign in s.
    Along(f64, f64),
    /// At this s.
    At(f64),
}

/// A point of a branch.
pub(crate) struct Found {
    pub extremum: Extremum,
    /// s, from 0 to 1.
    pub position: f64,
    /// ds/d(length of the branch), lengths measured in s and in the root mean square of what changes in z, by its size.
    pub slope: f64,
    /// How far it was from where it was expected, in parts of the step.
    pub bend: f64,
}

/// A problem with a parameter, on its way.
pub(crate) struct Walker<'a> {
    pub problem: &'a Problem,
    pub parameter: Parameter,
    pub ends: (f64, f64),
    pub extremal: RobotExtremal,
    pub context: Context<'a>,
}

impl Walker<'_> {
    /// The parameter at s.
    pub fn value(&self, s: f64) -> f64 {
        between(self.ends, s)
    }

    /// A point in the direction of `aim`, with as many nodes as the tolerance takes.
    pub fn go(&mut self, from: &Found, aim: Aim) -> Result<Found, Status> {
        let (steps, damping) = (self.context.steps, self.context.damping);
        (self.context.steps, self.context.damping) = (STEPS, DAMPING);
        let found = self.go_on_meshes(from, aim);
        (self.context.steps, self.context.damping) = (steps, damping);
        found
    }

    fn go_on_meshes(&mut self, from: &Found, mut aim: Aim) -> Result<Found, Status> {
        let mut at = from.extremum.predicted(&mut self.extremal, None);
        let (mut position, ends, tolerance) = (from.position, self.ends, self.tolerance(&from.extremum));
        let (problem, parameter, options) = (self.problem, self.parameter, self.context.options.clone());
        let (mut bend, mut before) = (None, None);
        for _ in 0..MESHES {
            let (clock, arcs, points) = (at.clock, at.arcs, at.equations.method.len());
            let mut timed = Timed::new(&mut self.extremal, clock, arcs);
            let set = |timed: &mut Timed<'_, RobotExtremal>, s: f64| -> Result<(), Failure> {
                let value = between(ends, s);
                *timed.extremal = extremal(problem, (parameter, value), &options)?;
                if parameter == Parameter::FinalTime {
                    timed.clock = match timed.clock {
                        Clock::Split(_) => Clock::Split(value),
                        _ => Clock::Fixed(value),
                    };
                }
                Ok(())
            };
            let mut bordered = Bordered::new(at.equations, position, set);
            bordered.set_scales(&timed, None);
            bordered.linearise(&mut timed).map_err(Status::from)?;
            let length = match aim {
                Aim::At(s) => bordered.aim_at(s),
                Aim::Along(step, direction) => {
                    bordered.step(step, direction);
                    step.abs()
                }
            };
            let status = self.context.newton(&mut bordered, &mut timed, 0.1 * tolerance);
            if !status.is_converged() {
                return Err(status);
            }
            if bend.is_none() {
                bend = Some(if length > 0.0 { bordered.deviation() / length } else { 0.0 });
            }
            position = match aim {
                Aim::At(s) => s,
                Aim::Along(..) => bordered.inner.current.position,
            };
            let slope = bordered.slope();
            // The error at fixed s has no bound near a turning point; that across the branch has.
            let Bordered { inner, border, .. } = &mut bordered;
            let estimated = estimate(inner, &mut timed, |equations, defects, target| {
                equations.response(defects, target);
                border.bend(&equations.scale, target, 0.0);
            });
            let estimated = estimated.map_err(|error| Status::from(Failure::from(error)))?;
            let (clock, arcs, equations) = (timed.clock, timed.arcs.clone(), bordered.inner);
            if estimated.largest() <= tolerance {
                let estimate = Some(estimated);
                let ease = timed.extremal.relaxation();
                let extremum = Extremum { equations, clock, arcs, status: Status::Converged, ease, estimate };
                return Ok(Found { extremum, position, slope, bend: bend.unwrap_or(0.0) });
            }
            let most = options.max_nodes - 1;
            if equations.mesh.intervals() >= most - most / 20 {
                return Err(Status::MeshLimit);
            }
            let order = (equations.method.order(), most);
            let mesh = next_mesh(&equations.mesh, &estimated, before, order, tolerance);
            before = Some(estimated.largest());
            let sample = |arc: usize, s: f64, w: &mut [f64]| equations.sample(arc, s, w);
            let finer = Collocation::new(&timed, mesh, points, sample);
            let ease = timed.extremal.relaxation();
            at = Extremum {
                equations: finer,
                clock,
                arcs,
                status: Status::NewtonFailed,
                ease,
                estimate: None,
            };
            if let Aim::Along(..) = aim {
                aim = Aim::Along(0.0, slope);
            }
        }
        Err(Status::MeshLimit)
    }

    /// The turning point between a point and the one that `step` leads to, beyond it: where ds/d(length) vanishes.
    pub fn turn(&mut self, before: &Found, after: &Found, step: f64) -> TurningPoint {
        let (mut near, mut far) = ((0.0, before.slope), (step, after.slope));
        let (mut least, mut turn) = (after.slope.abs(), self.turning_point(after));
        for _ in 0..ROUNDS {
            let middle = (near.0 * far.1 - far.0 * near.1) / (far.1 - near.1);
            let Ok(found) = self.go(before, Aim::Along(middle, before.slope)) else { break };
            // Illinois: the end that stays counts half.
            if found.slope * near.1 > 0.0 {
                near = (middle, found.slope);
                far.1 *= 0.5;
            } else {
                far = (middle, found.slope);
                near.1 *= 0.5;
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

    fn turning_point(&mut self, found: &Found) -> TurningPoint {
        let (cost, _) = found.extremum.costs(&mut self.extremal);
        let final_time = found.extremum.final_time(&mut self.extremal);
        TurningPoint { parameter: self.value(found.position), cost, final_time, after: 0 }
    }

    /// The point on the arcs that its controls show; an error where there are none that the solution agrees with.
    pub fn on_its_arcs(&mut self, found: Found) -> Result<Found, Status> {
        let (states, tolerance) = (self.extremal.states(), self.context.options.tolerance);
        let extremum = &found.extremum;
        let on_arcs = !extremum.arcs.switches.is_empty();
        let forward = extremum.durations(2 * states).iter().all(|&duration| duration > 0.0);
        let reaches = !extremum.crossings(&mut self.extremal).is_empty();
        if forward && if on_arcs { extremum.agrees_with_arcs(&mut self.extremal) } else { !reaches } {
            let loose = self.tolerance(extremum) > tolerance;
            let Found { extremum, .. } = found;
            let extremum = if loose {
                extremum.solve(&mut self.extremal, tolerance, &mut self.context)
            } else {
                extremum
            };
            return if extremum.status.is_converged() {
                Ok(Found { extremum, ..found })
            } else {
                Err(extremum.status)
            };
        }
        if let Some(extremum) = solve_arcs(extremum, &mut self.extremal, tolerance, &mut self.context) {
            return Ok(Found { extremum, ..found });
        }
        // Perhaps nothing reaches a bound any more.
        if !on_arcs || self.problem.cost.effort.contains(&0.0) {
            return Err(Status::SwitchesNotRefined);
        }
        let one =
            on_one_arc(extremum, &mut self.extremal).solve(&mut self.extremal, tolerance, &mut self.context);
        let whole = one.status.is_converged() && one.crossings(&mut self.extremal).is_empty();
        if whole { Ok(Found { extremum: one, ..found }) } else { Err(Status::SwitchesNotRefined) }
    }

    /// Tolerance of a point: on one arc, where a control may be cut to its bounds, the solution is only a way to its arcs.
    pub fn tolerance(&self, extremum: &Extremum) -> f64 {
        let cut = self.problem.bounds.is_some() && !self.problem.cost.effort.contains(&0.0);
        let tolerance = self.context.options.tolerance;
        if cut && extremum.arcs.switches.is_empty() { LOOSE.max(tolerance) } else { tolerance }
    }

    /// Adds a point to the branch; `counted` iterations belong to those before.
    pub fn report(&mut self, found: &Found, branch: &mut Branch, counted: usize) -> usize {
        let (cost, penalty_cost) = found.extremum.costs(&mut self.extremal);
        branch.points.push(BranchPoint {
            parameter: self.value(found.position),
            cost,
            penalty_cost,
            final_time: found.extremum.final_time(&mut self.extremal),
            hamiltonian: found.extremum.mean_hamiltonian(),
            status: found.extremum.status.clone(),
            newton_steps: self.context.iterations.len() - counted,
        });
        self.context.iterations.len()
    }
}

/// The same motion without arcs, not yet solved.
fn on_one_arc(extremum: &Extremum, extremal: &mut RobotExtremal) -> Extremum {
    let z = 2 * extremal.states();
    let durations = extremum.durations(z);
    let total: f64 = durations.iter().sum();
    let mut lengths = Vec::new();
    for span in &extremum.equations.mesh.spans {
        if let Span::Interval { arc, length } = *span {
            lengths.push((length * durations[arc] / total).max(f64::EPSILON));
        }
    }
    let clock = match extremum.clock {
        Clock::Split(time) => Clock::Fixed(time),
        clock => clock,
    };
    let mut old = vec![0.0; extremum.equations.m];
    let (mesh, points) = (Mesh::from_lengths([lengths]), extremum.equations.method.len());
    Extremum::guess(extremal, (clock, Arcs::one()), mesh, points, |_, s, w| {
        let (mut left, mut arc) = (s * total, 0);
        while arc + 1 < durations.len() && left > durations[arc] {
            left -= durations[arc];
            arc += 1;
        }
        extremum.equations.sample(arc, (left / durations[arc]).clamp(0.0, 1.0), &mut old);
        w[..z].copy_from_slice(&old[..z]);
        w[z..].fill(total);
    })
}

/// From one end at s = 0 to the other at s = 1.
fn between(ends: (f64, f64), s: f64) -> f64 {
    if s == 1.0 { ends.1 } else { ends.0 + s * (ends.1 - ends.0) }
}

/// Most points that are tried for a turning point.
const ROUNDS: usize = 12;
/// ds/d(length) at what counts as one: s differs by its square.
const FLAT: f64 = 1e-5;

/// The extremal for a value of the parameter.
pub(crate) fn extremal(
    problem: &Problem,
    (parameter, value): (Parameter, f64),
    options: &SolverOptions,
) -> Result<RobotExtremal, Failure> {
    let refused = |error: String| Failure::OutOfRange(error);
    let changed = parameter.apply(problem, value).map_err(|error| refused(error.to_string()))?;
    let changed = changed.check().map_err(|error| refused(error.to_string()))?;
    let mut extremal = RobotExtremal::new(changed, options.jacobian)?;
    if parameter == Parameter::Smoothing {
        extremal.smooth(value);
    }
    Ok(extremal)
}
