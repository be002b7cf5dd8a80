//! Limits of joints: those that a motion must keep, and those of the robot that it is only compared with.

use crate::motion::Motion;
use crate::plot::{Limit, NEUTRAL};
use costate::robot::Joint;
use costate_control::{JointLimits, Kept, Method};

/// What is limited.
#[derive(Clone, Copy, PartialEq)]
pub enum Quantity {
    Position,
    Rate,
    Acceleration,
    Jerk,
    /// u, before the gain.
    Control,
    TorqueRate,
    Power,
}

/// Least and largest value, infinite for none.
pub type Range = [f64; 2];

/// No limits.
const FREE: Range = [f64::NEG_INFINITY, f64::INFINITY];

/// The limits that a motion must keep, for each joint. Those of the indirect methods are bounds.
pub fn kept(motion: &Motion<'_>, quantity: Quantity) -> Vec<Range> {
    let problem = motion.problem;
    let both = |limit: f64| [-limit, limit];
    if motion.solution.options.method == Method::Direct {
        let joints = problem.joint_limits().into_iter().zip(&problem.gain);
        return joints
            .map(|(limits, gain)| match quantity {
                Quantity::Position => limits.q,
                Quantity::Rate => both(limits.v),
                Quantity::Acceleration => both(limits.a),
                Quantity::Jerk => both(limits.jerk),
                Quantity::Control if *gain < 0.0 => [limits.torque[1] / gain, limits.torque[0] / gain],
                Quantity::Control => limits.torque.map(|torque| torque / gain),
                Quantity::TorqueRate => both(limits.torque_rate),
                Quantity::Power => both(limits.power),
            })
            .collect();
    }
    let bounds = problem.bounds.as_ref().filter(|_| quantity == Quantity::Control);
    let of = |i: usize| bounds.map_or(FREE, |bounds| [bounds.u_min[i], bounds.u_max[i]]);
    (0..problem.robot.dof()).map(of).collect()
}

/// The limits of the robot that a motion need not keep; a warning says where it exceeds them.
pub fn only_compared(motion: &Motion<'_>, quantity: Quantity) -> Vec<Range> {
    let problem = motion.problem;
    let are_kept = motion.solution.options.method == Method::Direct && problem.keeps_robot_limits();
    if are_kept || problem.limits.from_robot == Some(false) {
        return vec![FREE; problem.robot.dof()];
    }
    let of = |(joint, gain): (&Joint, &f64)| {
        let limits = &joint.limits;
        match quantity {
            Quantity::Position => [limits.lower, limits.upper],
            Quantity::Rate => [-limits.velocity, limits.velocity],
            Quantity::Control => [-limits.effort / gain.abs(), limits.effort / gain.abs()],
            _ => FREE,
        }
    };
    problem.robot.independent_joints().zip(&problem.gain).map(of).collect()
}

/// All limits of a quantity of joints.
pub fn of_joints(motion: &Motion<'_>, quantity: Quantity) -> Vec<Limit> {
    let mut limits = Vec::new();
    for (ranges, is_kept) in [(kept(motion, quantity), true), (only_compared(motion, quantity), false)] {
        for (color, [low, high]) in ranges.into_iter().enumerate() {
            limits.extend(constant(motion, color, false, is_kept, low));
            limits.extend(constant(motion, color, true, is_kept, high));
        }
    }
    if quantity == Quantity::Control && motion.solution.options.method == Method::Direct {
        motors(motion, &mut limits);
    }
    limits
}

/// The limit of the power of all joints together.
pub fn of_total_power(motion: &Motion<'_>) -> Vec<Limit> {
    let total = motion.problem.limits.total_power_max.unwrap_or(f64::INFINITY);
    [(false, -total), (true, total)]
        .into_iter()
        .filter_map(|(is_upper, value)| constant(motion, NEUTRAL, is_upper, true, value))
        .collect()
}

/// The limits of the speed, or of the acceleration, of the tool with this number.
pub fn of_tool(
    motion: &Motion<'_>,
    number: usize,
    matches: impl Fn(usize, &Kept) -> Option<f64>,
) -> Vec<Limit> {
    let keep = motion.problem.task.keep.iter().enumerate();
    let values = keep.filter_map(|(k, keep)| matches(k, &keep.kept));
    values.filter_map(|value| constant(motion, number, true, true, value)).collect()
}

/// A finite limit over the time of the motion.
fn constant(motion: &Motion<'_>, color: usize, is_upper: bool, is_kept: bool, value: f64) -> Option<Limit> {
    let (first, last) = (motion.samples.t.first()?, motion.samples.t.last()?);
    let points = vec![(*first, value), (*last, value)];
    value.is_finite().then_some(Limit { color, is_upper, is_kept, points })
}

/// Replaces the limits of motors by what they can do at the rate that they have.
fn motors(motion: &Motion<'_>, limits: &mut Vec<Limit>) {
    for (color, (joint, &gain)) in motion.problem.joint_limits().iter().zip(&motion.problem.gain).enumerate()
    {
        if !joint.speeds[1].is_finite() {
            continue;
        }
        limits.retain(|limit| limit.color != color || !limit.is_kept);
        for (side, is_upper) in [(0, gain < 0.0), (1, gain > 0.0)] {
            let rows = motion.samples.t.iter().zip(&motion.samples.v);
            let points = rows.map(|(&t, v)| (t, torque_at(joint, side, v[color]) / gain)).collect();
            limits.push(Limit { color, is_upper, is_kept: true, points });
        }
    }
}

/// The torque that a motor has at a rate: less where it drives fast, from the corner speed to the no-load
/// speed.
fn torque_at(limits: &JointLimits, side: usize, v: f64) -> f64 {
    let [corner, no_load] = limits.speeds;
    let driving = if side == 1 { v } else { -v };
    let part = (no_load - driving) / (no_load - corner);
    limits.torque[side] * part.min(1.0)
}
