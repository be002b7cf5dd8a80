//! Limits of joints: those that a motion must keep, and those of the robot that it is only compared with.

use super::motion::Motion;
use super::numbers::short;
use super::plot::{Curve, Look, NEUTRAL};
use costate::robot::Joint;
use costate_control::Method;

/// What is limited.
#[derive(Clone, Copy, PartialEq)]
pub enum Quantity {
    Position,
    Rate,
    Acceleration,
    /// u, before the gain.
    Control,
}

/// Least and largest value, infinite for none.
pub type Range = [f64; 2];

/// No limits.
const FREE: Range = [f64::NEG_INFINITY, f64::INFINITY];

/// The limits that a motion must keep, for each joint. Those of the indirect methods are bounds.
pub fn kept(motion: &Motion<'_>, quantity: Quantity) -> Vec<Range> {
    let problem = motion.problem;
    if motion.solution.options.method == Method::Direct {
        let joints = problem.joint_limits().into_iter().zip(&problem.gain);
        return joints
            .map(|(limits, gain)| match quantity {
                Quantity::Position => limits.q,
                Quantity::Rate => [-limits.v, limits.v],
                Quantity::Acceleration => [-limits.a, limits.a],
                Quantity::Control if *gain < 0.0 => [limits.torque[1] / gain, limits.torque[0] / gain],
                Quantity::Control => limits.torque.map(|torque| torque / gain),
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
            Quantity::Acceleration => FREE,
            Quantity::Control => [-limits.effort / gain.abs(), limits.effort / gain.abs()],
        }
    };
    problem.robot.independent_joints().zip(&problem.gain).map(of).collect()
}

/// The limits of joints beside their curves: those that are within half of the size of the curve from it, so
/// that it stays legible. A limit that several joints have is drawn once.
pub fn levels(motion: &Motion<'_>, quantity: Quantity, curves: &[Curve]) -> Vec<Curve> {
    let mut levels: Vec<(Curve, f64)> = Vec::new();
    for (ranges, look) in
        [(kept(motion, quantity), Look::Kept), (only_compared(motion, quantity), Look::Compared)]
    {
        for curve in curves {
            let Some(range) = ranges.get(curve.color) else { continue };
            for value in range.iter().copied().filter(|&value| is_near(value, curve)) {
                match levels.iter_mut().find(|(level, other)| *other == value && level.look == look) {
                    Some((level, _)) => {
                        level.color = NEUTRAL;
                        level.name = format!("{}, {}", level.name, curve.name);
                    }
                    None => levels.push((level(curve, value, look), value)),
                }
            }
        }
    }
    levels.into_iter().map(|(level, _)| level).collect()
}

/// Whether a limit is finite and close to a curve, or between its points.
fn is_near(value: f64, curve: &Curve) -> bool {
    let values = curve.points.iter().map(|point| point.1).filter(|value| value.is_finite());
    let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    let room = 0.5 * (high - low);
    value.is_finite() && low <= high && (low - room..=high + room).contains(&value)
}

/// A level line from the first to the last time of a curve.
fn level(curve: &Curve, value: f64, look: Look) -> Curve {
    let ends = [curve.points.first(), curve.points.last()];
    let what = if look == Look::Kept { "limit" } else { "limit of the robot, only compared," };
    Curve {
        name: format!("{what} {} of {}", short(value, 6), curve.name),
        color: curve.color,
        points: ends.into_iter().flatten().map(|&(t, _)| (t, value)).collect(),
        look,
    }
}

#[cfg(test)]
mod tests {
    use super::{Curve, Look, is_near};

    #[test]
    fn limits_far_from_a_curve_would_flatten_it() {
        let points = vec![(0.0, 1.0), (1.0, 3.0)];
        let curve = Curve { name: "q".into(), color: 0, points, look: Look::Smooth };
        let near = [-0.1, 0.0, 2.0, 4.0, 4.1, f64::INFINITY, f64::NAN].map(|value| is_near(value, &curve));
        assert_eq!(near, [false, true, true, true, false, false, false]);
    }
}
