//! A motion in states as a trajectory of the robot.

use super::task::FreeTask;
use crate::direct_states::solution::StateMotion;
use crate::problem::free_end::orientation_rows;
use crate::problem::free_joints::{length, normalised, orientation};
use crate::result::free_entries::FreeEntries;
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use nalgebra::Vector3;

/// H* and its drift.
pub(super) struct Figures {
    pub hamiltonian: f64,
    pub drift: f64,
}

/// Rows at the nodes and points, quaternions of length 1, costates in the tangent space.
pub(super) fn trajectory(task: &FreeTask<'_>, found: &StateMotion) -> Result<Trajectory, EvalError> {
    let (n, nq, robot) = (task.dof(), task.nq(), &task.problem.robot);
    let mut model = Hamiltonian::<f64>::new(robot);
    let mut columns: [Vec<Vec<f64>>; 6] = Default::default();
    for ((x, u), y) in found.x.iter().zip(&found.u).zip(&found.y) {
        let q = normalised(robot, &x[..nq]);
        let p = x[nq..].to_vec();
        let v = model.velocity(&q, &p)?.to_vec();
        let mut all = vec![0.0; n];
        task.driven.iter().zip(u).for_each(|(&i, u)| all[i] = *u);
        let rows = [q, v, p, all, in_tangent_space(task, x, y), y[nq..].to_vec()];
        columns.iter_mut().zip(rows).for_each(|(column, row)| column.push(row));
    }
    let weight = task.problem.cost.time;
    let hamiltonian = found.hamiltonian.iter().map(|h| h - weight).collect();
    let trajectory = Trajectory::from_rows(found.t.clone(), columns).with_hamiltonian(hamiltonian);
    Ok(trajectory.with_free_joints(FreeEntries::of(robot)))
}

/// The costate of q as that of the tangent space.
fn in_tangent_space(task: &FreeTask<'_>, x: &[f64], y: &[f64]) -> Vec<f64> {
    let robot = &task.problem.robot;
    let mut l = vec![0.0; task.dof()];
    robot.plain_entries().for_each(|(entry, i)| l[i] = y[entry]);
    for free in robot.free_joints() {
        let at = free.quaternion();
        let a = [0, 1, 2, 3].map(|k| x[at + k]);
        let length = length(&a);
        for (k, row) in orientation_rows(a).iter().enumerate() {
            let sum: f64 = row.iter().zip(&y[at..]).map(|(c, y)| c * y).sum();
            l[free.coordinate + free.kind.slides() + k] = 0.5 * length * sum;
        }
        if free.kind.slides() > 0 {
            let linear = orientation(free, x).inverse()
                * Vector3::from_column_slice(&y[free.position..free.position + 3]);
            l[free.coordinate..free.coordinate + 3].copy_from_slice(linear.as_slice());
        }
    }
    l
}

/// H* over the motion, which is constant along an extremal.
pub(super) fn figures(task: &FreeTask<'_>, found: &StateMotion) -> Figures {
    let (cost, count) = (&task.problem.cost, found.hamiltonian.len().max(1) as f64);
    let mean = found.hamiltonian.iter().sum::<f64>() / count;
    let (mut off, mut size) = (0.0_f64, f64::MIN_POSITIVE);
    for (h, u) in found.hamiltonian.iter().zip(&found.u) {
        let l: f64 = task.driven.iter().zip(u).map(|(&i, u)| 0.5 * cost.effort[i] * u * u).sum();
        off = off.max((h - mean).abs());
        size = size.max((h + l).abs() + l + cost.time);
    }
    Figures { hamiltonian: mean - cost.time, drift: off / size }
}
