//! Whether the mass matrix of a robot is positive, though the inertia of a link is not.

use super::armature::Armature;
use super::joint::{Joint, JointKind, Limits};
use super::joint_map;
use super::link::Placement;
use nalgebra::{DMatrix, Vector3};

/// Positions at which M is computed: q = 0 and these many more.
const POSITIONS: usize = 7;

/// Robots with more joints are not tried: one M takes n^3 operations.
const MOST_JOINTS: usize = 300;

/// Whether `M = G' (sum_k m_k Jv_k' Jv_k + Jw_k' I_k Jw_k + A) G` has a Cholesky factor at q = 0 and at
/// positions spread over the limits, without joints that move nothing; a test of some positions, not a proof
/// for all.
pub(super) fn mass_matrix_is_positive(joints: &[Joint], armature: &Armature) -> bool {
    if joints.len() > MOST_JOINTS {
        return false;
    }
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
        m.cholesky().is_some()
    })
}

/// A position within the limits, or +-pi rad, +-1 m; 0 for number 0.
fn position(joint: &Joint, number: usize, index: usize) -> f64 {
    // Multiples of the golden ratio are spread evenly over the unit interval.
    let share = ((number * (index + 1)) as f64 * 0.618_033_988_749_895).fract();
    let reach = if joint.kind == JointKind::Revolute { std::f64::consts::PI } else { 1.0 };
    let Limits { lower, upper, .. } = joint.limits;
    match (lower.is_finite() && upper.is_finite(), number) {
        (_, 0) => 0.0,
        (true, _) => lower + share * (upper - lower),
        (false, _) => (2.0 * share - 1.0) * reach,
    }
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
    use crate::robot::{JointSpec, LinkInertia, Robot, Tree};
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
    #[test]
    fn a_joint_that_moves_nothing_does_not_make_m_indefinite() {
        let slightly = Matrix3::from_diagonal(&[0.2, 0.3, -0.002].into());
        let heavy = LinkInertia::about_com(2.0, [0.4, 0.3, 0.0], slightly);
        let with = |spec: JointSpec| {
            Robot::builder("arm").joint(JointSpec::revolute("a").carrying(heavy)).joint(spec.on("a")).build()
        };
        let robot = with(JointSpec::revolute("grip")).unwrap();
        assert!(mass_matrix_is_positive(robot.joints(), &Armature::diagonal([0.0, 0.0].into_iter())));
        let spinning = JointSpec::revolute("spin").placed(Placement::from_xyz_rpy([0.0; 3], [0.0; 3]));
        let negative = LinkInertia::about_com(1e-3, [0.0; 3], slightly);
        assert!(with(spinning.carrying(negative)).is_err(), "an axis through the centre");
    }
}
