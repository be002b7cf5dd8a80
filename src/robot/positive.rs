//! Whether the mass matrix of a robot is positive, though the inertia of a link is not, or regular, though a
//! link has none.

use super::armature::Armature;
use super::joint::{Joint, JointKind, Limits};
use super::joint_map;
use super::link::Placement;
use super::warning::Positivity;
use nalgebra::{DMatrix, Vector3};

/// Positions at which M is computed: the one closest to q = 0, and these many more.
const POSITIONS: usize = 7;

/// Robots with more joints are not tried: one M takes n^3 operations.
const MOST_JOINTS: usize = 300;

/// A pivot of M below this part of its diagonal entry is zero but for rounding.
const SINGULAR: f64 = 1e-12;

/// Whether `M = G' (sum_k m_k Jv_k' Jv_k + Jw_k' I_k Jw_k + A) G` has a Cholesky factor at positions spread
/// over the limits, without joints that move nothing; a test of some positions, not a proof for all.
pub(super) fn positivity(joints: &[Joint], armature: &Armature) -> Positivity {
    if joints.len() > MOST_JOINTS {
        Positivity::Untried
    } else if has_pivots_above(0.0, joints, armature) {
        Positivity::WhereTried
    } else {
        Positivity::Violated
    }
}

/// Whether the same M is regular at all of these positions; false where they are not tried.
pub(super) fn is_regular(joints: &[Joint], armature: &Armature) -> bool {
    joints.len() <= MOST_JOINTS && has_pivots_above(SINGULAR, joints, armature)
}

/// Whether all pivots of M exceed this part of their diagonal entries.
fn has_pivots_above(least: f64, joints: &[Joint], armature: &Armature) -> bool {
    let rows = joint_map::rows(joints);
    let g = rows.map(|rows| {
        let n = 1 + rows.iter().map(|row| row.coordinate).max().unwrap_or(0);
        let entry = |i: usize, k: usize| if rows[i].coordinate == k { rows[i].ratio } else { 0.0 };
        (DMatrix::from_fn(joints.len(), n, entry), rows)
    });
    (0..=POSITIONS).all(|number| {
        let mut q: Vec<f64> = (0..joints.len()).map(|i| position(&joints[i], number, i)).collect();
        let independent: Vec<f64> =
            (0..joints.len()).filter(|&i| joints[i].mimic.is_none()).map(|i| q[i]).collect();
        if let Some((_, rows)) = &g {
            let moved = rows.iter().map(|row| row.ratio * independent[row.coordinate] + row.offset);
            q.iter_mut().zip(moved).for_each(|(q, moved)| *q = moved);
        }
        let m = mass_matrix(joints, &q) + armature.matrix();
        let mut m = g.as_ref().map_or_else(|| m.clone(), |(g, _)| g.transpose() * &m * g);
        // The row of a joint that moves nothing is zero: without it M may be positive.
        for k in 0..m.nrows() {
            if m[(k, k)] == 0.0 {
                m[(k, k)] = 1.0;
            }
        }
        let diagonal = m.diagonal();
        m.cholesky().is_some_and(|factor| {
            let pivots = factor.l_dirty().diagonal();
            pivots.iter().zip(&diagonal).all(|(pivot, entry)| pivot * pivot > least * entry)
        })
    })
}

/// A position within the limits, or within +-pi rad, +-1 m where there are none; the one closest to 0 for
/// number 0.
fn position(joint: &Joint, number: usize, index: usize) -> f64 {
    let Limits { lower, upper, .. } = joint.limits;
    if number == 0 {
        return 0.0_f64.clamp(lower, upper);
    }
    // Multiples of the golden ratio are spread evenly over the unit interval.
    let share = ((number * (index + 1)) as f64 * 0.618_033_988_749_895).fract();
    let reach = if joint.kind == JointKind::Revolute { std::f64::consts::PI } else { 1.0 };
    let (lower, upper) = match (lower.is_finite(), upper.is_finite()) {
        (true, true) => (lower, upper),
        (true, false) => (lower, lower + 2.0 * reach),
        (false, true) => (upper - 2.0 * reach, upper),
        (false, false) => (-reach, reach),
    };
    lower + share * (upper - lower)
}

/// M of all joints, without armature, from the Jacobians of all links.
fn mass_matrix(joints: &[Joint], q: &[f64]) -> DMatrix<f64> {
    let n = joints.len();
    let mut m = DMatrix::zeros(n, n);
    let mut poses: Vec<Placement> = Vec::with_capacity(n);
    for (joint, &q) in joints.iter().zip(q) {
        let standing = joint.parent.map_or(joint.placement, |parent| poses[parent].then(&joint.placement));
        poses.push(standing.then(&joint.kind.motion(&joint.axis, q)));
    }
    for (k, joint) in joints.iter().enumerate() {
        let (link, pose) = (&joint.inertia, &poses[k]);
        let centre = pose.rotation * link.com + pose.translation;
        let inertia = pose.rotation * link.inertia * pose.rotation.transpose();
        let path = std::iter::successors(Some(k), |&i| joints[i].parent);
        // Velocity of the centre of mass and angular velocity for unit rates of the joints before it.
        let columns: Vec<(usize, Vector3<f64>, Vector3<f64>)> = path
            .map(|i| {
                let axis = poses[i].rotation * joints[i].axis;
                match joints[i].kind {
                    JointKind::Revolute => (i, axis.cross(&(centre - poses[i].translation)), axis),
                    JointKind::Prismatic => (i, axis, Vector3::zeros()),
                }
            })
            .collect();
        for (i, linear, angular) in &columns {
            let (momentum, spin) = (linear * link.mass, inertia * angular);
            for (j, v, w) in &columns {
                m[(*i, *j)] += momentum.dot(v) + spin.dot(w);
            }
        }
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::KernelOne;
    use crate::robot::{JointSpec, LinkInertia, Robot, RobotBuilder, Tree};
    use nalgebra::Matrix3;

    #[test]
    fn the_mass_matrix_is_that_of_the_kernels() {
        let link =
            LinkInertia::about_com(1.3, [0.1, -0.2, 0.3], Matrix3::from_diagonal(&[0.2, 0.3, 0.4].into()));
        let place = Placement::from_xyz_rpy([0.3, 0.1, -0.2], [0.4, -0.3, 1.2]);
        let robot = Robot::builder("branched")
            .joint(JointSpec::revolute("a").placed(place).axis([1.0, 0.2, 0.0]).carrying(link))
            .joint(JointSpec::prismatic("b").on("a").placed(place).axis([0.0, 1.0, 0.3]).carrying(link))
            .joint(JointSpec::revolute("c").on("b").placed(place).carrying(link))
            .joint(JointSpec::revolute("d").on("a").placed(place).carrying(link))
            .build()
            .unwrap();
        let q = [0.4, -0.7, 1.9, 0.3];
        let mut kernel = KernelOne::<f64>::new(&Tree::from(&robot));
        kernel.set_position(&Tree::from(&robot), &q).unwrap();
        let expected = DMatrix::from_row_slice(4, 4, kernel.mass_matrix().as_slice());
        assert!((mass_matrix(robot.joints(), &q) - expected).amax() < 1e-14);
    }

    /// Slightly negative about z.
    fn slightly() -> Matrix3<f64> {
        Matrix3::from_diagonal(&[0.2, 0.3, -0.002].into())
    }

    fn tried(robot: &Robot) -> Positivity {
        positivity(robot.joints(), &Armature::diagonal(vec![0.0; robot.joints().len()].into_iter()))
    }

    #[test]
    fn a_joint_that_moves_nothing_does_not_make_m_indefinite() {
        let heavy = LinkInertia::about_com(2.0, [0.4, 0.3, 0.0], slightly());
        let with = |spec: JointSpec| {
            Robot::builder("arm")
                .joint(JointSpec::revolute("a").carrying(heavy))
                .joint(spec.on("a"))
                .build()
                .unwrap()
        };
        assert_eq!(tried(&with(JointSpec::revolute("grip"))), Positivity::WhereTried);
        let negative = LinkInertia::about_com(1e-3, [0.0; 3], slightly());
        let spinning = with(JointSpec::revolute("spin").carrying(negative));
        assert_eq!(tried(&spinning), Positivity::Violated, "an axis through the centre");
    }

    #[test]
    fn a_long_chain_is_not_tried() {
        let heavy = LinkInertia::about_com(2.0, [0.4, 0.3, 0.0], slightly());
        let chain = |n: usize| {
            let first = Robot::builder("chain").joint(JointSpec::revolute("0").carrying(heavy));
            let rest = (1..n).map(|i| JointSpec::revolute(i.to_string()).on((i - 1).to_string()));
            rest.fold(first, RobotBuilder::joint).build().unwrap()
        };
        assert_eq!(tried(&chain(MOST_JOINTS + 1)), Positivity::Untried);
        assert_eq!(tried(&chain(3)), Positivity::WhereTried);
    }

    /// A slide at 0 brings the mass onto the axis; its limits keep it away.
    #[test]
    fn positions_outside_the_limits_are_not_tried() {
        let thin = LinkInertia::about_com(1.0, [0.0; 3], slightly());
        let with = |lower: f64| {
            let slide = JointSpec::prismatic("slide").on("a").axis([1.0, 0.0, 0.0]).carrying(thin);
            let limits = Limits { lower, ..Limits::default() };
            let first = JointSpec::revolute("a");
            Robot::builder("arm").joint(first).joint(slide.limits(limits)).build().unwrap()
        };
        assert_eq!(tried(&with(0.1)), Positivity::WhereTried);
        assert_eq!(tried(&with(-1.0)), Positivity::Violated);
    }
}
