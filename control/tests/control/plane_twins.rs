//! A robot in space whose legs and masses are in one plane, and the planar robot that it is.

use super::gaits::largest_difference;
use costate::robot::{LoadOptions, Robot};
use costate_control::{Problem, Solution};

const ROBOT: &str = "../robots/biped_walker.toml";

/// A step of `robots/biped_walker.toml`, and the same one of the planar robot.
pub(crate) struct Twins {
    pub in_space: Problem,
    pub in_plane: Problem,
    /// Joints of the one in space that the planar one has too.
    stays: Vec<bool>,
}

/// The entries of joints that stay.
fn kept(stays: &[bool], list: &[f64]) -> Vec<f64> {
    list.iter().zip(stays).filter(|(_, stays)| **stays).map(|(entry, _)| *entry).collect()
}

impl Twins {
    /// With both hips at y = 0 and feet on one line; in the plane all that leads out of it is locked.
    pub fn of(problem: &Problem) -> Self {
        let mut flat = std::fs::read_to_string(ROBOT).unwrap();
        for hip in ["[0.0, 0.0835, 0.0]", "[0.0, -0.0835, 0.0]"] {
            assert!(flat.contains(hip), "{hip}");
            flat = flat.replace(hip, "[0.0, 0.0, 0.0]");
        }
        let mut flat = Robot::from_toml_str(&flat, LoadOptions::default()).unwrap();
        let motors: Vec<String> = flat.independent_joints().skip(6).map(|joint| joint.name.clone()).collect();
        for motor in &motors {
            flat = flat.with_joint_armature(motor, 0.1).unwrap();
        }
        let flipped = problem.gait.as_ref().unwrap().flipped.clone();
        let locked: Vec<(&str, f64)> = flipped.iter().map(|joint| (&**joint, 0.0)).collect();
        let planar = flat.lock(&locked).unwrap();
        let stays: Vec<bool> =
            flat.independent_joints().map(|joint| !flipped.contains(&joint.name)).collect();
        let kept = |list: &[f64]| kept(&stays, list);
        let mut in_plane = problem.clone();
        in_plane.robot = planar;
        let gait = in_plane.gait.as_mut().unwrap();
        (gait.width, gait.sole_width) = (0.0, 0.0);
        gait.flipped.clear();
        gait.mirror.retain(|[joint, _]| !flipped.contains(joint));
        (in_plane.start.q, in_plane.start.v) = (kept(&problem.start.q), kept(&problem.start.v));
        in_plane.end = in_plane.start.clone();
        in_plane.cost.effort = kept(&problem.cost.effort);
        in_plane.gain = kept(&problem.gain);
        let limits = &mut in_plane.limits;
        for list in [&mut limits.q_min, &mut limits.q_max, &mut limits.torque_max] {
            *list = list.as_deref().map(kept);
        }
        let mut in_space = problem.clone();
        in_space.robot = flat;
        in_space.gait.as_mut().unwrap().width = 0.0;
        Self { in_space, in_plane, stays }
    }

    /// Whether both motions are the same one, at the same cost.
    pub fn agree(&self, space: &Solution, plane: &Solution) {
        assert!((space.total() / plane.total() - 1.0).abs() < 1e-4, "{} {}", space.total(), plane.total());
        let times: Vec<f64> = (0..=50).map(|k| plane.motion.final_time * f64::from(k) / 50.0).collect();
        let of_space = space.sample_at(&self.in_space, &times).unwrap();
        let of_plane = plane.sample_at(&self.in_plane, &times).unwrap();
        for (q, other) in of_space.q.iter().zip(&of_plane.q) {
            assert!(largest_difference(&kept(&self.stays, q), other) < 1e-2, "{q:?} {other:?}");
            assert!(q.iter().zip(&self.stays).all(|(q, stays)| *stays || q.abs() < 1e-5), "{q:?}");
        }
    }
}
