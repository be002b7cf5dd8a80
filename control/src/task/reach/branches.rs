//! Positions of the joints for the poses of tools, sorted by how soon or how cheaply they are reached.
//!
//! An arm reaches a pose in several ways: other signs of its elbow and wrist, whole turns, and where the pose
//! leaves joints free all along curves. Descents from many seeded positions find them, each is turned back by
//! whole turns and moved along what the pose leaves free to where it is reached sooner or more cheaply, and
//! of those that lie near each other the best one stays.

use super::slide::cheaper;
use super::{Search, seeded, seeded_position};
use crate::constants::task::reach::{
    APART, APART_ALONG, BRANCH_STEPS, DESCENTS, FAR, MOST_BRANCHES, NEARBY, REACHED, SAME_POSITION,
};
use crate::task::functions::TaskFunctions;
use std::f64::consts::TAU;

/// A position with its price: the time after which it is reached at the earliest (s), or what a simple motion
/// to it costs.
#[derive(Clone, Debug)]
pub(crate) struct Branch {
    pub q: Vec<f64>,
    pub price: f64,
    /// How much more it counts since limits, or what is kept along the motion, are exceeded.
    pub penalty: f64,
}

impl Branch {
    /// What positions are sorted by: no bound of what a motion takes or costs.
    fn rank(&self) -> f64 {
        self.price + self.penalty
    }
}

/// Positions at which all rows have their values, the one with the least price and penalty, which `branch`
/// finds, first; `near` is the place before. At most [`MOST_BRANCHES`], of which so many are moved along what
/// places leave free: a move has the price of up to [`MOST_SLIDES`] positions.
pub(crate) fn ranked(
    functions: &mut TaskFunctions,
    (near, known): (&[f64], &[f64]),
    free: &[usize],
    limits: &[[f64; 2]],
    moved: usize,
    mut branch: impl FnMut(Vec<f64>) -> Branch,
) -> Vec<Branch> {
    let mut search = Search { steps: BRANCH_STEPS, ..Search::new(functions, free, limits) };
    let mut all = vec![known.to_vec()];
    for start in 1..=DESCENTS {
        let mut from = seeded_position(start, near, free, limits);
        // Every other descent begins around the place before, farther and farther away.
        if start % 2 == 0 {
            let aside = NEARBY * (start as f64 / DESCENTS as f64);
            for &i in free {
                let around = [near[i] - aside, near[i] + aside];
                from[i] = seeded(start, i, around, near[i]).max(limits[i][0]).min(limits[i][1]);
            }
        }
        let reached = search.descend(from);
        let reached = search.turned_back(reached, near);
        let is_same =
            |other: &Vec<f64>| free.iter().all(|&i| (reached.q[i] - other[i]).abs() < SAME_POSITION);
        if reached.is_there() && !all.iter().any(is_same) {
            all.push(reached.q);
        }
    }
    let found = all.into_iter().map(&mut branch).collect();
    let apart = if search.g.len() < free.len() { APART_ALONG } else { APART };
    let mut found = apart_from_each_other(found, free, apart);
    // Whole turns the other way round pass obstacles elsewhere.
    for k in 0..found.len() {
        for &i in free {
            let way = found[k].q[i] - near[i];
            let mut other = found[k].q.clone();
            other[i] -= TAU.copysign(way);
            let is_inside = (limits[i][0]..=limits[i][1]).contains(&other[i]);
            if way.abs() > FAR && is_inside && search.values(&other).amax() <= REACHED {
                found.push(branch(other));
            }
        }
    }
    let mut found = apart_from_each_other(found, free, apart);
    if search.g.len() < free.len() {
        for one in found.iter_mut().take(moved) {
            if let Some(q) = cheaper(search.functions, &one.q, free, limits, one.rank(), |q| {
                Some(branch(q.to_vec()).rank())
            }) {
                *one = branch(q);
            }
        }
        found = apart_from_each_other(found, free, apart);
    }
    found
}

/// The best ones of those that differ by less than `apart` in all joints (rad, m); at most
/// [`MOST_BRANCHES`].
fn apart_from_each_other(mut all: Vec<Branch>, free: &[usize], apart: f64) -> Vec<Branch> {
    all.sort_by(|a, b| a.rank().total_cmp(&b.rank()));
    let mut found: Vec<Branch> = Vec::new();
    for one in all {
        let is_new = found.iter().all(|other| free.iter().any(|&i| (one.q[i] - other.q[i]).abs() > apart));
        if is_new && found.len() < MOST_BRANCHES {
            found.push(one);
        }
    }
    found
}
