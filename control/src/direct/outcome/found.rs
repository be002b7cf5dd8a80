//! What the direct method found: the motion with its costates at all nodes and points.

use super::closed_map::ClosedMap;
use super::costates::{Costates, costates};
use super::hamiltonians::{Hamiltonians, hamiltonians};
use super::smooth_costates::smooth_costates;
use crate::constants::checks::found::LEAST_PIVOT;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use crate::direct::refine::at_ends::AtEnds;
use crate::numerics::cholesky;
use crate::problem::Problem;
use crate::problem::limits::JointLimits;
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::LegendreTransform;
use costate::robot::Robot;

/// A motion with its costates.
pub(crate) struct Found {
    pub trajectory: Trajectory,
    pub hamiltonians: Hamiltonians,
    /// What is left of the gradient of the Lagrange function, in parts of its terms.
    pub stationarity: f64,
}

/// The trajectory at the nodes and at the points between them, with H*.
///
/// Torques and accelerations may jump at a node. So it stands there twice, with those before it and
/// after it. Where M is singular, costates of (q, p) do not exist: they are NaN there.
pub(crate) fn found<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
    ends: &AtEnds,
) -> Result<Found, EvalError> {
    interior.refresh()?;
    let smooth = interior.spline.mesh.shape.is_smooth();
    let costates = if smooth { smooth_costates(interior) } else { costates(interior) };
    let hamiltonians = hamiltonians(interior, &costates);
    let stationarity = costates.stationarity;
    let trajectory = match smooth {
        true => smooth_trajectory(problem, interior, costates),
        false => trajectory(problem, interior, ends, &costates),
    };
    Ok(Found { trajectory: trajectory?, hamiltonians, stationarity })
}

/// Where accelerations jump.
fn trajectory<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
    ends: &AtEnds,
    costates: &Costates,
) -> Result<Trajectory, EvalError> {
    let mesh = interior.spline.mesh.clone();
    let times = |places: &mut dyn Iterator<Item = f64>| -> Vec<f64> {
        places.map(|s| interior.spline.time_at(s)).collect()
    };
    let (nodes, places) =
        (times(&mut mesh.nodes.iter().copied()), times(&mut (0..mesh.points()).map(|p| mesh.point(p).0)));
    let ahead = [interior.clock_ahead(&nodes), interior.clock_ahead(&places)];
    let (spline, points) = (&interior.spline, &interior.points);
    let mut rows = Rows::new(problem, spline);
    // These make the costate of the momenta another one.
    let has_accelerations = |side: &Side| side.limited == Limited::Acceleration;
    let has_accelerations = interior.barrier.sides().iter().any(has_accelerations);
    for k in 0..spline.mesh.intervals() {
        rows.enter(spline.mesh.phase(k));
        for (node, end) in [(k, 2 * k), (k + 1, 2 * k + 1)] {
            if node > k {
                for p in POINTS * k..POINTS * node {
                    let time = spline.time_at(spline.mesh.point(p).0);
                    let costate = costates.at_points[p].clone();
                    rows.add(time, points.z(p), points.tau(p), costate, costates.hamiltonian[p])?;
                }
            }
            let nearest = (POINTS * node).clamp(POINTS * k, POINTS * (k + 1) - 1);
            let value = costates.hamiltonian[nearest] + ahead[0][node] - ahead[1][nearest];
            // At a via they jump.
            let before = node > k && spline.mesh.is_end(node);
            let costate = if before { &costates.before[k] } else { &costates.at_nodes[node] };
            let (z, tau) = (ends.points.z(end), ends.points.tau(end));
            rows.add(spline.time_at(spline.mesh.nodes[node]), z, tau, costate.clone(), value)?;
        }
        let places = [0, 0, 1, 2, 2].map(|j| POINTS * k + j).into_iter().filter(|_| has_accelerations);
        rows.by_torques.extend(places.map(|p| by_torques(interior, p)));
    }
    Ok(rows.trajectory())
}

/// The derivatives of the Lagrange function per second by the torques at a point.
fn by_torques<D>(interior: &Interior<D>, p: usize) -> Vec<f64> {
    let (n, scale) = (interior.points.dof, 1.0 / interior.spline.weight(p));
    interior.points.weights[n * p..][..n].iter().map(|weight| scale * weight).collect()
}

/// The same where nothing jumps at nodes, which are points.
fn smooth_trajectory<D: PointDynamics>(
    problem: &Problem,
    interior: &Interior<D>,
    costates: Costates,
) -> Result<Trajectory, EvalError> {
    let Costates { at_points, hamiltonian, .. } = costates;
    let (spline, points) = (&interior.spline, &interior.points);
    let mut rows = Rows::new(problem, spline);
    for (p, (costate, hamiltonian)) in at_points.into_iter().zip(hamiltonian).enumerate() {
        let time = spline.time_at(spline.mesh.point(p).0);
        rows.enter(spline.mesh.phase(spline.mesh.interval_of(p).0));
        rows.add(time, points.z(p), points.tau(p), costate, hamiltonian)?;
    }
    Ok(rows.trajectory())
}

/// q, v, a.
fn parts(z: &[f64]) -> (&[f64], &[f64], &[f64]) {
    let n = z.len() / 3;
    (&z[..n], &z[n..2 * n], &z[2 * n..])
}

/// The rows of a trajectory, one time after the other.
struct Rows<'a> {
    problem: &'a Problem,
    via_times: Vec<f64>,
    /// Those of all phases, and the phase of the models.
    robots: Vec<Robot>,
    phase: usize,
    limits: Vec<JointLimits>,
    momentum: Hamiltonian<f64>,
    /// Of a robot with constraints.
    closed: Option<ClosedMap>,
    /// Where M is nearly singular.
    transform: Option<LegendreTransform<f64>>,
    /// M, then its factor.
    mass: Vec<f64>,
    times: Vec<f64>,
    /// q, v, p, u, y_q, y_p.
    columns: [Vec<Vec<f64>>; 6],
    hamiltonian: Vec<f64>,
    accelerations: Vec<Vec<f64>>,
    /// Empty unless accelerations are limited.
    by_torques: Vec<Vec<f64>>,
}

impl<'a> Rows<'a> {
    fn new(problem: &'a Problem, spline: &Spline) -> Self {
        Self {
            via_times: (1..spline.times.len()).map(|end| spline.time_at(end as f64)).collect(),
            robots: problem.robots(),
            phase: 0,
            problem,
            limits: problem.joint_limits(),
            momentum: Hamiltonian::new(&problem.robot),
            closed: problem.loops.as_ref().map(|loops| ClosedMap::new(loops, 0)),
            transform: None,
            mass: Vec::new(),
            times: Vec::new(),
            columns: Default::default(),
            hamiltonian: Vec::new(),
            accelerations: Vec::new(),
            by_torques: Vec::new(),
        }
    }

    fn trajectory(self) -> Trajectory {
        let trajectory = Trajectory::from_rows(self.times, self.columns).with_hamiltonian(self.hamiltonian);
        let trajectory = trajectory.with_accelerations(self.accelerations).with_via_times(self.via_times);
        trajectory.with_y_tau(self.by_torques)
    }

    /// What follows belongs to this phase.
    fn enter(&mut self, phase: usize) {
        if self.phase != phase {
            self.momentum = Hamiltonian::new(&self.robots[phase]);
            self.closed = self.problem.loops.as_ref().map(|loops| ClosedMap::new(loops, phase));
            self.transform = None;
            self.phase = phase;
        }
    }

    /// M v, and costates of (q, v) as those of (q, p): `y_p = M^-1 y_v`, `y_q` less `P' y_p`, P the
    /// derivative of M v by q. `None`, and nothing is changed, where M is nearly singular.
    fn map(&mut self, q: &[f64], v: &[f64], costate: &mut [f64]) -> Result<Option<Vec<f64>>, EvalError> {
        let (n, map) = (q.len(), self.momentum.linearise_momentum(q, v)?);
        self.mass.clear();
        (0..n).for_each(|i| self.mass.extend_from_slice(map.dp_dv.row(i)));
        let rows = self.mass.chunks_exact(n);
        let momentum = rows.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum()).collect();
        let is_regular = cholesky::factorise(&mut self.mass, n)
            && (0..n).all(|i| self.mass[(n + 1) * i].powi(2) > LEAST_PIVOT * map.dp_dv.row(i)[i]);
        if !is_regular {
            return Ok(None);
        }
        let (y_q, y_p) = costate.split_at_mut(n);
        cholesky::solve(&self.mass, n, y_p);
        for (i, &weight) in y_p.iter().enumerate() {
            y_q.iter_mut().zip(map.dp_dq.row(i)).for_each(|(y, &p)| *y -= weight * p);
        }
        Ok(Some(momentum))
    }

    /// The same with a test whether M is singular.
    fn map_carefully(&mut self, [q, v, u]: [&[f64]; 3], costate: &mut [f64]) -> Result<Vec<f64>, EvalError> {
        let robot = &self.robots[self.phase];
        match self.transform.get_or_insert_with(|| LegendreTransform::new(robot)).at(q, v, u) {
            Ok(mut map) => {
                map.costate_to_hamiltonian(costate)?;
                Ok(map.momentum().to_vec())
            }
            // M^-1 maps the costates.
            Err(EvalError::SingularMassMatrix { .. }) => {
                costate.fill(f64::NAN);
                Ok(self.momentum.momentum(q, v)?.to_vec())
            }
            Err(error) => Err(error),
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
        let (n, (q, v, a)) = (tau.len(), parts(z));
        let cut =
            tau.iter().zip(&self.limits).map(|(tau, limit)| tau.clamp(limit.torque[0], limit.torque[1]));
        let u: Vec<f64> = cut.zip(&self.problem.gain).map(|(tau, gain)| tau / gain).collect();
        let momentum = match &mut self.closed {
            Some(closed) => closed.apply(q, v, &mut costate)?,
            None => match self.map(q, v, &mut costate)? {
                Some(momentum) => momentum,
                None => self.map_carefully([q, v, &u], &mut costate)?,
            },
        };
        let (y_q, y_p) = costate.split_at(n);
        for (column, row) in self.columns.iter_mut().zip([q, v, &momentum, &u, y_q, y_p]) {
            column.push(row.to_vec());
        }
        self.times.push(time);
        self.accelerations.push(a.to_vec());
        self.hamiltonian.push(hamiltonian);
        Ok(())
    }
}
