//! Guesses beside that of a start, and which of them are worth a look.
//!
//! A guess costs nothing but an evaluation at the points of a coarse mesh. Its cost, and by how much it
//! exceeds limits, say enough to leave most of them out.

use super::first::First;
use super::prepare::Dynamics;
use crate::constants::direct::FIRST_SLACK;
use crate::constants::guesses as constants;
use crate::constants::task::reach::{MOST_BRANCHES, OUTSIDE, SAME_POSITION};
use crate::cubics::Disturbance;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::Limited;
use crate::direct::motion::reached::{by_time, leaves_joints_free, ranked_positions, with_position_reached};
use crate::options::SolverOptions;
use crate::problem::{FinalTime, Problem};
use crate::result::start::GuessKind;
use crate::task::build::TaskRows;
use crate::task::reach::branches::Branch;

/// A guess with its figures.
pub(super) struct Candidate<'a> {
    pub first: First<'a>,
    /// By how much limits are exceeded, and the cost.
    pub figures: [f64; 2],
    /// What its motion costs at least, where that is known.
    pub least: f64,
}

/// The guesses beside `own` that are worth a look, the most promising one first. `interior` begins at `own`
/// on its first mesh, as it does afterwards. Nothing is evaluated any more once the search is stopped.
pub(super) fn candidates<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    own: &First<'a>,
    interior: &mut Interior<Dynamics>,
    mut is_stopped: impl FnMut() -> bool,
) -> Vec<Candidate<'a>> {
    let has_tools = rows.at_ends().any(|rows| !rows.is_empty());
    if !has_tools && problem.task.collision.is_none() {
        return Vec::new();
    }
    let begun = interior.spline.clone();
    let nodes = &begun.mesh.nodes;
    let time = matches!(problem.time, FinalTime::Free { .. }).then(|| begun.duration());
    let (time_price, torques_cost) = (interior.running.time, interior.running.costs_torques());
    let mut candidate = |first: First<'a>, least: f64| {
        if is_stopped() {
            return None;
        }
        let mut figures = interior.figures_of(&first.spline(nodes.clone(), time))?;
        if time.is_none() {
            // Cubics begin and end with jumps of the acceleration.
            figures[0] = interior.exceeded(|barrier, at| barrier.side(at).limited != Limited::Jerk);
        }
        Some(Candidate { first, figures, least })
    };
    let mut all = Vec::new();
    if let Some([exceeded, cost]) = candidate(own.clone(), 0.0).map(|own| own.figures) {
        let ends_are_free = problem.loops.is_none() && problem.periodic.is_none();
        // Costs of straight motions within a given time say little about least times.
        let is_mostly = |time: f64| !torques_cost || time_price * time > constants::MOSTLY_TIME * cost;
        let by_least_time = ends_are_free && time_price > 0.0 && time.is_some_and(is_mostly);
        let slides = leaves_joints_free(&own.reached, rows);
        let ends = own.reached.ends();
        let is_other = |(end, branch): &(usize, Branch)| {
            let mut both = ends[*end].q.iter().zip(&branch.q);
            both.any(|(own, q)| (own - q).abs() >= SAME_POSITION)
        };
        let at = |end: usize, q: &[f64]| {
            let reached = with_position_reached(problem, rows, &own.reached, (end, q));
            First { kind: GuessKind::OtherPosition, reached, ..own.clone() }
        };
        if by_least_time {
            let branches =
                ranked_positions(&own.reached, rows, MOST_BRANCHES, by_time(&own.reached, rows)).into_iter();
            let others = branches.filter(is_other).take(constants::BRANCHES);
            // Positions that slide may be reached sooner.
            let least = |branch: &Branch| if slides { 0.0 } else { time_price * branch.price };
            all.extend(others.filter_map(|(end, branch)| candidate(at(end, &branch.q), least(&branch))));
        } else if ends_are_free {
            let allowed = exceeded.max(FIRST_SLACK + constants::EXCEEDED_BY_CUBICS);
            let mut by_cost = |end: usize, q: Vec<f64>| {
                let figures = candidate(at(end, &q), 0.0).map(|other| other.figures);
                let [excess, price] = figures.unwrap_or([0.0, f64::INFINITY]);
                Branch { q, price, penalty: OUTSIDE * cost.abs() * (excess - allowed).max(0.0) }
            };
            let mut branches = ranked_positions(&own.reached, rows, constants::POSITIONS, &mut by_cost);
            branches.retain(|branch| is_other(branch) && branch.1.penalty == 0.0);
            branches.sort_by(|(_, a), (_, b)| a.price.total_cmp(&b.price));
            let most = cost + (constants::PROMISING - 1.0) * cost.abs();
            let promising = branches.iter().take_while(|(_, branch)| branch.price < most);
            let others = promising.take(constants::POSITIONS);
            all.extend(others.filter_map(|(end, branch)| candidate(at(*end, &branch.q), 0.0)));
        }
        if exceeded > constants::EXCEEDED && problem.task.collision.is_some() {
            let by = usize::from(!by_least_time);
            let promises = |bent: &Candidate<'_>| {
                bent.figures[0] < exceeded && bent.figures[1] < constants::DETOUR * cost
            };
            let bent = bends(own, problem.coordinates()).filter_map(|first| candidate(first, 0.0));
            let mut bent: Vec<_> = bent.filter(promises).collect();
            bent.sort_by(|a, b| a.figures[by].total_cmp(&b.figures[by]));
            bent.truncate(constants::LOOKS);
            all.extend(bent);
        }
        if ends_are_free && !by_least_time && slides {
            // Ends slide along their places: the cost of a guess says little about that of its motion.
            let drawn = (1..=constants::DRAWN).map(|k| First::new(problem, rows, options, k, None));
            all.extend(drawn.filter_map(|first| candidate(first, 0.0)));
        }
    }
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
