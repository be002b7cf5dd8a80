//! What the direct method found: the motion with its costates at all nodes and points.

use super::basis::POINTS;
use super::costates::{Costates, costates};
use super::interior::Interior;
use super::points::PointDynamics;
use crate::problem::Problem;
use crate::problem::limits::JointLimits;
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::lagrangian::{Lagrangian, LegendreTransform};

/// The trajectory at the nodes and at the points between them, with H*.
///
/// Torques may jump at a node: there the mean of both sides is given.
pub(super) fn trajectory<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
) -> Result<Trajectory, EvalError> {
    interior.refresh()?;
    let costates = costates(interior);
    let mut rows = Rows::new(problem, costates);
    let mesh = &interior.spline.mesh;
    let n = interior.spline.dof;
    let (mut z, mut left) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
    for k in 0..=mesh.intervals() {
        if k < mesh.intervals() {
            interior.spline.in_interval(k, 0.0, &mut z);
        }
        if k > 0 {
            interior.spline.in_interval(k - 1, 1.0, &mut left);
            match k < mesh.intervals() {
                true => z.iter_mut().zip(&left).for_each(|(z, left)| *z = 0.5 * (*z + left)),
                false => z.copy_from_slice(&left),
            }
        }
        let tau = rows.inverse.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?.to_vec();
        let costate = rows.costates.at_nodes[k].clone();
        let value = rows.costates.hamiltonian_at_node(k);
        rows.add(mesh.nodes[k] * interior.spline.time, &z, &tau, costate, value)?;
        for p in (POINTS * k..POINTS * (k + 1)).take_while(|_| k < mesh.intervals()) {
            let costate = rows.costates.at_points[p].clone();
            let value = rows.costates.hamiltonian[p];
            let time = mesh.point(p).0 * interior.spline.time;
            rows.add(time, interior.points.z(p), interior.points.tau(p), costate, value)?;
        }
    }
    Ok(Trajectory::from_rows(rows.times, rows.columns).with_hamiltonian(rows.hamiltonian))
}

/// The rows of a trajectory, one time after the other.
struct Rows<'a> {
    problem: &'a Problem,
    limits: Vec<JointLimits>,
    costates: Costates,
    inverse: Lagrangian<f64>,
    transform: LegendreTransform<f64>,
    times: Vec<f64>,
    /// q, v, p, u, y_q, y_p.
    columns: [Vec<Vec<f64>>; 6],
    hamiltonian: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(problem: &'a Problem, costates: Costates) -> Self {
        Self {
            problem,
            limits: problem.joint_limits(),
            costates,
            inverse: Lagrangian::new(&problem.robot),
            transform: LegendreTransform::new(&problem.robot),
            times: Vec::new(),
            columns: Default::default(),
            hamiltonian: Vec::new(),
        }
    }

    /// Adds a time: torques cut to their limits, costates of (q, v) as those of (q, p).
    fn add(
        &mut self,
        time: f64,
        z: &[f64],
        tau: &[f64],
        mut costate: Vec<f64>,
        hamiltonian: f64,
    ) -> Result<(), EvalError> {
        let n = tau.len();
        let (q, v) = (&z[..n], &z[n..2 * n]);
        let cut =
            tau.iter().zip(&self.limits).map(|(tau, limit)| tau.clamp(limit.torque[0], limit.torque[1]));
        let u: Vec<f64> = cut.zip(&self.problem.gain).map(|(tau, gain)| tau / gain).collect();
        let mut map = self.transform.at(q, v, &u)?;
        map.costate_to_hamiltonian(&mut costate)?;
        let momentum = map.momentum().to_vec();
        let (y_q, y_p) = costate.split_at(n);
        for (column, row) in self.columns.iter_mut().zip([q, v, &momentum, &u, y_q, y_p]) {
            column.push(row.to_vec());
        }
        self.times.push(time);
        self.hamiltonian.push(hamiltonian);
        Ok(())
    }
}
