//! Guesses beside that of a start, and which of them are worth a look.
//!
//! A guess costs nothing but an evaluation at the points of a coarse mesh. Its cost, and by how much it
//! exceeds limits, say enough to leave most of them out.

use super::first::First;
use super::prepare::Dynamics;
use crate::constants::guesses as constants;
use crate::cubics::Disturbance;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::reached::{other_positions, with_tools_reached};
use crate::problem::{FinalTime, Problem};
use crate::result::start::GuessKind;
use crate::task::build::TaskRows;

/// A guess with its figures.
pub(super) struct Candidate<'a> {
    pub first: First<'a>,
    /// By how much limits are exceeded, and the cost.
    pub figures: [f64; 2],
}

/// The guesses beside `own` that are worth a look, the most promising one first. `interior` begins at `own`
/// on its first mesh, as it does afterwards.
pub(super) fn candidates<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    own: &First<'a>,
    interior: &mut Interior<Dynamics>,
) -> Vec<Candidate<'a>> {
    let has_tools = rows.at_ends().any(|rows| !rows.is_empty());
    if !has_tools && problem.task.collision.is_none() {
        return Vec::new();
    }
    let begun = interior.spline.clone();
    let nodes = &begun.mesh.nodes;
    let time = matches!(problem.time, FinalTime::Free { .. }).then(|| begun.duration());
    let mut judge = |first: First<'a>| {
        let spline = first.spline(nodes.clone(), time);
        let figures = interior.figures_of(&spline)?;
        Some(Candidate { first, figures })
    };
    let all: Vec<Candidate<'a>> = match judge(own.clone()) {
        None => Vec::new(),
        Some(Candidate { figures: [exceeded, cost], .. }) => {
            let promises = |candidate: &Candidate<'_>| {
                let [others_exceed, other_cost] = candidate.figures;
                match candidate.first.kind {
                    GuessKind::OtherPosition => {
                        others_exceed <= exceeded.max(constants::EXCEEDED)
                            && other_cost < constants::PROMISING * cost
                    }
                    _ => others_exceed < exceeded && other_cost < constants::DETOUR * cost,
                }
            };
            let mut found: Vec<_> = proposals(problem, rows, own, exceeded > constants::EXCEEDED)
                .into_iter()
                .filter_map(&mut judge)
                .filter(promises)
                .collect();
            found.sort_by(|a, b| a.figures[1].total_cmp(&b.figures[1]));
            found.truncate(constants::LOOKS);
            found
        }
    };
    interior.spline = begun;
    all
}

/// Guesses that differ from `own`: other positions of the joints for tools and, where it `is_blocked`, waves
/// in the joints.
fn proposals<'a>(problem: &'a Problem, rows: &TaskRows, own: &First<'a>, is_blocked: bool) -> Vec<First<'a>> {
    let mut all = Vec::new();
    if problem.loops.is_none() && problem.periodic.is_none() {
        for (end, q) in other_positions(&own.reached, rows) {
            let reached = with_tools_reached(problem, rows, 0, Some((end, &q)));
            all.push(First { kind: GuessKind::OtherPosition, reached, ..own.clone() });
        }
    }
    if is_blocked && problem.task.collision.is_some() {
        let n = problem.coordinates();
        for joint in 0..n {
            for amplitude in constants::BENDS.into_iter().flat_map(|size| [size, -size]) {
                let disturbance = Disturbance::bend(n, joint, amplitude);
                all.push(First { kind: GuessKind::Bent, disturbance, ..own.clone() });
            }
        }
    }
    all
}
