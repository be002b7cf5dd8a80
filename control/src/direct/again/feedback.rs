//! How an optimal motion changes with its ends: what a controller needs near it.

use crate::direct::motion::shape::{PLACES, POINTS};

/// Derivatives of an optimal motion by its start and its end, at its points: neighbouring optimal feedback.
///
/// States x = (q, v) have 2n entries, n joints; matrices are row by row. A motion that starts at `x_0 + dx_0`
/// has at the same part of its time the state `x + X dx_0` and the torques `tau + tau_x0 dx_0`, and its
/// duration changes by `T_x0 . dx_0`, up to terms in the square of dx_0. So a state that is off by dx at the
/// time t is led to the end at the least cost by
///
/// $$ \Delta\tau = K(t) \Delta x, \qquad K = \frac{\partial \tau}{\partial x_0}
///    \left( \frac{\partial x}{\partial x_0} \right)^{-1} $$
///
/// as long as the same limits are active. Limits are those of the barrier problem at the gap at which the
/// motion was solved, or at a wider one where that is so stiff that rounding would show: an active limit is
/// an equation to about 1e-5. K next to the ends of arcs at limits is as good as the mesh: that of a two-link
/// arm with an elbow at its torque limit from the start is that of solving again to 4 % of its largest entry
/// with tolerances from 1e-4 to 1e-8, where no limit is active to 0.2 %. Where the
/// end is given, gains grow without bound towards it: [`gain`](Self::gain) holds that of 98 % of the time.
///
/// The derivatives come from the factorised equations of Newton's method by a substitution for each column,
/// without an evaluation of the dynamics. A. E. Bryson, Y.-C. Ho, Applied Optimal Control, 1975, section 6.4.
#[derive(Clone, Debug, Default)]
pub struct Feedback {
    dof: usize,
    /// Nodes, in parts of the time.
    nodes: Vec<f64>,
    time: f64,
    /// X by the start and by the end, 2n x 2n a point.
    pub(super) states_by: [Vec<f64>; 2],
    /// n x 2n a point.
    pub(super) torques_by: [Vec<f64>; 2],
    pub(super) time_by: [Vec<f64>; 2],
    /// K, n x 2n a point.
    pub(super) gains: Vec<f64>,
    pub(super) has_gain: bool,
    pub(super) cost_x: Vec<f64>,
    pub(super) cost_xx: Vec<f64>,
    /// One change of an end, and none.
    pub(super) change: Vec<f64>,
    pub(super) none: Vec<f64>,
    /// 2n x 3n.
    pub(super) work: Vec<f64>,
    pub(super) exchanges: Vec<usize>,
}

/// Gains grow without bound towards a given end; they are held from this part of the time on.
const HELD: f64 = 0.98;

impl Feedback {
    pub(super) fn resize(&mut self, n: usize, nodes: &[f64], time: f64) {
        let points = POINTS * (nodes.len() - 1);
        (self.dof, self.time) = (n, time);
        self.nodes.clear();
        self.nodes.extend_from_slice(nodes);
        for end in 0..2 {
            self.states_by[end].resize(4 * n * n * points, 0.0);
            self.torques_by[end].resize(2 * n * n * points, 0.0);
            self.time_by[end].resize(2 * n, 0.0);
        }
        self.gains.resize(2 * n * n * points, 0.0);
        self.cost_x.resize(2 * n, 0.0);
        self.cost_xx.resize(4 * n * n, 0.0);
        self.change.resize(2 * n, 0.0);
        self.none.resize(2 * n, 0.0);
        self.work.resize(6 * n * n, 0.0);
        self.exchanges.resize(2 * n, 0);
    }

    /// All its numbers one after the other, to keep them or to send them to another process.
    pub fn to_numbers(&self) -> Vec<f64> {
        let head = [self.nodes.len() as f64, f64::from(u8::from(self.has_gain)), self.time];
        let mut copy = self.clone();
        [&head[..], &self.nodes]
            .into_iter()
            .chain(copy.lists().map(|list| &**list))
            .flatten()
            .copied()
            .collect()
    }

    /// The feedback of n joints with these [numbers](Self::to_numbers); `None` where their count does not
    /// fit.
    pub fn from_numbers(dof: usize, numbers: &[f64]) -> Option<Self> {
        let (&[count, has_gain, time], rest) = numbers.split_first_chunk()?;
        let (nodes, mut rest) = rest.split_at_checked(count as usize)?;
        let mut feedback = Self { has_gain: has_gain == 1.0, ..Self::default() };
        if nodes.len() < 2 || dof == 0 || rest.len() / nodes.len() < dof {
            return None;
        }
        feedback.resize(dof, nodes, time);
        for list in feedback.lists() {
            let (here, behind) = rest.split_at_checked(list.len())?;
            list.copy_from_slice(here);
            rest = behind;
        }
        rest.is_empty().then_some(feedback)
    }

    /// The lists of derivatives.
    fn lists(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let Self { states_by, torques_by, time_by, gains, cost_x, cost_xx, .. } = self;
        let by_ends = [states_by, torques_by, time_by].into_iter().flatten();
        by_ends.chain([gains, cost_x, cost_xx])
    }

    /// Number of joints, n.
    pub fn dof(&self) -> usize {
        self.dof
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        POINTS * self.nodes.len().saturating_sub(1)
    }

    /// The time of a point (s).
    pub fn time(&self, point: usize) -> f64 {
        let (k, j) = (point / POINTS, point % POINTS);
        self.time * (self.nodes[k] + PLACES[j] * (self.nodes[k + 1] - self.nodes[k]))
    }

    /// X at a point, 2n x 2n: the derivative of x = (q, v) there by the state at the start. Columns of what
    /// is free at the start are zero.
    pub fn states_by_start(&self, point: usize) -> &[f64] {
        self.part(&self.states_by[0], point, 4)
    }

    /// The same by the state at the end.
    pub fn states_by_end(&self, point: usize) -> &[f64] {
        self.part(&self.states_by[1], point, 4)
    }

    /// Derivatives of the torques and forces at a point by the state at the start, n x 2n.
    pub fn torques_by_start(&self, point: usize) -> &[f64] {
        self.part(&self.torques_by[0], point, 2)
    }

    /// The same by the state at the end.
    pub fn torques_by_end(&self, point: usize) -> &[f64] {
        self.part(&self.torques_by[1], point, 2)
    }

    /// Derivatives of the final time by the state at the start, 2n; zero where it is fixed.
    pub fn time_by_start(&self) -> &[f64] {
        &self.time_by[0]
    }

    /// The same by the state at the end.
    pub fn time_by_end(&self) -> &[f64] {
        &self.time_by[1]
    }

    /// dJ/dx_0, 2n: minus the costate of (q, v) at the start.
    pub fn cost_gradient(&self) -> &[f64] {
        &self.cost_x
    }

    /// The second derivatives of the least cost by the state at the start, 2n x 2n, symmetric.
    pub fn cost_hessian(&self) -> &[f64] {
        &self.cost_xx
    }

    /// K at a point, n x 2n (N m/rad, N m s/rad; N/m, N s/m); `None` where something is free at the start.
    pub fn gain_at_point(&self, point: usize) -> Option<&[f64]> {
        self.has_gain.then(|| self.part(&self.gains, point, 2))
    }

    /// Writes K(t), n x 2n, at time t (s): a parabola through the points of each interval. False, and nothing
    /// is written, where something is free at the start, `gain` has not 2 n^2 entries or t is NaN; t beyond
    /// the ends counts as that of the end.
    pub fn gain(&self, t: f64, gain: &mut [f64]) -> bool {
        if !self.has_gain || gain.len() != 2 * self.dof * self.dof || t.is_nan() {
            return false;
        }
        let s = (t / self.time).clamp(0.0, HELD);
        let last = self.nodes.len() - 2;
        let k = self.nodes.partition_point(|&node| node <= s).saturating_sub(1).min(last);
        let x = (s - self.nodes[k]) / (self.nodes[k + 1] - self.nodes[k]);
        gain.fill(0.0);
        for (j, place) in PLACES.into_iter().enumerate() {
            let others = (0..POINTS).filter(|&l| l != j);
            let factor: f64 = others.map(|l| (x - PLACES[l]) / (place - PLACES[l])).product();
            let at_point = self.part(&self.gains, POINTS * k + j, 2);
            gain.iter_mut().zip(at_point).for_each(|(to, from)| *to += factor * from);
        }
        true
    }

    /// `rows` n^2 entries of a point.
    fn part<'a>(&self, all: &'a [f64], point: usize, rows: usize) -> &'a [f64] {
        let size = rows * self.dof * self.dof;
        &all[size * point..][..size]
    }
}
