//! Start and end of a motion among the unknowns.

use super::shape::Shape;
use super::side::{Limited, Side};
use super::spline::{Mesh, Spline};
use crate::problem::{BoundaryState, FinalTime, Problem, ToolPose};

/// For each unknown (q and its derivatives in s) of the first and of the last node: `None` if it is free,
/// else the given derivative in time, zero for q: q' = T v and q'' = T^2 a change with T.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    /// Start and end.
    pub given: [Vec<Option<f64>>; 2],
    /// Number of joints.
    dof: usize,
    /// Whether T is an unknown.
    pub free_time: bool,
    /// Whether an end has given rates and a given place: all positions, or those of tools.
    keeps: [bool; 2],
}

/// Whether rates are given, and a place by joints or by tools.
fn keeps(state: &BoundaryState, tools: &[ToolPose]) -> bool {
    state.v_free.is_empty() && (state.q_free.is_empty() || !tools.is_empty())
}

impl Ends {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.robot.dof();
        let smooth = Shape::of(problem).is_smooth();
        let given = |state: &BoundaryState| {
            let q = (0..n).map(|i| (!state.q_free.contains(&i)).then_some(0.0));
            let v = (0..n).map(|i| (!state.v_free.contains(&i)).then_some(state.v[i]));
            let a = (0..if smooth { n } else { 0 }).map(|i| state.a.as_ref().map(|a| a[i]));
            q.chain(v).chain(a).collect()
        };
        Self {
            given: [given(&problem.start), given(&problem.end)],
            dof: n,
            free_time: matches!(problem.time, FinalTime::Free { .. }),
            keeps: [
                keeps(&problem.start, &problem.task.start_tools),
                keeps(&problem.end, &problem.task.end_tools),
            ],
        }
    }

    /// Whether what holds along the motion holds at an end (0 or 1) with its rate, whatever the motion is.
    pub fn keeps(&self, end: usize) -> bool {
        self.keeps[end]
    }

    /// Whether the position, rate or acceleration of a side is given at an end.
    pub fn is_given(&self, end: usize, side: &Side) -> bool {
        let at = side.index(self.dof);
        self.given[end].get(at).is_some_and(Option::is_some)
    }

    /// Whether nothing is free at an end, the acceleration neither.
    fn is_all_given(&self, end: usize) -> bool {
        self.given[end].len() > 2 * self.dof && self.given[end].iter().all(Option::is_some)
    }

    /// Whether the ends settle a side at a point, whatever the motion is, or there would be more equations
    /// than unknowns with it: three for each interval and joint.
    pub fn is_settled(&self, mesh: &Mesh, p: usize, side: &Side) -> bool {
        let last = mesh.points() - 1;
        let near = |distance: usize| [(distance, 0), (last - distance, 1)].into_iter();
        let at_end = near(0).find(|(at, _)| *at == p).map(|(_, end)| end);
        let is_row = (side.is_equation || side.is_half) && side.limited == Limited::Task;
        // The end holds equations already; with a point beside it there would be one too many.
        if is_row && at_end.is_some_and(|end| self.keeps(end)) {
            return true;
        }
        if !mesh.shape.is_smooth() {
            return false;
        }
        // The node that an interval shares with the next one has an equation too, so the middle has none.
        let middle = side.is_equation && mesh.interval_of(p).1 == mesh.shape.stride() / 2;
        let beside = |end: usize| self.keeps(end) && self.is_all_given(end);
        let is_beside = is_row && near(1).any(|(at, end)| at == p && beside(end));
        let settled = at_end.is_some_and(|end| match side.limited {
            Limited::Position | Limited::Rate | Limited::Acceleration => self.is_given(end, side),
            _ => self.is_all_given(end),
        });
        middle || is_beside || settled
    }

    /// The first and the second derivative in T of a given unknown: entry `i` of its node.
    fn in_time(&self, i: usize, given: f64, time: f64) -> [f64; 2] {
        match i / self.dof {
            0 => [0.0; 2],
            1 => [given, 0.0],
            _ => [2.0 * time * given, 2.0 * given],
        }
    }

    /// All given unknowns among those of a mesh: node, place in its state, derivatives in T.
    pub fn with_curvatures(
        &self,
        intervals: usize,
        time: f64,
    ) -> impl Iterator<Item = (usize, usize, [f64; 2])> {
        [0, intervals].into_iter().zip(&self.given).flat_map(move |(k, given)| {
            let known = given.iter().enumerate();
            known.filter_map(move |(i, given)| Some((k, i, self.in_time(i, (*given)?, time))))
        })
    }

    /// The same with the first derivatives alone.
    pub fn all(&self, intervals: usize, time: f64) -> impl Iterator<Item = (usize, usize, f64)> {
        self.with_curvatures(intervals, time).map(|(k, i, [tangent, _])| (k, i, tangent))
    }

    /// Puts the given accelerations into the unknowns after T has changed: they are not linear in it.
    pub fn put_accelerations(&self, spline: &mut Spline) {
        let (n, time) = (self.dof, spline.time);
        for (end, given) in self.given.iter().enumerate() {
            let first = spline.end_unknowns(end).start;
            for (i, a) in given.iter().enumerate().skip(2 * n) {
                if let Some(a) = a {
                    spline.unknowns[first + i] = time * time * a;
                }
            }
        }
    }
}
