//! The motion integrated again with its torques.

use super::closed_verify::{self, ClosedTree};
use super::integrate::{Driven, OpenTree, integrate};
use crate::bvp::collocation::error::defined;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::refine::resolution::Resolution;
use crate::numerics::dormand_prince::Stopped;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::problem::loop_rows::Loops;
use crate::result::verify::verification_bound;
use crate::verify::splits::Splits;
use std::sync::Arc;

/// A motion integrated again.
pub(crate) struct Again {
    /// (q, v) at the end, integrated from the start without a correction.
    pub state: Option<Vec<f64>>,
    /// Largest miss of a given position, rate or pose of a tool there.
    pub defect: f64,
    /// Sum of the distances from the motion at the ends of its parts, each integrated from its own start, in
    /// parts of the largest values along it; infinite if that was not needed.
    pub parts: f64,
    /// The smaller one of the distances that decide whether the torques lead along the motion, relative to
    /// the largest values along it: at its end, and the sum over its parts.
    pub miss: f64,
    /// Whether the torques lead along the motion: to its end, or at least to the end of each part.
    pub leads: bool,
    /// Whether the integration was done, or not needed: not so where the search was stopped.
    pub is_complete: bool,
}

impl Again {
    /// Without an integration.
    pub fn unknown(leads: bool) -> Self {
        Self {
            state: None,
            defect: f64::INFINITY,
            parts: f64::INFINITY,
            miss: f64::INFINITY,
            leads,
            is_complete: true,
        }
    }
}

/// The motion integrated again with its torques, cut to their limits.
///
/// Errors of an unstable motion grow like exp(t / tau): a wrist without a rotor forgets its torques in a
/// hundredth of a second, and no torques, however exact, lead it through seconds. So where the motion
/// integrated once through misses its end, [`PARTS`](constants::PARTS) of it are looked at one by one, as in
/// multiple shooting. Their misses are added: what limits cut off torques moves a motion that forgets nothing
/// by that much.
///
/// It ends early where the search is to stop, which `stops` tells: nothing is known then.
pub(crate) fn integrate_again<D>(
    problem: &Problem,
    options: &SolverOptions,
    interior: &mut Interior<D>,
    resolution: &Resolution,
    stops: &mut dyn FnMut() -> bool,
) -> Again {
    let spline = &interior.spline;
    let bound = constants::VERIFIED * options.tolerance.sqrt();
    let drifts = |loops: &Arc<Loops>| {
        closed_verify::drift(loops, spline).is_ok_and(|drift| drift <= verification_bound(options.tolerance))
    };
    if options.verify != Verify::None && !problem.loops.as_ref().is_none_or(drifts) {
        return Again::unknown(false);
    }
    match options.verify {
        Verify::Full => {}
        // What is cut off torques moves the end by about as much, in parts of what moves the robot.
        Verify::Factors => {
            let cut: f64 = resolution.cut.iter().sum();
            return Again::unknown(cut / spline.duration() <= bound);
        }
        Verify::None => return Again::unknown(false),
    }
    let n = problem.robot.dof();
    let size = sizes(interior, n);
    // Multipliers count for nothing.
    let is_joint = |at: usize| at % spline.dof < n;
    let distance = |x: &[f64], z: &[f64]| {
        let joints = (0..x.len()).filter(|&at| is_joint(at));
        let parts = joints.map(|at| defined((x[at] - z[at]).abs() / size[at]));
        parts.fold(0.0, f64::max)
    };
    let mut last = vec![0.0; 3 * spline.dof];
    spline.in_interval(spline.mesh.intervals() - 1, 1.0, &mut last);
    let stopped = || Again { is_complete: false, ..Again::unknown(false) };
    let limits = problem.joint_limits();
    let mut driven: Box<dyn Driven> = match &problem.loops {
        Some(loops) => Box::new(ClosedTree::new(loops)),
        None => Box::new(OpenTree::new(&problem.robots())),
    };
    let places = Splits::new(problem, &spline.path());
    let motion = (spline, &places);
    let state = match integrate(&mut *driven, &limits, motion, f64::INFINITY, stops, &mut |_, _| ()) {
        Err(Stopped::Interrupted) => return stopped(),
        state => state.ok(),
    };
    let miss = state.as_ref().map_or(f64::INFINITY, |state| distance(state, &last));
    let mut again = Again { miss, ..Again::unknown(miss <= bound) };
    if !again.leads {
        let mut parts = 0.0_f64;
        let each = spline.duration() / constants::PARTS;
        let mut add = |x: &[f64], z: &[f64]| parts += distance(x, z);
        let ended = integrate(&mut *driven, &limits, motion, each, stops, &mut add);
        if ended == Err(Stopped::Interrupted) {
            return stopped();
        }
        again.parts = ended.map_or(f64::INFINITY, |state| parts + distance(&state, &last));
        again.miss = again.miss.min(again.parts);
        again.leads = again.parts <= bound;
    }
    if let Some(state) = &state {
        let end = spline.mesh.phases();
        let follows = |i: usize| interior.ends.tied.iter().any(|tie| tie.end == Some(i));
        let is_given = |&i: &usize| interior.ends.given[end][i] || follows(i);
        let misses = (0..state.len()).filter(is_given).map(|i| defined((state[i] - last[i]).abs()));
        again.defect = misses.fold(interior.model.tasks.miss(end, state), f64::max);
    }
    again.state = state;
    again
}

/// The largest value of each component of (q, v); a joint that hardly moves is measured by the others, of
/// which there are so many.
fn sizes<D>(interior: &Interior<D>, joints: usize) -> Vec<f64> {
    let n = interior.spline.dof;
    let largest = |i: usize| {
        let values = (0..interior.points.count()).map(|p| interior.points.z(p)[i].abs());
        values.fold(f64::MIN_POSITIVE, f64::max)
    };
    let of_all = |group: usize| (group * n..group * n + joints).map(largest).fold(0.0, f64::max);
    let least = [0, 1].map(|group| (constants::LEAST_SCALE * of_all(group)).max(constants::REST));
    (0..2 * n).map(|i| largest(i).max(least[i / n])).collect()
}
