//! The motion of a robot over time.

use crate::cubics::{JointState, cubic};
use crate::result::free_entries::FreeEntries;
use crate::result::nodes::{Interpolant, Nodes, Place, place};
use crate::result::quintic::{StateAndJerk, quintic};
use std::ops::Range;

/// The motion of a robot at the nodes of its mesh; at a switch two nodes have the same time.
///
/// Rows are nodes, entries of a row are joints in the order of the robot. Of robots with floating or
/// spherical joints [`free_joints`](Self::free_joints) says where their entries are.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Trajectory {
    /// Times (s), rising.
    pub t: Vec<f64>,
    /// Positions (rad, m).
    pub q: Vec<Vec<f64>>,
    /// Velocities (rad/s, m/s).
    pub v: Vec<Vec<f64>>,
    /// Momenta `p = M v`.
    pub p: Vec<Vec<f64>>,
    /// Controls, before the gain (N m, N).
    pub u: Vec<Vec<f64>>,
    /// Costates of q.
    pub y_q: Vec<Vec<f64>>,
    /// Costates of p.
    pub y_p: Vec<Vec<f64>>,
    /// Where accelerations are limited: derivatives by the torques of the running cost, per second, less the
    /// limits with their multipliers. Else they are y_p, and this is empty. Of motions of the direct method
    /// they are known at the points; at a node that of the nearest one stands.
    pub y_tau: Vec<Vec<f64>>,
    /// H*; empty for a trajectory that was read from a file.
    pub hamiltonian: Vec<f64>,
    /// The times of the vias, or of lift-off after double support (s): where one phase ends and the next one
    /// begins. Each is that of two nodes.
    pub via_times: Vec<f64>,
    /// The floating and spherical joints: q has one entry more for each of them than v.
    pub free_joints: Vec<FreeEntries>,
    pub(super) interpolant: Option<Interpolant>,
    /// Accelerations at the nodes of a motion whose q(t) is a quintic between them.
    pub(super) accelerations: Option<Vec<Vec<f64>>>,
}

/// The motion of a robot at one time.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct TrajectoryPoint {
    /// Time (s).
    pub t: f64,
    /// Positions (rad, m).
    pub q: Vec<f64>,
    /// Velocities (rad/s, m/s).
    pub v: Vec<f64>,
    /// Momenta.
    pub p: Vec<f64>,
    /// Controls, before the gain (N m, N).
    pub u: Vec<f64>,
    /// Costates of q.
    pub y_q: Vec<f64>,
    /// Costates of p.
    pub y_p: Vec<f64>,
}

impl Trajectory {
    /// From nodes of `z = (q, p, y_q, y_p)` and the velocities there.
    pub(crate) fn from_nodes(nodes: Nodes, v: Vec<Vec<f64>>) -> Self {
        let n = v.first().map_or(0, Vec::len);
        let part = |k: usize| nodes.z.iter().map(|z| z[k * n..(k + 1) * n].to_vec()).collect::<Vec<_>>();
        let (q, p, y_q, y_p) = (part(0), part(1), part(2), part(3));
        let Nodes { t, u, hamiltonian, interpolant, .. } = nodes;
        let (via_times, free_joints) = (Vec::new(), Vec::new());
        let (accelerations, y_tau) = (None, Vec::new());
        Self {
            t,
            q,
            v,
            p,
            u,
            y_q,
            y_p,
            y_tau,
            hamiltonian,
            via_times,
            free_joints,
            interpolant,
            accelerations,
        }
    }

    /// Without a polynomial between the nodes; the rows of q, v, p, u, y_q and y_p.
    pub(crate) fn from_rows(t: Vec<f64>, [q, v, p, u, y_q, y_p]: [Vec<Vec<f64>>; 6]) -> Self {
        Self { t, q, v, p, u, y_q, y_p, ..Self::default() }
    }

    /// With these times of vias.
    pub(crate) fn with_via_times(self, via_times: Vec<f64>) -> Self {
        Self { via_times, ..self }
    }

    /// With these floating and spherical joints.
    pub(crate) fn with_free_joints(self, free_joints: Vec<FreeEntries>) -> Self {
        Self { free_joints, ..self }
    }

    /// Number of degrees of freedom; 0 without a motion.
    pub(crate) fn dof(&self) -> usize {
        self.v.first().map_or(0, Vec::len)
    }

    /// How long the phases take (s); `None` without a motion.
    pub(crate) fn phase_times(&self) -> Option<Vec<f64>> {
        let ends = [*self.t.first()?].into_iter().chain(self.via_times.iter().copied());
        let ends: Vec<f64> = ends.chain([*self.t.last()?]).collect();
        Some(ends.windows(2).map(|pair| pair[1] - pair[0]).collect())
    }

    /// The phase of a time, from 0; that after a via at its time.
    pub fn phase_at(&self, t: f64) -> usize {
        self.via_times.partition_point(|&via| via <= t)
    }

    /// The nodes of each phase. Of the two at the time of a via the first one belongs to the phase before.
    pub(crate) fn phases(&self) -> impl Iterator<Item = Range<usize>> {
        let first = |via: &f64| self.t.partition_point(|t| t < via) + 1;
        let firsts: Vec<usize> = self.via_times.iter().map(first).chain([self.t.len()]).collect();
        (0..firsts.len()).map(move |phase| if phase > 0 { firsts[phase - 1] } else { 0 }..firsts[phase])
    }

    /// With accelerations at the nodes: q(t) is the quintic that meets q, v and them.
    pub(crate) fn with_accelerations(self, accelerations: Vec<Vec<f64>>) -> Self {
        Self { accelerations: Some(accelerations), ..self }
    }

    /// Accelerations at the nodes, of motions of the direct method that were not read from a file.
    pub(crate) fn accelerations(&self) -> Option<&[Vec<f64>]> {
        self.accelerations.as_deref()
    }

    /// Without the first of two rows at the same time, and without polynomials between rows.
    pub(crate) fn with_each_time_once(&self) -> Self {
        let kept: Vec<usize> = (0..self.t.len()).filter(|&k| self.t.get(k + 1) != Some(&self.t[k])).collect();
        let rows = |rows: &[Vec<f64>]| kept.iter().map(|&k| rows[k].clone()).collect();
        let columns = [&self.q, &self.v, &self.p, &self.u, &self.y_q, &self.y_p].map(|column| rows(column));
        let once = Self::from_rows(kept.iter().map(|&k| self.t[k]).collect(), columns);
        once.with_free_joints(self.free_joints.clone())
    }

    /// The same for so many joints: the first ones, or with zeros for further ones.
    pub(crate) fn of_joints(&self, n: usize) -> Self {
        let resized = |row: &Vec<f64>| row.iter().copied().chain(std::iter::repeat(0.0)).take(n).collect();
        let rows = |rows: &[Vec<f64>]| rows.iter().map(resized).collect::<Vec<Vec<f64>>>();
        let columns = [&self.q, &self.v, &self.p, &self.u, &self.y_q, &self.y_p].map(|column| rows(column));
        Self {
            y_tau: rows(&self.y_tau),
            hamiltonian: self.hamiltonian.clone(),
            via_times: self.via_times.clone(),
            accelerations: self.accelerations.as_deref().map(rows),
            ..Self::from_rows(self.t.clone(), columns)
        }
    }

    /// With derivatives by the torques, [`y_tau`](Self::y_tau).
    pub(crate) fn with_y_tau(self, y_tau: Vec<Vec<f64>>) -> Self {
        Self { y_tau, ..self }
    }

    /// What torques cost at a row, per second: the derivatives by them.
    pub(crate) fn by_torques(&self, row: usize) -> &[f64] {
        self.y_tau.get(row).unwrap_or(&self.y_p[row])
    }

    /// With H* at the nodes.
    pub(crate) fn with_hamiltonian(self, hamiltonian: Vec<f64>) -> Self {
        Self { hamiltonian, ..self }
    }

    /// The motion at time t (s); `None` outside of it.
    ///
    /// By the collocation polynomial, whose error between the nodes is estimated with the solution: q, p and
    /// the costates are its values, v is its derivative, u the polynomial through the controls at its points.
    /// In a motion of the direct method q is its own polynomial, v the derivative, and all else is linear. A
    /// trajectory that was read from a file has its nodes only: then q is the cubic that meets q and v at
    /// both nodes. So it is for robots with floating or spherical joints; quaternions are cubics divided by
    /// their lengths.
    pub fn at(&self, t: f64) -> Option<TrajectoryPoint> {
        let place = place(&self.t, t)?;
        match &self.interpolant {
            Some(interpolant) => Some(self.on_polynomial(t, interpolant, place)),
            None => Some(self.between_nodes(t, place)),
        }
    }

    /// The acceleration (rad/s^2, m/s^2) at time t (s), of motions of the direct method.
    pub(crate) fn acceleration(&self, t: f64) -> Option<Vec<f64>> {
        let states = self.quintics(place(&self.t, t)?)?;
        Some(states.map(|[_, _, a, _]| a).collect())
    }

    /// The jerk (rad/s^3, m/s^3) at time t (s), of motions of the direct method.
    pub(crate) fn jerk(&self, t: f64) -> Option<Vec<f64>> {
        let states = self.quintics(place(&self.t, t)?)?;
        Some(states.map(|[.., jerk]| jerk).collect())
    }

    /// Position, rate, acceleration and jerk of each joint on the quintics of a motion that has them.
    fn quintics(&self, Place { left: k, part, length }: Place) -> Option<impl Iterator<Item = StateAndJerk>> {
        let accelerations = self.accelerations.as_ref().filter(|_| length > 0.0)?;
        let state = move |k: usize, i: usize| [self.q[k][i], self.v[k][i], accelerations[k][i]];
        Some((0..self.q[k].len()).map(move |i| quintic(state(k, i), state(k + 1, i), length, part)))
    }

    fn on_polynomial(&self, t: f64, interpolant: &Interpolant, place: Place) -> TrajectoryPoint {
        let k = place.left;
        let n = self.q[k].len();
        let left = [&self.q[k][..], &self.p[k], &self.y_q[k], &self.y_p[k]].concat();
        let z = interpolant.values(&left, place);
        let part = |j: usize| z[j * n..(j + 1) * n].to_vec();
        let v = interpolant.derivative(place)[..n].to_vec();
        let u = interpolant.controls_at([&self.u[k], &self.u[k + 1]], place);
        TrajectoryPoint { t, q: part(0), v, p: part(1), u, y_q: part(2), y_p: part(3) }
    }

    fn between_nodes(&self, t: f64, place: Place) -> TrajectoryPoint {
        let Place { left: k, part, length } = place;
        if !self.free_joints.is_empty() {
            return self.between_quaternions(t, place);
        }
        let linear = |rows: &[Vec<f64>]| -> Vec<f64> {
            rows[k].iter().zip(&rows[k + 1]).map(|(left, right)| left + part * (right - left)).collect()
        };
        let state = |k: usize, i: usize| JointState { q: self.q[k][i], v: self.v[k][i] };
        let cubics = || (0..self.q[k].len()).map(|i| cubic(state(k, i), state(k + 1, i), length, part));
        let states: Vec<JointState> = match self.quintics(place) {
            Some(states) => states.map(|[q, v, ..]| JointState { q, v }).collect(),
            None => cubics().collect(),
        };
        // Two nodes at one time.
        let v = if length > 0.0 { states.iter().map(|state| state.v).collect() } else { linear(&self.v) };
        TrajectoryPoint {
            t,
            q: states.iter().map(|state| state.q).collect(),
            v,
            p: linear(&self.p),
            u: linear(&self.u),
            y_q: linear(&self.y_q),
            y_p: linear(&self.y_p),
        }
    }

    /// The same of a robot with floating or spherical joints.
    fn between_quaternions(&self, t: f64, Place { left: k, part, length }: Place) -> TrajectoryPoint {
        let linear = |rows: &[Vec<f64>]| -> Vec<f64> {
            rows[k].iter().zip(&rows[k + 1]).map(|(left, right)| left + part * (right - left)).collect()
        };
        let rates = [k, k + 1].map(|k| FreeEntries::rates(&self.free_joints, &self.q[k], &self.v[k]));
        let state = |j: usize, i: usize| JointState { q: self.q[k + j][i], v: rates[j][i] };
        let entries = (0..self.q[k].len()).map(|i| cubic(state(0, i), state(1, i), length, part));
        let (mut q, rates): (Vec<f64>, Vec<f64>) = match length > 0.0 {
            true => entries.map(|JointState { q, v }| (q, v)).unzip(),
            false => (linear(&self.q), rates[0].clone()),
        };
        let v = FreeEntries::velocities(&self.free_joints, &mut q, &rates);
        TrajectoryPoint {
            t,
            q,
            v,
            p: linear(&self.p),
            u: linear(&self.u),
            y_q: linear(&self.y_q),
            y_p: linear(&self.y_p),
        }
    }
}
