//! The lengths up to which machine code pays.

use costate::codegen::Quantity;
use costate::robot::Robot;

/// Default limit of steps for one state of a robot without branches: longer straight-line code is slower than
/// the loops of the generic code, see docs/jit.md.
pub const DEFAULT_LIMIT: usize = 18_000;

/// Default limit of steps for four states at once, which do four times the work with the code that is read.
pub const LANES_LIMIT: usize = 100_000;

/// Part of the limit that holds for quantities without derivatives: the generic code computes them in O(n).
const OF_VALUES: usize = 3;

/// Most that branches raise the limit by: the memory of a recording is in proportion.
const MOST_BRANCHED: usize = 4;

/// Default limit of steps for one state of a robot: [`DEFAULT_LIMIT`] n (n + 1) / (2 c), at most four times
/// the first factor.
///
/// c is the number of pairs of joints of which one carries the other, or is the other: n (n + 1) / 2 for a
/// chain. Each of them is an entry of M that is not always 0, so the generic code takes about as much time
/// for a long program of a robot with many branches as for a shorter one of a chain with fewer joints. Joints
/// that mimic others count too.
pub fn limit_of(robot: &Robot) -> usize {
    let mut depths: Vec<usize> = Vec::new();
    for joint in robot.joints() {
        depths.push(1 + joint.parent.map_or(0, |parent| depths[parent]));
    }
    let (n, pairs) = (depths.len(), depths.iter().sum::<usize>().max(1));
    (DEFAULT_LIMIT * n * (n + 1) / (2 * pairs)).clamp(DEFAULT_LIMIT, MOST_BRANCHED * DEFAULT_LIMIT)
}

/// [`limit_of`] for one quantity: a third of it for those without derivatives, such as F and inverse
/// dynamics.
pub(crate) fn limit_for(robot: &Robot, quantity: Quantity) -> usize {
    match quantity {
        Quantity::F | Quantity::InverseDynamics | Quantity::MassMatrix | Quantity::Energy => {
            limit_of(robot) / OF_VALUES
        }
        _ => limit_of(robot),
    }
}

#[cfg(test)]
mod tests {
    use super::{DEFAULT_LIMIT, limit_of};
    use costate::robot::{JointSpec, LinkInertia, Robot};

    /// Branches of these lengths on one joint.
    fn star(branches: &[usize]) -> Robot {
        let joint = |name: String, on: &str| {
            JointSpec::revolute(name).on(on).carrying(LinkInertia::point(1.0, [0.1, 0.0, 0.0]))
        };
        let mut robot = Robot::builder("star").joint(JointSpec::revolute("root"));
        for (b, &length) in branches.iter().enumerate() {
            let mut on = String::from("root");
            for k in 0..length {
                let name = format!("{b}_{k}");
                robot = robot.joint(joint(name.clone(), &on));
                on = name;
            }
        }
        robot.build().unwrap()
    }

    #[test]
    fn branches_raise_the_limit() {
        assert_eq!(limit_of(&star(&[7])), DEFAULT_LIMIT);
        // 1 + 4 (2 + 3 + 4) = 37 of 91 pairs.
        assert_eq!(limit_of(&star(&[3; 4])), DEFAULT_LIMIT * 91 / 37);
        assert_eq!(limit_of(&star(&[1; 40])), 4 * DEFAULT_LIMIT);
    }
}
