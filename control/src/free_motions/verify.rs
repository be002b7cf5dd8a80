//! A motion integrated again by the state equation of the tangent space.

use super::task::FreeTask;
use crate::constants::direct::INTEGRATION;
use crate::constants::free_motions::INSIDE;
use crate::direct_states::points::POINTS;
use crate::direct_states::solution::StateMotion;
use crate::numerics::dormand_prince::DormandPrince;
use crate::problem::Problem;
use crate::problem::free_end::orientation_rows;
use crate::problem::free_joints::normalised;
use crate::result::free_entries::FreeEntries;
use costate::hamiltonian::Hamiltonian;

/// (q, v) at the end when the controls are integrated from the start; `None` where that stops.
pub(super) fn integrated_again(task: &FreeTask<'_>, found: &StateMotion) -> Option<Vec<f64>> {
    let (n, nq, robot) = (task.dof(), task.nq(), &task.problem.robot);
    let mut model = Hamiltonian::<f64>::new(robot);
    let free = FreeEntries::of(robot);
    let mut integrator = DormandPrince::new(nq + n, INTEGRATION);
    let mut x = task.start.clone();
    let mut tau = vec![0.0; n];
    let gain = &task.problem.gain;
    let nodes: Vec<f64> = found.t.iter().step_by(POINTS).copied().collect();
    for pair in nodes.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let inside = from + INSIDE * (to - from);
        let reached = integrator.integrate(&mut x, from..to, |t, x, rate| {
            let (_, u) = found.sample_at(t.max(inside));
            task.driven.iter().zip(u).for_each(|(&i, u)| tau[i] = gain[i] * u);
            let q = normalised(robot, &x[..nq]);
            let f = model.evaluate(&q, &x[nq..], &tau)?;
            // Quaternions grow and turn as those of length 1.
            rate[..nq].copy_from_slice(&FreeEntries::rates(&free, &q, &f[..n]));
            rate[nq..].copy_from_slice(&f[n..]);
            Ok(())
        });
        reached.ok()?;
    }
    let q = normalised(robot, &x[..nq]);
    let v = model.velocity(&q, &x[nq..]).ok()?.to_vec();
    Some([q, v].concat())
}

/// Largest miss of a position, an angle or a rate that is given at the end (m, rad, m/s, rad/s).
pub(super) fn missed(problem: &Problem, state: &[f64]) -> f64 {
    let (end, robot) = (&problem.end, &problem.robot);
    let (q, v) = state.split_at(robot.nq());
    let target = normalised(robot, &end.q);
    let mut most = 0.0_f64;
    let mut count = |i: usize, miss: f64| {
        if !end.q_free.contains(&i) {
            // Not a number is a miss too.
            most = if miss.is_nan() { f64::INFINITY } else { most.max(miss.abs()) };
        }
    };
    robot.plain_entries().for_each(|(entry, i)| count(i, q[entry] - target[entry]));
    for free in robot.free_joints() {
        (0..free.kind.slides()).for_each(|k| {
            count(free.coordinate + k, q[free.position + k] - target[free.position + k]);
        });
        let at = free.quaternion();
        let rows = orientation_rows([0, 1, 2, 3].map(|k| target[at + k]));
        for (k, row) in rows.iter().enumerate() {
            let turn: f64 = row.iter().zip(&q[at..]).map(|(c, a)| c * a).sum();
            count(free.coordinate + free.kind.slides() + k, 2.0 * turn);
        }
    }
    for (i, (v, given)) in v.iter().zip(&end.v).enumerate().filter(|(i, _)| !end.v_free.contains(i)) {
        let miss = (v - given).abs();
        most = if miss.is_nan() || i >= robot.dof() { f64::INFINITY } else { most.max(miss) };
    }
    most
}
