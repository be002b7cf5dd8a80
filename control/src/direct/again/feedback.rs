//! How an optimal motion changes with its ends: what a controller needs near it.

use crate::constants::checks::feedback::HELD;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::direct::motion::spline::Spline;
use crate::direct::newton::rests::Rest;
use crate::numerics::lagrange::values;

/// Where gains are known in an interval: at the node before it and at Gauss's points.
const KNOWN: [f64; POINTS + 1] = [0.0, PLACES[0], PLACES[1], PLACES[2]];

/// Derivatives of an optimal motion by its start and its end, at its points: neighbouring optimal feedback.
///
/// States x = (q, v) have 2n entries, n joints; where accelerations are continuous x = (q, v, a) with 3n.
/// Matrices are row by row, m = [`state`](Self::state) entries for a state. A motion that starts at
/// `x_0 + dx_0` has at the same part of the time of its phase the state `x + X dx_0` and the torques
/// `tau + tau_x0 dx_0`, and its duration changes by `T_x0 . dx_0`, up to terms in the square of dx_0.
///
/// A state that is off by dx at the time t is led to the end at the least cost by
///
/// $$ \Delta\tau = K(t) \Delta x, \qquad K(t) = \frac{\partial \tau(t)}{\partial x(t)} $$
///
/// the derivative of the first torques of the problem that starts at t by its start: with what is left of the
/// time, where one is given, and with all of the state given, also where the problem leaves some of its own
/// start free. The end of a periodic motion is led to where that of this motion is. Where accelerations are
/// continuous the control is the jerk: K is that of jerks, n x 3n. It exists where the jerk or the rate of
/// the torque of each joint costs something, and is computed in phases behind whose start all times are given
/// ([`Problem::has_gains`](crate::Problem::has_gains)). Without such a cost the Hamiltonian is linear in a
/// jerk, which is at its limit or on a singular arc; next to that it jumps with the state, and there is no K.
///
/// All this holds as long as the same limits are active. Limits are those of the barrier problem at the gap
/// at which the motion was solved, or at a wider one where that is so stiff that rounding would show: an
/// active limit is an equation to about 1e-5. What is at a limit of the control stays there: rows of torques
/// are zero, accelerations, powers and those of tools are kept. While a limit of the state is active K acts
/// on deviations that keep it, and is zero along its gradient and that of its derivative in time: such
/// deviations have no derivative. Before such an arc K grows as before a given end. Next to the ends of arcs
/// K is as good as the mesh: that of a two-link arm with an elbow at its torque limit from the start is that
/// of solving again to 6 % of its largest entry, where no limit is active to 0.2 %.
///
/// The derivatives by the ends come from the factorised equations of Newton's method by a substitution for
/// each column, the gains at all nodes from one elimination of them from the end on, without an evaluation of
/// the dynamics. A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, section 6.4; for the elimination from
/// the end D. H. Jacobson, D. Q. Mayne, Differential Dynamic Programming, 1970.
#[derive(Clone, Debug, Default)]
pub struct Feedback {
    dof: usize,
    /// Entries of a state.
    state: usize,
    /// Nodes, phase p from p to p + 1; the times of the phases, and those of the points.
    nodes: Vec<f64>,
    lengths: Vec<f64>,
    times: Vec<f64>,
    /// X by the start and by the end, m x m a point.
    pub(super) states_by: [Vec<f64>; 2],
    /// n x m a point.
    pub(super) torques_by: [Vec<f64>; 2],
    pub(super) time_by: [Vec<f64>; 2],
    /// K, n x m at each of Gauss's points, and at the node before each interval.
    pub(super) gains: Vec<f64>,
    pub(super) node_gains: Vec<f64>,
    pub(super) cost_x: Vec<f64>,
    pub(super) cost_xx: Vec<f64>,
    /// Changes of the unknowns at each end of a phase.
    pub(super) changes: Vec<Vec<f64>>,
    /// By the state at the node before: X and the control at each of Gauss's points of an interval.
    pub(super) own_states: Vec<f64>,
    pub(super) own_controls: Vec<f64>,
    /// The equations behind a node, and a step of the unknowns of an interval.
    pub(super) rest: Option<Rest>,
    pub(super) step: Vec<f64>,
    /// q, v, a and the jerk at a place, and their changes.
    pub(super) z: Vec<f64>,
    pub(super) dz: Vec<f64>,
    /// Rows of active limits over the state, and gradients at the points of an interval.
    pub(super) normals: Vec<f64>,
    pub(super) gradients: Vec<f64>,
    /// Rows of active limits of the control, and what they make of a gain.
    pub(super) rows: Vec<f64>,
    /// m x (m + n).
    pub(super) work: Vec<f64>,
    pub(super) exchanges: Vec<usize>,
}

impl Feedback {
    pub(super) fn resize(&mut self, spline: &Spline) {
        let (n, m, points) = (spline.dof, spline.node(), spline.mesh.points());
        let gauss_points = POINTS * spline.mesh.intervals();
        (self.dof, self.state) = (n, m);
        self.nodes.clone_from(&spline.mesh.nodes);
        self.lengths.clone_from(&spline.times);
        self.times.clear();
        self.times.extend((0..points).map(|p| spline.time_of(p)));
        for end in 0..2 {
            self.states_by[end].resize(m * m * points, 0.0);
            self.torques_by[end].resize(n * m * points, 0.0);
            self.time_by[end].resize(m, 0.0);
        }
        self.gains.resize(n * m * gauss_points, 0.0);
        self.node_gains.resize(n * m * spline.mesh.intervals(), 0.0);
        self.own_states.resize(m * m * POINTS, 0.0);
        self.own_controls.resize(n * m * POINTS, 0.0);
        self.cost_x.resize(m, 0.0);
        self.cost_xx.resize(m * m, 0.0);
        self.changes.resize_with(spline.times.len() + 1, Vec::new);
        self.changes.iter_mut().for_each(|change| change.resize(m, 0.0));
        self.work.resize(2 * m * m, 0.0);
        self.exchanges.resize(m, 0);
        let places = spline.mesh.shape.places().len();
        self.normals.clear();
        self.normals.reserve(m * (m + 1));
        self.gradients.resize(2 * 3 * n * places, 0.0);
        self.rows.reserve(n * (6 * n + m));
        self.z.resize(4 * n, 0.0);
        self.dz.resize(if spline.mesh.shape.is_smooth() { 4 * n } else { 3 * n }, 0.0);
    }

    /// Gives an interval these gains.
    pub(super) fn fill_interval(&mut self, k: usize, value: f64) {
        let size = self.dof * self.state;
        self.node_gains[size * k..size * (k + 1)].fill(value);
        self.gains[size * POINTS * k..size * POINTS * (k + 1)].fill(value);
    }

    /// All its numbers one after the other, to keep them or to send them to another process.
    pub fn to_numbers(&self) -> Vec<f64> {
        let mut copy = self.clone();
        let mut all = vec![self.state as f64];
        for list in copy.lists() {
            all.push(list.len() as f64);
            all.extend_from_slice(list);
        }
        all
    }

    /// The feedback of n joints with these [numbers](Self::to_numbers); `None` where their count does not
    /// fit.
    pub fn from_numbers(dof: usize, numbers: &[f64]) -> Option<Self> {
        let (&state, mut rest) = numbers.split_first()?;
        let mut feedback = Self { dof, state: state as usize, ..Self::default() };
        for list in feedback.lists() {
            let (&count, behind) = rest.split_first()?;
            let (here, behind) = behind.split_at_checked(count as usize)?;
            list.extend_from_slice(here);
            rest = behind;
        }
        (rest.is_empty() && feedback.fits()).then_some(feedback)
    }

    /// Whether all lists have the lengths that belong to the nodes and times.
    fn fits(&self) -> bool {
        let (n, m, points, nodes) = (self.dof, self.state, self.times.len(), self.nodes.len());
        let of_ends = self.states_by.iter().chain(&self.torques_by).chain(&self.time_by);
        let of_ends = of_ends
            .map(Vec::len)
            .eq([m * m, m * m, n * m, n * m].map(|size| size * points).into_iter().chain([m, m]));
        let is_state = n > 0 && (m == 2 * n || m == 3 * n) && nodes >= 2 && !self.lengths.is_empty();
        let at_nodes = n * m * nodes.saturating_sub(1);
        let lists = [&self.gains, &self.node_gains, &self.cost_x, &self.cost_xx];
        is_state && of_ends && lists.map(Vec::len) == [POINTS * at_nodes, at_nodes, m, m * m]
    }

    /// The lists that make it up.
    fn lists(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let Self { nodes, lengths, times, states_by, torques_by, time_by, .. } = self;
        let by_ends = [states_by, torques_by, time_by].into_iter().flatten();
        let others = [&mut self.gains, &mut self.node_gains, &mut self.cost_x, &mut self.cost_xx];
        [nodes, lengths, times].into_iter().chain(by_ends).chain(others)
    }

    /// Number of joints, n.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// Entries of a state, m: 2n, or 3n where accelerations are continuous.
    pub fn state(&self) -> usize {
        self.state
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.times.len()
    }

    /// The time of a point (s).
    pub fn time(&self, point: usize) -> f64 {
        self.times[point]
    }

    /// X at a point, m x m: the derivative of x there by the state at the start. Columns of what is free at
    /// the start are zero.
    pub fn states_by_start(&self, point: usize) -> &[f64] {
        self.part(&self.states_by[0], point, self.state)
    }

    /// The same by the state at the end.
    pub fn states_by_end(&self, point: usize) -> &[f64] {
        self.part(&self.states_by[1], point, self.state)
    }

    /// Derivatives of the torques and forces at a point by the state at the start, n x m.
    pub fn torques_by_start(&self, point: usize) -> &[f64] {
        self.part(&self.torques_by[0], point, self.dof)
    }

    /// The same by the state at the end.
    pub fn torques_by_end(&self, point: usize) -> &[f64] {
        self.part(&self.torques_by[1], point, self.dof)
    }

    /// Derivatives of the final time by the state at the start, m; zero where it is fixed.
    pub fn time_by_start(&self) -> &[f64] {
        &self.time_by[0]
    }

    /// The same by the state at the end.
    pub fn time_by_end(&self) -> &[f64] {
        &self.time_by[1]
    }

    /// dJ/dx_0, m: minus the costate of the state at the start.
    pub fn cost_gradient(&self) -> &[f64] {
        &self.cost_x
    }

    /// The second derivatives of the least cost by the state at the start, m x m, symmetric.
    pub fn cost_hessian(&self) -> &[f64] {
        &self.cost_xx
    }

    /// K at a point, n x 2n (N m/rad, N m s/rad; N/m, N s/m). `None` where accelerations are continuous:
    /// their points are not Gauss's; [`gain`](Self::gain) has K at any time.
    pub fn gain_at_point(&self, point: usize) -> Option<&[f64]> {
        (self.state == 2 * self.dof).then(|| self.part(&self.gains, point, self.dof))
    }

    /// Writes K(t), n x m, at time t (s). False where `gain` has not n m entries, t is NaN, or there is no
    /// gain; then nothing counts that is in it. t beyond the ends counts as that of the end.
    ///
    /// Towards a given end, r before it, the columns of K for q and v grow as r^-2 and r^-1, with continuous
    /// accelerations those for q, v and a as r^-3, r^-2 and r^-1: the control that leads a deviation to the
    /// end in the time r. So K times these powers of r is smooth up to the end, and is interpolated by the
    /// cubic through the node before t and Gauss's points, up to the time when it is [held](Self::held).
    pub fn gain(&self, t: f64, gain: &mut [f64]) -> bool {
        let (n, m) = (self.dof, self.state);
        if n == 0 || gain.len() != n * m || t.is_nan() {
            return false;
        }
        let (mut phase, mut rest) = (0, t.max(0.0));
        while phase + 1 < self.lengths.len() && rest >= self.lengths[phase] {
            rest -= self.lengths[phase];
            phase += 1;
        }
        let s = phase as f64 + (rest / self.lengths[phase]).min(HELD);
        let last = self.nodes.len() - 2;
        let k = self.nodes.partition_point(|&node| node <= s).saturating_sub(1).min(last);
        let width = self.nodes[k + 1] - self.nodes[k];
        let x = (s - self.nodes[k]) / width;
        let left = |x: f64| phase as f64 + 1.0 - (self.nodes[k] + x * width);
        gain.fill(0.0);
        for (j, (place, factor)) in KNOWN.into_iter().zip(values(&KNOWN, x)).enumerate() {
            let known = match j {
                0 => &self.node_gains[n * m * k..][..n * m],
                _ => &self.gains[n * m * (POINTS * k + j - 1)..][..n * m],
            };
            let ratio = left(place) / left(x);
            for (to, from) in gain.chunks_exact_mut(m).zip(known.chunks_exact(m)) {
                let mut scale = factor;
                // The highest derivative first.
                for (to, from) in to.chunks_exact_mut(n).zip(from.chunks_exact(n)).rev() {
                    scale *= ratio;
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += scale * from);
                }
            }
        }
        gain.iter().all(|entry| entry.is_finite())
    }

    /// For each phase the time from which on its gain is held, and its end (s).
    pub fn held(&self) -> impl Iterator<Item = [f64; 2]> {
        self.lengths.iter().scan(0.0, |end, length| {
            let start = *end;
            *end += length;
            Some([start + HELD * length, *end])
        })
    }

    /// `rows` rows of a point.
    fn part<'a>(&self, all: &'a [f64], point: usize, rows: usize) -> &'a [f64] {
        let size = rows * self.state;
        &all[size * point..][..size]
    }
}
