//! Motions of robots with constraints: those of the same robots with multipliers as coordinates
//! ([`crate::problem::loops`]), by the direct method.

use crate::direct::{Direct, Looseness, WEIGHTS};
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::problem::check::CheckedProblem;
use crate::problem::loop_rows::{Loops, Walk};
use crate::result::constraint_forces::ConstraintForces;
use crate::result::gait::{GaitReport, Landing};
use crate::result::motion::Motion;
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::result::verify::verification_bound;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;

/// Solves a problem that was checked, from a saved motion if there is one.
pub(crate) fn solve(
    problem: &Problem,
    options: &SolverOptions,
    saved: Option<&Trajectory>,
    recorder: &mut Recorder<'_>,
) -> Solution {
    let missing = |status| Solution::without_motion(problem, status);
    // What was checked has neither fault.
    let Ok(with_multipliers) = problem.with_multipliers() else { return missing(Status::NewtonFailed) };
    let Ok(rows) = TaskRows::new(&with_multipliers) else { return missing(Status::NewtonFailed) };
    let saved = saved.map(|saved| saved.of_joints(with_multipliers.coordinates()));
    let direct = Direct {
        problem: CheckedProblem::made(&with_multipliers),
        rows: &rows,
        options,
        looseness: Looseness::of(options.tolerance),
        saved: saved.as_ref(),
    };
    let found = direct.solve(recorder);
    let found = Solution { options: options.clone(), ..found };
    match &with_multipliers.loops {
        Some(loops) => of_joints(problem, loops, found),
        None => found,
    }
}

/// The motion of the joints, with the forces of the constraints and what is missed at the end where loops
/// close in another way than the given position says.
fn of_joints(problem: &Problem, loops: &Loops, found: Solution) -> Solution {
    let n = problem.robot.dof();
    let lambda = |accelerations: &Vec<f64>| match &loops.walk {
        // In the axes of the world; rows of feet in the plane are edges of their friction cones.
        Some(walk) => {
            let mut lambda = vec![0.0; walk.feet.last().map_or(0, |foot| foot.told.end)];
            for ((column, row), a) in walk.columns.iter().zip(&loops.rows).zip(&accelerations[n..]) {
                let Some(foot) = walk.foot_of(row.row) else { continue };
                let foot = &mut lambda[foot.told.clone()];
                foot.iter_mut().zip(column).for_each(|(to, part)| *to += part * row.mass * a);
            }
            lambda
        }
        None => {
            let all = problem.robot.constraints().iter().map(|one| one.kind.rows()).sum();
            let mut lambda = vec![0.0; all];
            for (row, a) in loops.rows.iter().zip(&accelerations[n..]) {
                lambda[row.row] = row.mass * a;
            }
            lambda
        }
    };
    let rows = found.trajectory.accelerations().unwrap_or_default();
    let lambda: Vec<Vec<f64>> = rows.iter().map(lambda).collect();
    let trajectory = found.trajectory.of_joints(n);
    let robot = loops.walk.as_ref().map_or(&loops.robot, |walk| &walk.foot);
    let holds = |constraint: usize, phase: usize| match &loops.walk {
        Some(walk) => walk.feet[constraint].rows.end <= loops.phases[phase].rows,
        None => true,
    };
    // Feet are held by rows that are independent.
    let counts = |row: usize| loops.walk.is_some() || loops.rows.iter().any(|kept| kept.row == row);
    let mut constraints =
        ConstraintForces::along(robot, &trajectory, &lambda, holds, counts).unwrap_or_default();
    if let Some(walk) = &loops.walk {
        for (foot, told) in walk.feet.iter().zip(&mut constraints) {
            if !walk.gait.is_on_edge(foot.contact) {
                continue;
            }
            // Corners of the edge have rows of their own.
            for (moment, a) in told.moment.iter_mut().zip(rows) {
                let own = loops.rows[foot.rows.clone()].iter().zip(&a[n + foot.rows.start..]);
                let forces: Vec<f64> = own.map(|(row, a)| row.mass * a).collect();
                *moment = walk.gait.moment_of_edge(&forces);
            }
        }
    }
    let end_state = found.motion.end_state.as_ref().map(|state| {
        let all = state.len() / 2;
        [&state[..n], &state[all..all + n]].concat()
    });
    let misses = |state: &Vec<f64>| {
        let of = |given: &[f64], free: &[usize], state: &[f64]| {
            let given = (0..n).filter(|i| !free.contains(i)).map(|i| (state[i] - given[i]).abs());
            given.fold(0.0, f64::max)
        };
        let end = &problem.end;
        of(&end.q, &end.q_free, &state[..n]).max(of(&end.v, &end.v_free, &state[n..]))
    };
    let walk = loops.walk.as_ref();
    let gait = walk.and_then(|walk| GaitReport::of(walk, &trajectory, &problem.gain, &WEIGHTS).ok()?);
    let after = |walk: &Walk, state: &Vec<f64>| {
        let (q, v) = state.split_at(n);
        Landing::of(walk, q, v)
            .map_or(f64::INFINITY, |landing| landing.miss(&trajectory.q[0], &trajectory.v[0]))
    };
    let end_defect = end_state.as_ref().map_or(f64::INFINITY, |state| match &loops.walk {
        Some(walk) => after(walk, state),
        None => misses(state),
    });
    // Where loops can close in two ways, what is given may be the other one.
    let last = trajectory.q.last().zip(trajectory.v.last()).map(|(q, v)| misses(&[&q[..], v].concat()));
    // A step has other ends than those of its guess; the gait has to close.
    let last = if loops.walk.is_some() { gait.as_ref().map(|gait| gait.miss) } else { last };
    let bound = verification_bound(found.options.tolerance).sqrt();
    let closes_otherwise = found.motion.status.is_converged() && last.is_some_and(|miss| miss > bound);
    let status = if closes_otherwise { Status::NotVerified } else { found.motion.status.clone() };
    let motion = Motion { status, end_state, ..found.motion };
    Solution { motion, trajectory, constraints, gait, end_defect, ..found }
}
