//! `J = c_t T + integral of the running cost`, from the formulas of `docs/optimize.md`, by adaptive
//! quadrature along the motion that was found.

use crate::moving::{Moving, State};
use crate::quadrature::integral;
use crate::references::Curve;
use costate::kinematics::Kinematics;
use costate_control::{Problem, Reference, Tool};

/// The cost of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Cost {
    /// With the torques that the robot needs for the motion.
    pub needed: f64,
    /// With those of the solution, cut to their limits.
    pub given: f64,
    /// Sum of the magnitudes of all parts.
    pub size: f64,
}

/// Relative tolerance of the quadrature.
const TOLERANCE: f64 = 1e-11;
/// Places in an interval at which a change of the sign of v - level is looked for.
const SEARCH: usize = 8;
/// Multiples of the transition velocity at which intervals are divided: beyond three of them dry friction
/// changes by less than 0.3 % of its value.
const LEVELS: [f64; 5] = [0.0, -3.0, 3.0, -1.0, 1.0];

/// The running cost of a problem.
pub struct Running<'a> {
    problem: &'a Problem,
    joints: Vec<(Curve, &'a [f64])>,
    tools: Vec<(Curve, &'a Tool, [bool; 3], f64)>,
    kinematics: Vec<Kinematics<f64>>,
}

impl<'a> Running<'a> {
    /// `Err` names what this study does not evaluate.
    pub fn new(moving: &Moving<'a>) -> Result<Self, String> {
        let problem = moving.problem;
        if !problem.terms.is_empty() {
            return Err("terms of the user".into());
        }
        let (mut joints, mut tools) = (Vec::new(), Vec::new());
        for reference in &problem.task.references {
            match reference {
                Reference::Joints(joint) => {
                    let curve = Curve::new(&joint.times, joint.positions.clone(), joint.velocities.clone());
                    joints.push((curve, &joint.weights[..]));
                }
                Reference::Tool(tool) => {
                    if tool.orientations.is_some() {
                        return Err("orientations over time".into());
                    }
                    let Some(positions) = &tool.positions else { continue };
                    let given = std::array::from_fn(|k| positions.iter().all(|row| row[k].is_finite()));
                    let finite = |row: &[f64; 3]| row.map(|x| if x.is_finite() { x } else { 0.0 }).to_vec();
                    let values = positions.iter().map(finite).collect();
                    let slopes = tool.velocities.as_ref().map(|rows| rows.iter().map(finite).collect());
                    tools.push((
                        Curve::new(&tool.times, values, slopes),
                        &tool.tool,
                        given,
                        tool.position_weight,
                    ));
                }
                _ => return Err("a kind of reference".into()),
            }
        }
        if problem.task.tool_costs.iter().any(|cost| cost.pose.orientation.is_some()) {
            return Err("costs of orientations".into());
        }
        let kinematics = moving.robots.iter().map(Kinematics::new).collect();
        Ok(Self { problem, joints, tools, kinematics })
    }

    /// Cost per second, with needed and with given torques, and the sum of the magnitudes of its parts.
    fn rate(&mut self, state: &State, jerk: Option<&[f64]>, torque_rate: Option<&[f64]>) -> Option<[f64; 3]> {
        let cost = &self.problem.cost;
        let mut common = cost.time;
        let mut size = cost.time.abs();
        let mut by_torque = [0.0; 2];
        for i in 0..state.v.len() {
            for (sum, tau) in by_torque.iter_mut().zip([&state.needed, &state.given]) {
                let u = tau[i] / self.problem.gain[i];
                let mut rate = 0.5 * cost.effort[i] * u * u;
                if let Some(energy) = &cost.energy {
                    let (p, s) = (tau[i] * state.v[i], cost.energy_smoothing);
                    // Without cancellation for large negative powers: (p + sqrt(p^2 + s^2)) = s^2/(sqrt -
                    // p).
                    let root = p.hypot(s);
                    let positive = if p > 0.0 { p + root } else { s * s / (root - p) };
                    let part = energy[i] * 0.5 * (positive - s);
                    size += 0.5 * (part.abs() - part);
                    rate += part;
                }
                *sum += rate;
            }
            let squares = |weights: &Option<Vec<f64>>, rates: Option<&[f64]>| {
                let (Some(weights), Some(rates)) = (weights, rates) else { return 0.0 };
                0.5 * weights[i] * rates[i] * rates[i]
            };
            common += squares(&cost.torque_rate, torque_rate) + squares(&cost.jerk, jerk);
            if let Some(penalty) = &self.problem.penalty {
                let beyond = |x: f64| 0.5 * penalty.weight * x.max(0.0).powi(2);
                let (q, v) = (state.q[i], state.v[i]);
                common += penalty.q_min.as_ref().map_or(0.0, |list| beyond(list[i] - q));
                common += penalty.q_max.as_ref().map_or(0.0, |list| beyond(q - list[i]));
                common += penalty.v_max.as_ref().map_or(0.0, |list| beyond(v.abs() - list[i]));
            }
        }
        for (curve, weights) in &self.joints {
            let r = curve.at(state.t);
            for ((r, q), weight) in r.iter().zip(&state.q).zip(*weights) {
                common += 0.5 * weight * (q - r).powi(2);
            }
        }
        if !self.tools.is_empty() || !self.problem.task.tool_costs.is_empty() {
            let robot = &self.problem.robot;
            let kinematics = &mut self.kinematics[state.phase];
            kinematics.set_position(&state.q).ok()?;
            for (curve, tool, given, weight) in &self.tools {
                let (x, r) = (
                    point(kinematics, robot.frame_index(&tool.frame).ok()?, tool.offset)?,
                    curve.at(state.t),
                );
                common +=
                    (0..3).filter(|&k| given[k]).map(|k| 0.5 * weight * (x[k] - r[k]).powi(2)).sum::<f64>();
            }
            for cost in &self.problem.task.tool_costs {
                let tool = &cost.pose.tool;
                let x = point(kinematics, robot.frame_index(&tool.frame).ok()?, tool.offset)?;
                let wanted = cost.pose.position.unwrap_or([f64::INFINITY; 3]);
                let weight = cost.position_weight;
                common += (0..3)
                    .filter(|&k| wanted[k].is_finite())
                    .map(|k| 0.5 * weight * (x[k] - wanted[k]).powi(2))
                    .sum::<f64>();
            }
        }
        Some([common + by_torque[0], common + by_torque[1], size + (common - cost.time) + by_torque[0].abs()])
    }
}

/// A point of a frame in the world (m).
pub fn point(kinematics: &Kinematics<f64>, frame: usize, offset: [f64; 3]) -> Option<[f64; 3]> {
    let pose = kinematics.pose(frame).ok()?;
    let row = |k: usize| (0..3).map(|j| pose.rotation[k][j] * offset[j]).sum::<f64>();
    Some(std::array::from_fn(|k| pose.position[k] + row(k)))
}

/// Times within a motion between which its running cost is smooth: where polynomials join, knots, and where
/// rates cross the levels of dry friction.
pub fn divisions(moving: &mut Moving<'_>) -> Option<Vec<f64>> {
    let mut ends = moving.joints_of_polynomials();
    let (start, end) = (moving.start(), moving.end());
    ends.extend(knots(moving.problem).into_iter().filter(|&t| t > start && t < end));
    ends.extend(crossings(moving)?.into_iter().map(|crossing| crossing.t));
    ends.sort_by(f64::total_cmp);
    ends.dedup();
    Some(ends)
}

/// The times of the knots of all references (s).
pub fn knots(problem: &Problem) -> Vec<f64> {
    problem.task.references.iter().flat_map(|reference| reference.times().iter().copied()).collect()
}

/// Where the rate of a joint crosses a level of its dry friction.
pub struct Crossing {
    pub t: f64,
}

/// All crossings of the joints with dry friction.
pub fn crossings(moving: &mut Moving<'_>) -> Option<Vec<Crossing>> {
    let joints: Vec<(usize, f64)> = moving
        .problem
        .robot
        .independent_joints()
        .enumerate()
        .filter(|(_, joint)| joint.friction.coulomb > 0.0)
        .map(|(i, joint)| (i, joint.friction.coulomb_velocity))
        .collect();
    if joints.is_empty() || !moving.problem.robot.free_joints().is_empty() {
        return Some(Vec::new());
    }
    let rows = moving.joints_of_polynomials();
    let times: Vec<f64> = rows
        .windows(2)
        .flat_map(|pair| (0..SEARCH).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / SEARCH as f64))
        .chain(rows.last().copied())
        .collect();
    let trajectory = &moving.solution.trajectory;
    let rate = |t: f64, i: usize| trajectory.at(t).map(|point| point.v[i]);
    let states: Option<Vec<_>> = times.iter().map(|&t| trajectory.at(t)).collect();
    let states = states?;
    let mut found = Vec::new();
    for (pair, ends) in states.windows(2).zip(times.windows(2)) {
        for &(i, width) in &joints {
            for level in LEVELS.map(|level| level * width) {
                let (mut a, mut b) = (ends[0], ends[1]);
                let left = pair[0].v[i] - level;
                if left * (pair[1].v[i] - level) >= 0.0 {
                    continue;
                }
                for _ in 0..50 {
                    let middle = 0.5 * (a + b);
                    match left * (rate(middle, i)? - level) > 0.0 {
                        true => a = middle,
                        false => b = middle,
                    }
                }
                found.push(Crossing { t: b });
            }
        }
    }
    Some(found)
}

/// The cost of a motion; `Err` says what is not evaluated.
pub fn cost(moving: &mut Moving<'_>) -> Result<Cost, String> {
    let mut running = Running::new(moving)?;
    let objective = &moving.problem.cost;
    let costs = |list: &Option<Vec<f64>>| list.as_ref().is_some_and(|list| list.iter().any(|&w| w > 0.0));
    let (with_jerk, with_rate) = (costs(&objective.jerk), costs(&objective.torque_rate));
    let ends = divisions(moving).ok_or("the motion cannot be sampled")?;
    let rows = moving.joints_of_polynomials();
    let f = |times: &[f64]| {
        let states = moving.at(times)?;
        let rates = match with_jerk || with_rate {
            true => Some(rates(moving, &rows, times)?),
            false => None,
        };
        states
            .iter()
            .enumerate()
            .map(|(k, state)| {
                let of = |wanted: bool, which: usize| {
                    rates.as_ref().filter(|_| wanted).map(|rates| &rates[which][k][..])
                };
                running.rate(state, of(with_jerk, 0), of(with_rate, 1))
            })
            .collect()
    };
    let ([needed, given, size], _) =
        integral(&ends, TOLERANCE, f).ok_or("the running cost cannot be evaluated")?;
    Ok(Cost { needed, given, size })
}

/// Jerks and rates of torques at these times. Accelerations are cubics between rows, whose derivative is
/// that of the polynomial through four of their values; rates of torques are differences of fourth order.
pub fn rates(moving: &mut Moving<'_>, rows: &[f64], times: &[f64]) -> Option<[Vec<Vec<f64>>; 2]> {
    let part = 1e-3;
    let of = |t: f64| {
        let k = rows.partition_point(|&row| row <= t).clamp(1, rows.len() - 1);
        (rows[k - 1], rows[k])
    };
    let mut around = Vec::with_capacity(8 * times.len());
    for &t in times {
        let (a, b) = of(t);
        let width = b - a;
        around.extend([0.1, 0.35, 0.65, 0.9].map(|x| a + x * width));
        let step = part * width;
        let middle = t.clamp(a + 2.01 * step, b - 2.01 * step);
        around.extend([-2.0, -1.0, 1.0, 2.0].map(|k| middle + k * step));
    }
    let states = moving.at(&around)?;
    let mut found = [Vec::with_capacity(times.len()), Vec::with_capacity(times.len())];
    for (k, &t) in times.iter().enumerate() {
        let own = &states[8 * k..8 * k + 8];
        let (a, b) = of(t);
        let n = own[0].a.len();
        let nodes: [f64; 4] = std::array::from_fn(|j| own[j].t);
        let weights: [f64; 4] = std::array::from_fn(|j| derivative_of_lagrange(&nodes, j, t));
        found[0].push((0..n).map(|i| (0..4).map(|j| weights[j] * own[j].a[i]).sum()).collect());
        let step = part * (b - a);
        let difference = |i: usize| {
            let tau = |j: usize| own[4 + j].needed[i];
            (8.0 * (tau(2) - tau(1)) - (tau(3) - tau(0))) / (12.0 * step)
        };
        found[1].push((0..n).map(difference).collect());
    }
    Some(found)
}

/// The derivative at t of the polynomial that is 1 at node j and 0 at the others.
fn derivative_of_lagrange(nodes: &[f64; 4], j: usize, t: f64) -> f64 {
    let others: Vec<usize> = (0..4).filter(|&k| k != j).collect();
    let below: f64 = others.iter().map(|&k| nodes[j] - nodes[k]).product();
    let above: f64 = others
        .iter()
        .map(|&left_out| others.iter().filter(|&&k| k != left_out).map(|&k| t - nodes[k]).product::<f64>())
        .sum();
    above / below
}
