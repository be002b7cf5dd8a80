//! The gains of the optimal feedback and derivatives by limits: what `--feedback` writes.

use costate_control::{
    Feedback, MotionDerivative, MotionParameter, Problem, Resolve, ResolveError, ResolveStatus, Solution,
};
use serde::Serialize;
use std::error::Error;

/// Equal intervals.
const INTERVALS: usize = 60;

/// Rows of a matrix.
type Rows = Vec<Vec<f64>>;

/// The file.
#[derive(Serialize)]
struct Written<'a> {
    /// Version of the format, which stays when keys are added.
    format: u32,
    robot: &'a str,
    joints: &'a [String],
    /// T (s).
    final_time: f64,
    /// Times of the rows (s).
    t: Vec<f64>,
    q: Rows,
    v: Rows,
    tau: Rows,
    /// dtau/dq and dtau/dv, n x n at each time.
    gain_q: Vec<Rows>,
    gain_v: Vec<Rows>,
    /// Derivatives of cost and T by the state at the start, (q, v).
    cost_by_start: &'a [f64],
    final_time_by_start: &'a [f64],
    derivatives: Derivatives,
}

/// How the motion changes with its limits.
#[derive(Serialize)]
struct Derivatives {
    /// Times of the rows (s): the points of the motion.
    t: Vec<f64>,
    parameters: Vec<Derivative>,
}

#[derive(Serialize)]
struct Derivative {
    name: &'static str,
    joint: String,
    cost: f64,
    final_time: f64,
    /// At the same part of the time.
    q: Rows,
    v: Rows,
    tau: Rows,
}

/// The text of the file: gains at this rate (Hz) and at T, or at the points of the motion.
///
/// # Errors
/// A problem that the feedback is not computed for, a motion that is not solved or no strict minimum.
pub fn feedback(problem: &Problem, solution: &Solution, rate: Option<f64>) -> Result<String, Box<dyn Error>> {
    let fault = |error: &dyn std::fmt::Display| -> Box<dyn Error> { format!("--feedback: {error}").into() };
    if solution.trajectory.t.len() < 2 {
        return Err(fault(&"there is no motion to feed back to"));
    }
    let mut motion = solved(problem, solution).map_err(|error| fault(&error))?;
    let Some(feedback) = motion.feedback().map_err(|error| fault(&error))?.cloned() else {
        return Err(fault(&"the motion is no strict minimum, so that there is no feedback"));
    };
    let n = feedback.dof();
    let time = motion.final_time().unwrap_or(0.0);
    let points: Vec<f64> = (0..feedback.points()).map(|p| feedback.time(p)).collect();
    let t = match rate {
        Some(rate) => {
            let count = (time * rate * (1.0 - 1e-12)).floor() as usize;
            (0..=count).map(|k| k as f64 / rate).chain([time]).collect()
        }
        None => points.clone(),
    };
    let mut written = Written {
        format: 1,
        robot: &solution.robot.robot,
        joints: &solution.robot.joints,
        final_time: time,
        q: Vec::new(),
        v: Vec::new(),
        tau: Vec::new(),
        gain_q: Vec::new(),
        gain_v: Vec::new(),
        cost_by_start: feedback.cost_gradient(),
        final_time_by_start: feedback.time_by_start(),
        derivatives: Derivatives { t: points, parameters: parameters(problem, &mut motion)? },
        t,
    };
    let (mut z, mut torques, mut gain) = (vec![0.0; 3 * n], vec![0.0; n], vec![0.0; 2 * n * n]);
    for &t in &written.t {
        motion.state_at(t, &mut z)?;
        motion.torques_at(t, &mut torques)?;
        if !gain_at(&feedback, t, &mut gain) {
            return Err(fault(
                &"something is free at the start, so that states on the way do not tell the start",
            ));
        }
        written.q.push(z[..n].to_vec());
        written.v.push(z[n..2 * n].to_vec());
        written.tau.push(torques.clone());
        let half =
            |first: usize| gain.chunks_exact(2 * n).map(|row| row[first..first + n].to_vec()).collect();
        written.gain_q.push(half(0));
        written.gain_v.push(half(n));
    }
    Ok(serde_json::to_string(&written)?)
}

/// The motion solved again on its mesh; where that has no end on equal intervals.
fn solved(problem: &Problem, solution: &Solution) -> Result<Resolve, Box<dyn Error>> {
    let options = solution.options.clone();
    let mut near = Resolve::near(problem, options.clone(), &solution.trajectory)?;
    if near.solve()?.status == ResolveStatus::Solved {
        return Ok(near);
    }
    let limits = problem.limits.clone().with_from_robot(problem.keeps_robot_limits());
    let nodes = options.nodes.max(3 * INTERVALS + 1);
    let mut even = Resolve::new(&problem.clone().with_limits(limits), options.with_nodes(nodes))?;
    match even.solve()?.status {
        ResolveStatus::Solved => Ok(even),
        _ => Err("the motion is not solved on a mesh of its own; try another tolerance or more nodes".into()),
    }
}

/// K(t); false where there is none.
fn gain_at(feedback: &Feedback, t: f64, gain: &mut [f64]) -> bool {
    feedback.gain(t, gain) && gain.iter().all(|entry| entry.is_finite())
}

/// Derivatives by all limits that the joints have.
fn parameters(problem: &Problem, motion: &mut Resolve) -> Result<Vec<Derivative>, Box<dyn Error>> {
    type Limit = (&'static str, fn(usize) -> MotionParameter);
    const LIMITS: [Limit; 6] = [
        ("limits.q_min", MotionParameter::PositionMin),
        ("limits.q_max", MotionParameter::PositionMax),
        ("limits.v_max", MotionParameter::VelocityMax),
        ("limits.a_max", MotionParameter::AccelerationMax),
        ("limits.torque_max", MotionParameter::TorqueMax),
        ("limits.power_max", MotionParameter::PowerMax),
    ];
    let names = problem.robot.independent_joints().map(|joint| joint.name.clone());
    let mut all = Vec::new();
    for (joint, name) in names.enumerate() {
        for (limit, parameter) in LIMITS {
            let MotionDerivative { cost, final_time, states, torques, .. } =
                match motion.derivative_by(&parameter(joint)) {
                    Ok(Some(found)) => found,
                    Ok(None) | Err(ResolveError::NoLimit { .. }) => continue,
                    Err(error) => return Err(format!("--feedback: {error}").into()),
                };
            let n = motion.dof();
            let rows =
                |first: usize| states.chunks_exact(2 * n).map(|x| x[first..first + n].to_vec()).collect();
            all.push(Derivative {
                name: limit,
                joint: name.clone(),
                cost,
                final_time,
                q: rows(0),
                v: rows(n),
                tau: torques.chunks_exact(n).map(<[f64]>::to_vec).collect(),
            });
        }
    }
    Ok(all)
}
