//! Guesses beside that of a start, and which of them are worth a look.
//!
//! A guess costs nothing but an evaluation at the points of a coarse mesh. Its cost, and by how much it
//! exceeds limits, say enough to leave most of them out.

use super::first::First;
use super::prepare::Dynamics;
use crate::constants::guesses as constants;
use crate::cubics::Disturbance;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::reached::{
    leaves_joints_free, other_positions, soonest_positions, with_tools_reached,
};
use crate::options::SolverOptions;
use crate::problem::{FinalTime, Problem};
use crate::result::start::GuessKind;
use crate::task::build::TaskRows;

/// A guess with its figures.
pub(super) struct Candidate<'a> {
    pub first: First<'a>,
    /// By how much limits are exceeded, and the cost.
    pub figures: [f64; 2],
    /// What its motion costs at least, where that is known.
    pub least: f64,
}

/// The guesses beside `own` that are worth a look, the most promising one first. `interior` begins at `own`
/// on its first mesh, as it does afterwards.
pub(super) fn candidates<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    options: &SolverOptions,
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
    let (price, torques_cost) = (interior.running.time, interior.running.costs_torques());
    let mut judge = |first: &First<'a>| interior.figures_of(&first.spline(nodes.clone(), time));
    let all = judge(own).map_or_else(Vec::new, |[exceeded, cost]| {
        let allowed = exceeded.max(constants::EXCEEDED);
        let promises = |candidate: &Candidate<'_>| {
            let [own_excess, own_cost] = candidate.figures;
            match candidate.first.kind {
                GuessKind::OtherPosition => own_excess <= allowed && own_cost < constants::PROMISING * cost,
                _ => own_excess < exceeded && own_cost < constants::DETOUR * cost,
            }
        };
        let at = |end: usize, q: &[f64]| {
            let reached = with_tools_reached(problem, rows, 0, Some((end, q)));
            First { kind: GuessKind::OtherPosition, reached, ..own.clone() }
        };
        let mut proposed = Vec::new();
        let ends_are_free = problem.loops.is_none() && problem.periodic.is_none();
        // Costs of straight motions within a given time say little about least times.
        let is_mostly = |time: f64| !torques_cost || price * time > constants::MOSTLY_TIME * cost;
        let by_time = price > 0.0 && time.is_some_and(is_mostly);
        if ends_are_free && by_time {
            let is_fixed = !leaves_joints_free(&own.reached, rows);
            let is_own = |end: usize, q: &[f64]| {
                let own = own.reached.ends();
                own[end].q.iter().zip(q).all(|(own, q)| (own - q).abs() < constants::SAME_POSITION)
            };
            let branches = soonest_positions(&own.reached, rows).into_iter();
            let others = branches.filter(|(end, branch)| !is_own(*end, &branch.q)).take(constants::BRANCHES);
            let mut found: Vec<_> = others
                .filter_map(|(end, branch)| {
                    let first = at(end, &branch.q);
                    // Positions that slide may be reached sooner.
                    let least = if is_fixed { price * branch.time } else { 0.0 };
                    judge(&first).map(|figures| Candidate { first, figures, least })
                })
                .collect();
            if exceeded > constants::EXCEEDED && problem.task.collision.is_some() {
                let bent = bends(own, problem.coordinates());
                let mut bent: Vec<_> = bent
                    .filter_map(|first| judge(&first).map(|figures| Candidate { first, figures, least: 0.0 }))
                    .filter(promises)
                    .collect();
                bent.sort_by(|a, b| a.figures[0].total_cmp(&b.figures[0]));
                bent.truncate(constants::LOOKS);
                found.extend(bent);
            }
            return found;
        }
        if ends_are_free {
            let cheaper = |end: usize, q: &[f64]| {
                let [excess, cost] = judge(&at(end, q))?;
                (excess <= allowed).then_some(cost)
            };
            let others = other_positions(&own.reached, rows, cost, cheaper);
            proposed.extend(others.iter().map(|(end, q)| at(*end, q)));
        }
        if exceeded > constants::EXCEEDED && problem.task.collision.is_some() {
            proposed.extend(bends(own, problem.coordinates()));
        }
        let mut found: Vec<_> = proposed
            .into_iter()
            .filter_map(|first| judge(&first).map(|figures| Candidate { first, figures, least: 0.0 }))
            .filter(promises)
            .collect();
        found.sort_by(|a, b| a.figures[1].total_cmp(&b.figures[1]));
        found.truncate(constants::LOOKS);
        if ends_are_free && leaves_joints_free(&own.reached, rows) {
            // Ends slide along their places: the cost of a guess says little about that of its motion.
            let drawn = (1..=constants::DRAWN).map(|k| First::new(problem, rows, options, k, None));
            let drawn = drawn
                .filter_map(|first| judge(&first).map(|figures| Candidate { first, figures, least: 0.0 }));
            found.extend(drawn);
        }
        found
    });
    interior.spline = begun;
    all
}

/// Waves in the joints, one at a time.
fn bends<'a>(own: &First<'a>, n: usize) -> impl Iterator<Item = First<'a>> {
    let amplitudes = constants::BENDS.into_iter().flat_map(|size| [size, -size]);
    (0..n).flat_map(move |joint| {
        amplitudes.clone().map(move |amplitude| {
            let disturbance = Disturbance::bend(n, joint, amplitude);
            First { kind: GuessKind::Bent, disturbance, ..own.clone() }
        })
    })
}
