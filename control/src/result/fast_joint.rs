//! Joints that are too light for the mesh of a motion.
//!
//! Near a motion `M dd = -tau_q d - tau_v d'`, so the largest eigenvalue
//!
//! $$ \rho = \max |\lambda|, \qquad \lambda \in \sigma \begin{pmatrix} 0 & 1 \\\\ -M^{-1} \tau\_q &
//!    -M^{-1} \tau\_v \end{pmatrix}, $$
//!
//! is the rate at which deviations grow, or turn. Those of the costates have the same one. A polynomial on an
//! interval of the length h follows them as long as `rho h` is about one. A link without a rotor that whirls,
//! or that its heavy neighbours shake, has rates far above those of the robot. So has a joint that creeps
//! with dry friction: its force changes by `c/v_t` per rad/s within the transition velocity `v_t`, and rho is
//! `c/(M v_t)`.

use crate::constants::checks::fast_joint::{BISECTIONS, HELD, PLACES, RESOLVED, SQUARINGS};
use crate::numerics::cholesky;
use crate::problem::Problem;
use crate::result::samples::SampleError;
use crate::result::solution::Solution;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;

/// A joint that moves faster than the mesh of a motion can follow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FastJoint {
    /// The joint, counted from 0 among those that mimic no other.
    pub joint: usize,
    /// When that is so most (s).
    pub time: f64,
    /// The reciprocal of the largest eigenvalue of the dynamics near the motion (s).
    pub time_constant: f64,
    /// The length of the interval of the mesh there (s).
    pub interval: f64,
    /// Inertia of a rotor at this joint with which the mesh would follow (kg m^2, kg), the inertias of other
    /// joints being what they are; `None` where others are as fast, or dry friction is the reason.
    pub armature: Option<f64>,
    /// Where dry friction is the reason: the transition velocity of the friction of this joint that the mesh
    /// would resolve (rad/s, m/s), those of other joints being larger by the same factor.
    pub coulomb_velocity: Option<f64>,
}

/// The dynamics near a motion, row by row.
#[derive(Clone)]
struct Near {
    n: usize,
    mass: Vec<f64>,
    tau_q: Vec<f64>,
    tau_v: Vec<f64>,
    /// What dry friction has in the diagonal of tau_v, and the transition velocity of each joint.
    friction: Vec<[f64; 2]>,
}

impl Near {
    /// The largest magnitude of an eigenvalue with further inertias at the joints; `None` where the mass
    /// matrix is singular.
    fn rate(&self, more: &[f64]) -> Option<f64> {
        let (n, m) = (self.n, 2 * self.n);
        let mut factor = self.mass.clone();
        (0..n).for_each(|i| factor[(n + 1) * i] += more[i]);
        if !cholesky::factorise(&mut factor, n) {
            return None;
        }
        let mut a = vec![0.0; m * m];
        let mut column = vec![0.0; n];
        for j in 0..n {
            a[m * j + n + j] = 1.0;
            for (from, first) in [(&self.tau_q, 0), (&self.tau_v, n)] {
                (0..n).for_each(|i| column[i] = -from[n * i + j]);
                cholesky::solve(&factor, n, &mut column);
                (0..n).for_each(|i| a[m * (n + i) + first + j] = column[i]);
            }
        }
        // Positions in a unit of time in which both halves have about the same size.
        let norm = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
            let entries = rows.flat_map(|i| columns.clone().map(move |j| m * i + j));
            entries.map(|at| a[at] * a[at]).sum::<f64>().sqrt()
        };
        let unit = norm(n..m, 0..n).sqrt().max(norm(n..m, n..m));
        if unit == 0.0 || !unit.is_finite() {
            return (unit == 0.0).then_some(0.0);
        }
        for i in 0..n {
            a[m * i + n + i] = 1.0;
            (0..n).for_each(|j| a[m * (n + i) + j] /= unit * unit);
            (0..n).for_each(|j| a[m * (n + i) + n + j] /= unit);
        }
        let (mut logarithm, mut power, mut square) = (0.0, 1.0, vec![0.0; m * m]);
        for _ in 0..SQUARINGS {
            for i in 0..m {
                for j in 0..m {
                    square[m * i + j] = (0..m).map(|k| a[m * i + k] * a[m * k + j]).sum();
                }
            }
            let size = square.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            power *= 2.0;
            if size == 0.0 {
                return Some(0.0);
            }
            logarithm += size.ln() / power;
            a.iter_mut().zip(&square).for_each(|(a, entry)| *a = entry / size);
        }
        Some(unit * f64::exp(logarithm))
    }

    /// The rate with dry friction divided by this; no friction for an infinite factor.
    fn rate_with_friction_over(&self, factor: f64) -> Option<f64> {
        let mut other = self.clone();
        for (i, [slope, _]) in self.friction.iter().enumerate() {
            other.tau_v[(self.n + 1) * i] -= (1.0 - 1.0 / factor) * slope;
        }
        other.rate(&vec![0.0; self.n])
    }

    /// Where it is fast by dry friction alone: the joint whose friction is steepest for its inertia, and the
    /// transition velocity with which it is no faster than `allowed`.
    fn rubbing_joint(&self, allowed: f64) -> Option<(usize, f64)> {
        if self.rate_with_friction_over(f64::INFINITY)? > allowed {
            return None;
        }
        let rate = |i: &usize| self.friction[*i][0] / self.mass[(self.n + 1) * i];
        let joint = (0..self.n).max_by(|a, b| rate(a).total_cmp(&rate(b)))?;
        let (mut low, mut high) = (1.0, HELD);
        for _ in 0..BISECTIONS {
            let middle = (low * high).sqrt();
            match self.rate_with_friction_over(middle)? <= allowed {
                true => high = middle,
                false => low = middle,
            }
        }
        Some((joint, high * self.friction[joint][1]))
    }

    /// The joint that makes it fast, and the inertia with which it is no faster than `allowed`.
    fn joint(&self, allowed: f64) -> Option<(usize, Option<f64>)> {
        let largest = (0..self.n).map(|i| self.mass[(self.n + 1) * i]).fold(0.0, f64::max);
        let with = |joint: usize, inertia: f64| {
            let more: Vec<f64> = (0..self.n).map(|i| if i == joint { inertia } else { 0.0 }).collect();
            self.rate(&more)
        };
        let held = (0..self.n).filter_map(|i| Some((i, with(i, HELD * largest)?)));
        let (joint, rest) = held.min_by(|a, b| a.1.total_cmp(&b.1))?;
        if rest > allowed {
            return Some((joint, None));
        }
        let (mut low, mut high) = (1.0 / HELD * largest, HELD * largest);
        for _ in 0..BISECTIONS {
            let middle = (low * high).sqrt();
            match with(joint, middle)? <= allowed {
                true => high = middle,
                false => low = middle,
            }
        }
        Some((joint, Some(high)))
    }
}

impl Solution {
    /// The joint that moves faster than the mesh of the motion follows, where there is one: the cause of most
    /// motions of light links without rotors that are not solved. `None` for a motion that its mesh can
    /// follow, for robots with constraints, floating or spherical joints, and without a motion. `problem` is
    /// the one that was solved.
    ///
    /// # Errors
    /// [`SampleError`], for a motion of another robot and where the dynamics cannot be evaluated.
    pub fn fastest_joint(&self, problem: &Problem) -> Result<Option<FastJoint>, SampleError> {
        let Some(row) = self.trajectory.q.first() else { return Ok(None) };
        let (found, expected) = (row.len(), problem.robot.dof());
        if problem.is_closed() || !problem.robot.free_joints().is_empty() {
            return Ok(None);
        }
        if found != expected {
            return Err(SampleError::OtherRobot { found, expected });
        }
        let (Some(nodes), Some(times)) = (self.trajectory.mesh_nodes(), self.trajectory.phase_times()) else {
            return Ok(None);
        };
        let (n, none) = (found, vec![0.0; found]);
        let mut models: Vec<_> = problem.robots().iter().map(Lagrangian::<f64>::new).collect();
        let mut worst: Option<(f64, FastJoint, Near)> = None;
        let stride = nodes.len().div_ceil(PLACES);
        for ends in nodes.windows(2).step_by(stride) {
            let phase = (ends[0] as usize).min(times.len() - 1);
            let before: f64 = times[..phase].iter().sum();
            let interval = (ends[1] - ends[0]) * times[phase];
            let t = self.trajectory.t[0] + before + (0.5 * (ends[0] + ends[1]) - phase as f64) * times[phase];
            let (Some(point), Some(a)) = (self.trajectory.at(t), self.trajectory.acceleration(t)) else {
                return Ok(None);
            };
            let model = phase.min(models.len() - 1);
            let torque = models[model].linearise_inverse_dynamics(&point.q, &point.v, &a)?;
            let entries = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
                (0..n * n).map(|at| of(at / n, at % n)).collect()
            };
            let near = Near {
                n,
                mass: entries(&|i, j| torque.tau_a[(i, j)]),
                tau_q: entries(&|i, j| torque.tau_q[(i, j)]),
                tau_v: entries(&|i, j| torque.tau_v[(i, j)]),
                friction: slopes_of_friction(&problem.robot, &point.v),
            };
            let Some(rate) = near.rate(&none) else { continue };
            let steps = rate * interval;
            if steps > RESOLVED && worst.as_ref().is_none_or(|(most, ..)| steps > *most) {
                let (time_constant, armature, coulomb_velocity) = (1.0 / rate, None, None);
                let joint =
                    FastJoint { joint: 0, time: t, time_constant, interval, armature, coulomb_velocity };
                worst = Some((steps, joint, near));
            }
        }
        Ok(worst.and_then(|(_, fast, near)| {
            let allowed = RESOLVED / fast.interval;
            if let Some((joint, velocity)) = near.rubbing_joint(allowed) {
                return Some(FastJoint { joint, coulomb_velocity: Some(velocity), ..fast });
            }
            let (joint, armature) = near.joint(allowed)?;
            Some(FastJoint { joint, armature, ..fast })
        }))
    }
}

/// Derivatives of dry friction by the rates of independent joints, `sum c a^2/v_t sech^2(a v/v_t)` with the
/// ratios a of the joints that mimic one, and the transition velocity of the steepest.
fn slopes_of_friction(robot: &Robot, v: &[f64]) -> Vec<[f64; 2]> {
    let mut slopes = vec![[0.0, 0.0]; v.len()];
    let mut steepest = vec![0.0; v.len()];
    for (index, joint) in robot.joints().iter().enumerate().filter(|(_, joint)| joint.friction.coulomb > 0.0)
    {
        let (leader, ratio) = joint.mimic.map_or((index, 1.0), |mimic| (mimic.joint, mimic.ratio));
        let Some(row) = robot.independent_indices().iter().position(|&own| own == leader) else { continue };
        let width = joint.friction.coulomb_velocity;
        let slope =
            joint.friction.coulomb * ratio * ratio / (width * (ratio * v[row] / width).cosh().powi(2));
        slopes[row][0] += slope;
        if slope >= steepest[row] {
            (steepest[row], slopes[row][1]) = (slope, width);
        }
    }
    slopes
}
