//! Hard limits at dense times between the points of the solver.

use crate::clearance::Scene;
use crate::cost::{point, rates};
use crate::moving::{Moving, State};
use costate::kinematics::Kinematics;
use costate_control::{Kept, Problem};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Where a limit is exceeded most, relative to its range.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Excess {
    pub kind: String,
    pub name: String,
    pub t: f64,
    pub value: f64,
    pub limit: f64,
    /// In parts of the distance between lower and upper limit; of one-sided limits of their magnitude, at
    /// least 1. Of tools and clearances in m, rad and parts of the limit.
    pub part: f64,
    /// Whether the solution itself says that limits are exceeded between its points.
    pub reported: bool,
}

/// Places in an interval between two rows, near both ends too: accelerations jump there.
const PLACES: [f64; 14] =
    [1e-7, 0.05, 0.12, 0.2, 0.28, 0.36, 0.44, 0.52, 0.6, 0.68, 0.76, 0.84, 0.92, 1.0 - 1e-7];

/// What converged motions may exceed limits by, relative to their ranges, as `docs/optimize.md` says.
pub const ALLOWED: f64 = 1e-4;

/// How a motion exceeds its limits.
#[derive(Clone, Debug, Default)]
pub struct Excesses {
    /// The worst excess of each kind beyond [`ALLOWED`], and of torques before they are cut (kind `torque
    /// cut`).
    pub worst: Vec<Excess>,
    /// Means over time of all excesses of each kind, relative to their ranges.
    pub means: BTreeMap<String, f64>,
}

/// Measures all limits. `Err` says what is not measured.
pub fn excesses(moving: &mut Moving<'_>) -> Result<Excesses, String> {
    let problem = moving.problem;
    if !problem.robot.free_joints().is_empty() {
        return Err("limits of floating joints".into());
    }
    let reported = moving.solution.limits.violations_between().next().is_some();
    let mut worst = Worst { found: Excesses::default(), reported, weight: 0.0 };
    let rows = moving.joints_of_polynomials();
    let times: Vec<f64> =
        rows.windows(2).flat_map(|pair| PLACES.map(|x| pair[0] + x * (pair[1] - pair[0]))).collect();
    let states = moving.at(&times).ok_or("the motion cannot be sampled")?;
    let length = (moving.end() - moving.start()) * PLACES.len() as f64;
    let weights: Vec<f64> = rows.windows(2).map(|pair| (pair[1] - pair[0]) / length).collect();
    let limits = problem.joint_limits();
    let names: Vec<String> = problem.robot.independent_joints().map(|joint| joint.name.clone()).collect();
    let needs_rates = limits.iter().any(|limit| limit.jerk.is_finite() || limit.torque_rate.is_finite());
    let found = match needs_rates {
        true => Some(rates(moving, &rows, &times).ok_or("rates cannot be evaluated")?),
        false => None,
    };
    for (k, state) in states.iter().enumerate() {
        let t = state.t;
        worst.weight = weights[k / PLACES.len()];
        let mut power = 0.0;
        for (i, (limit, name)) in limits.iter().zip(&names).enumerate() {
            let both = |most: f64| [-most, most];
            worst.take("position", name, t, state.q[i], limit.q);
            worst.take("rate", name, t, state.v[i], both(limit.v));
            worst.take("acceleration", name, t, state.a[i], both(limit.a));
            if limit.torque[0] < limit.torque[1] {
                worst.take("torque cut", name, t, state.needed[i], limit.torque);
            }
            let p = state.given[i] * state.v[i];
            power += p;
            worst.take("power", name, t, p, both(limit.power));
            if let Some([jerk, torque_rate]) = &found {
                worst.take("jerk", name, t, jerk[k][i], both(limit.jerk));
                worst.take("torque rate", name, t, torque_rate[k][i], both(limit.torque_rate));
            }
            let [corner, none] = limit.speeds;
            if none.is_finite() && limit.torque[1].is_finite() {
                let most = limit.torque[1] * ((none - state.v[i].abs()) / (none - corner)).clamp(0.0, 1.0);
                let driving = state.given[i] * state.v[i].signum();
                if driving > most {
                    let part = (driving - most) / (2.0 * limit.torque[1]);
                    worst.part("motor", name, t, driving, most, part);
                }
            }
        }
        if let Some(most) = problem.limits.total_power_max {
            worst.take("power", "all joints", t, power, [-most, most]);
        }
    }
    tasks(moving, &states, &weights, &mut worst)?;
    Ok(worst.found)
}

/// Tools and clearances.
fn tasks(moving: &Moving<'_>, states: &[State], weights: &[f64], worst: &mut Worst) -> Result<(), String> {
    let problem = moving.problem;
    let scene = Scene::new(problem)?;
    if scene.is_none() && problem.task.keep.is_empty() {
        return Ok(());
    }
    let mut kinematics: Vec<Kinematics<f64>> = moving.robots.iter().map(Kinematics::new).collect();
    for (k, state) in states.iter().enumerate() {
        worst.weight = weights[k / PLACES.len()];
        let kinematics = &mut kinematics[state.phase];
        kinematics.set_position(&state.q).map_err(|error| error.to_string())?;
        if let Some((distance, name)) = scene.as_ref().and_then(|scene| scene.least(problem, kinematics))
            && distance < 0.0
        {
            worst.part("clearance", &name, state.t, distance, 0.0, -distance);
        }
        keeps(problem, kinematics, state, worst)?;
    }
    Ok(())
}

fn keeps(
    problem: &Problem,
    kinematics: &Kinematics<f64>,
    state: &State,
    worst: &mut Worst,
) -> Result<(), String> {
    for keep in &problem.task.keep {
        let frame = problem.robot.frame_index(&keep.tool.frame).map_err(|error| error.to_string())?;
        let x = point(kinematics, frame, keep.tool.offset).ok_or("no pose")?;
        let pose = kinematics.pose(frame).map_err(|error| error.to_string())?;
        match &keep.kept {
            Kept::Plane { through, normal, distance } => {
                let length = norm(*normal);
                let above = (0..3).map(|k| (x[k] - through[k]) * normal[k]).sum::<f64>() / length;
                worst.part("tool", "plane", state.t, above.abs(), *distance, above.abs() - distance);
            }
            Kept::Box { min, max } => {
                for k in 0..3 {
                    let beyond = (min[k] - x[k]).max(x[k] - max[k]);
                    worst.part("tool", "box", state.t, x[k], max[k], beyond);
                }
            }
            Kept::Axis { axis, along, angle } => {
                let world: [f64; 3] =
                    std::array::from_fn(|k| (0..3).map(|j| pose.rotation[k][j] * axis[j]).sum());
                let cross = [
                    world[1] * along[2] - world[2] * along[1],
                    world[2] * along[0] - world[0] * along[2],
                    world[0] * along[1] - world[1] * along[0],
                ];
                let turned = norm(cross).atan2((0..3).map(|k| world[k] * along[k]).sum());
                worst.part("tool", "axis", state.t, turned, *angle, turned - angle);
            }
            _ => return Err("what a tool keeps".into()),
        }
    }
    Ok(())
}

fn norm(x: [f64; 3]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

struct Worst {
    found: Excesses,
    reported: bool,
    /// The part of the motion that the present time stands for.
    weight: f64,
}

impl Worst {
    fn take(&mut self, kind: &str, name: &str, t: f64, value: f64, [lower, upper]: [f64; 2]) {
        let range = match (lower.is_finite(), upper.is_finite()) {
            (true, true) => upper - lower,
            (true, false) => lower.abs().max(1.0),
            (false, true) => upper.abs().max(1.0),
            (false, false) => return,
        };
        let (excess, limit) = match value > upper {
            true => (value - upper, upper),
            false => (lower - value, lower),
        };
        if range > 0.0 {
            self.part(kind, name, t, value, limit, excess / range);
        }
    }

    fn part(&mut self, kind: &str, name: &str, t: f64, value: f64, limit: f64, part: f64) {
        if part > 0.0 {
            *self.found.means.entry(kind.into()).or_default() += self.weight * part;
        }
        if part.is_nan() || part <= ALLOWED {
            return;
        }
        let excess =
            Excess { kind: kind.into(), name: name.into(), t, value, limit, part, reported: self.reported };
        match self.found.worst.iter_mut().find(|found| found.kind == kind) {
            Some(found) if found.part >= part => {}
            Some(found) => *found = excess,
            None => self.found.worst.push(excess),
        }
    }
}
