//! The ends of the phases of a motion among the unknowns: its start, its vias, its end.

use super::power::Powers;
use super::side::{Limited, Side};
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::direct::motion::times::FreeTimes;
use crate::problem::loop_rows::{Foot, LoopPhase, Loops, Walk};
use crate::problem::{BoundaryState, Problem};
use std::ops::Range;

/// The rows along a motion, in their order, that are implied at an end.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Settled {
    /// By the place that is given.
    pub place: Vec<bool>,
    /// The rates of the rows, by the rates that are given.
    pub rate: Vec<bool>,
}

/// An unknown of the start that is shared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tie {
    /// Its place in the state of the start.
    pub start: usize,
    /// The place in the state of the end that follows it at a constant distance, if there is one.
    pub end: Option<usize>,
    /// By how much that one moves for one: 1, or -1 if it goes the other way in a mirror.
    pub sign: f64,
}

/// What is given at the ends of the phases, K + 1 of them: 0 is the start of the motion, K its end.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    /// For each end and each unknown there (q, v, with continuous accelerations a): whether it is given.
    pub given: Vec<Vec<bool>>,
    /// Number of joints.
    dof: usize,
    /// Which times of phases are unknowns.
    pub times: FreeTimes,
    /// Unknowns of the start that those of the end follow, and what else both ends have rows of.
    pub tied: Vec<Tie>,
    /// Whether the end follows the start, what is given there too.
    pub is_periodic: bool,
    /// The rows along the motion that hold at each end; empty where there are none.
    pub settled: Vec<Settled>,
    /// The first coordinate whose rate at the start is an impulse: those after the joints of a step.
    impulses: Option<usize>,
    /// For each phase the sides that do not count in it, by what they limit and its number: forces on feet
    /// that swing, heights of feet that stand. Empty where all count everywhere.
    absent: Vec<Vec<(Limited, usize)>>,
    /// For each phase the heights that are zero with their rates at its start, and at its end.
    resting: Vec<[Vec<usize>; 2]>,
}

/// The sides that do not count in each phase of a step, whose points have so many rows of powers.
fn absent(loops: &Loops, powers: usize) -> Vec<Vec<(Limited, usize)>> {
    let Some(walk) = &loops.walk else { return Vec::new() };
    let n = walk.exchange.len();
    // Rows of cones, in the order of their feet.
    let mut first = 0;
    let cone = |foot: &Foot| {
        let own = first..first + walk.gait.cone(foot.contact).len();
        first = own.end;
        (foot.rows.end, own)
    };
    let cones: Vec<(usize, Range<usize>)> = walk.feet.iter().map(cone).collect();
    let resting = walk.gait.resting_corners(walk.gait.trailing);
    let of_phase = |phase: &LoopPhase| {
        let idle = (phase.rows..loops.rows.len()).map(|row| (Limited::Acceleration, n + row));
        let released = cones.iter().filter(|(last, _)| *last > phase.rows);
        let cones = released.flat_map(|(_, sides)| sides.clone());
        // Where all feet stand, what rests on the ground has no height.
        let stands = walk.has_double_support() && phase.rows == loops.rows.len();
        let heights =
            (0..walk.gait.swing.len() * resting.len()).filter(|i| stands && resting[i % resting.len()]);
        let heights = heights.map(|corner| (Limited::Task, corner));
        idle.chain(cones.map(|row| (Limited::ToolAcceleration, powers + row))).chain(heights).collect()
    };
    loops.phases.iter().map(of_phase).collect()
}

/// The heights that are zero with their rates at the start and at the end of each phase, whatever the motion
/// is: of soles in a step with double support, which leave the ground and come to it at rest.
fn resting(loops: &Loops) -> Vec<[Vec<usize>; 2]> {
    let rest = |walk: &&Walk| walk.has_double_support() && walk.gait.sole.is_some();
    let Some(walk) = loops.walk.as_ref().filter(rest) else { return Vec::new() };
    let rests = walk.gait.resting_corners(walk.gait.trailing);
    let all = 0..walk.gait.swing.len() * rests.len();
    let of = |rest: bool| all.clone().filter(|i| rests[i % rests.len()] == rest).collect::<Vec<_>>();
    vec![[of(false), Vec::new()], [of(true), all.clone().collect()]]
}

impl Ends {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.coordinates();
        let smooth = Shape::of(problem).is_smooth();
        let given = |state: &BoundaryState| {
            let q = (0..n).map(|i| !state.q_free.contains(&i));
            let v = (0..n).map(|i| !state.v_free.contains(&i));
            let a = (0..if smooth { n } else { 0 }).map(|_| state.a.is_some());
            q.chain(v).chain(a).collect()
        };
        let states = problem.ends();
        let given: Vec<Vec<bool>> = states.iter().map(given).collect();
        let walk = problem.loops.as_ref().and_then(|loops| loops.walk.as_ref());
        let is_tied = |i: &usize| (problem.periodic.is_some() || walk.is_some()) && !given[0][*i];
        let tie = |i: usize| {
            let (end, sign) = match walk {
                // Positions change places; rows relate the rates of both ends.
                Some(walk) => walk.exchange.get(i).map_or((None, 1.0), |&(from, sign)| (Some(from), sign)),
                None => (Some(i), 1.0),
            };
            Tie { start: i, end, sign }
        };
        let tied = (0..given[0].len()).filter(is_tied).map(tie).collect();
        Self {
            dof: n,
            times: FreeTimes::of(problem),
            tied,
            is_periodic: problem.periodic.is_some(),
            given,
            settled: vec![Settled::default(); states.len()],
            impulses: walk.map(|walk| walk.exchange.len()),
            resting: problem.loops.as_ref().map_or(Vec::new(), |loops| resting(loops)),
            absent: problem
                .loops
                .as_ref()
                .map_or(Vec::new(), |loops| absent(loops, Powers::new(problem).rows())),
        }
    }

    /// Whether a side does not count in a phase.
    pub fn is_absent(&self, phase: usize, side: &Side) -> bool {
        self.absent.get(phase).is_some_and(|sides| sides.contains(&(side.limited, side.joint)))
    }

    /// Whether a row along the motion holds at an end with its rate, whatever the motion is.
    fn keeps(&self, end: usize, row: usize) -> bool {
        self.has_place(end, row) && self.has_rate(end, row)
    }

    fn has_place(&self, end: usize, row: usize) -> bool {
        self.settled[end].place.get(row).is_some_and(|settled| *settled)
    }

    fn has_rate(&self, end: usize, row: usize) -> bool {
        self.settled[end].rate.get(row).is_some_and(|settled| *settled)
    }

    /// Whether the position, rate or acceleration of a side is given at an end.
    pub fn is_given(&self, end: usize, side: &Side) -> bool {
        let at = side.index(self.dof);
        self.given[end].get(at).is_some_and(|given| *given)
    }

    /// Whether a side limits an impulse, which it does at the start alone: later rates follow from forces,
    /// whose limits would be the same ones a second time.
    pub fn is_impulse(&self, side: &Side) -> bool {
        side.limited == Limited::Rate && self.impulses.is_some_and(|first| side.joint >= first)
    }

    /// Whether nothing is free at an end, the acceleration neither.
    fn is_all_given(&self, end: usize) -> bool {
        self.given[end].len() > 2 * self.dof && self.given[end].iter().all(|given| *given)
    }

    /// The number of unknowns that all intervals share, or those of the start and of the end: parameters of
    /// the times, then what is tied.
    pub fn shared(&self) -> usize {
        self.times.count() + self.tied.len()
    }

    /// Whether the ends settle a side at a point, whatever the motion is, or there would be more equations
    /// than unknowns with it: three for each interval and joint.
    pub fn is_settled(&self, mesh: &Mesh, p: usize, side: &Side) -> bool {
        if self.is_impulse(side) {
            return true;
        }
        let (k, j) = mesh.interval_of(p);
        let phase = mesh.phase(k);
        if self.is_absent(phase, side) {
            return true;
        }
        let points = mesh.points_of_phase(phase);
        // The end of the phase that is so many points away, on either side.
        let near = |distance: usize| {
            let left = (p == points.start + distance).then_some(phase);
            let right = (p + distance + 1 == points.end).then_some(phase + 1);
            left.into_iter().chain(right)
        };
        let is_row = (side.is_equation || side.is_half) && side.limited == Limited::Task;
        let rests =
            |end: usize| self.resting.get(phase).is_some_and(|ends| ends[end - phase].contains(&side.joint));
        if side.limited == Limited::Task && near(0).any(rests) {
            return true;
        }
        // The end holds equations already; with a point beside it there would be one too many.
        let is_via = |end: usize| end > 0 && end < mesh.phases();
        let holds = |end: usize| match is_via(end) {
            // Given positions or rates of a via take one of the two points beside it each.
            true => {
                if end > phase {
                    self.has_place(end, side.joint)
                } else {
                    self.has_rate(end, side.joint)
                }
            }
            false => self.keeps(end, side.joint),
        };
        if is_row && near(0).any(holds) {
            return true;
        }
        if !mesh.shape.is_smooth() {
            return false;
        }
        // The node that an interval shares with the next one has an equation too, so the middle has none.
        let middle = side.is_equation && j == mesh.shape.stride() / 2;
        // So do two phases, whose points at a via are two.
        let twice = side.is_equation && p == points.start && phase > 0;
        let beside = |end: usize| self.keeps(end, side.joint) && self.is_all_given(end);
        let is_beside = is_row && near(1).any(beside);
        let settled = near(0).any(|end| match side.limited {
            Limited::Position | Limited::Rate | Limited::Acceleration => self.is_given(end, side),
            // The torque of a via depends on what the robot carries before and after it.
            _ => self.is_all_given(end),
        });
        middle || twice || is_beside || settled
    }

    /// All given unknowns, and those that are tied, among those of a mesh: node, place in its state.
    pub fn removed(&self, mesh: &Mesh) -> impl Iterator<Item = (usize, usize)> {
        let given = mesh.ends().iter().zip(&self.given).flat_map(|(&node, given)| {
            given.iter().enumerate().filter(|(_, given)| **given).map(move |(i, _)| (node, i))
        });
        let last = mesh.intervals();
        let tied = self
            .tied
            .iter()
            .flat_map(move |tie| [Some((0, tie.start)), tie.end.map(|i| (last, i))].into_iter().flatten());
        given.chain(tied)
    }

    /// The part of a derivative by the unknowns and by the times of all phases that is one by the shared
    /// unknowns; then zero for what is removed.
    pub fn reduce(&self, mesh: &Mesh, by_unknowns: &mut [f64], by_times: &[f64], shared: &mut [f64]) {
        let node = mesh.shape.node() * self.dof;
        let (times, tied) = shared.split_at_mut(self.times.count());
        self.times.reduce(by_times, times);
        let last = node * mesh.intervals();
        for (to, tie) in tied.iter_mut().zip(&self.tied) {
            *to = by_unknowns[tie.start] + tie.end.map_or(0.0, |i| tie.sign * by_unknowns[last + i]);
        }
        self.removed(mesh).for_each(|(k, i)| by_unknowns[node * k + i] = 0.0);
    }

    /// The steps of removed unknowns and of the times by those of the shared ones.
    pub fn expand(&self, mesh: &Mesh, shared: &[f64], unknowns: &mut [f64], times: &mut Vec<f64>) {
        let node = mesh.shape.node() * self.dof;
        let (of_times, tied) = shared.split_at(self.times.count());
        self.times.expand(of_times, times);
        for (&step, tie) in tied.iter().zip(&self.tied) {
            unknowns[tie.start] = step;
            if let Some(i) = tie.end {
                unknowns[node * mesh.intervals() + i] = tie.sign * step;
            }
        }
    }
}
