//! Wrenches from outside as parameters of a program.

use super::labels::{Labels, turned};
use crate::codegen::record::Expr;
use crate::robot::parameters::Group;
use crate::robot::{AppliedWrench, Placement, Robot, TreeFrame, Wrench};
use nalgebra::{Matrix3, Vector3};

const OF_FRAME: [&str; 3] = ["x", "y", "z"];
const OF_WRENCH: [&str; 6] = ["moment_x", "moment_y", "moment_z", "force_x", "force_y", "force_z"];

/// The frames with wrenches whose translation is a parameter: neither those of joints, where it is zero, nor
/// those of the world, which do not move.
fn placed_frames(robot: &Robot) -> impl Iterator<Item = usize> {
    let of_joints = robot.joints().iter().filter(|joint| !joint.is_inner()).count();
    let is_placed = move |&frame: &usize| frame > of_joints && robot.frames()[frame].joint.is_some();
    let has_wrench = |&frame: &usize| robot.wrenches().iter().any(|applied| applied.frame == frame);
    (0..robot.frames().len()).filter(is_placed).filter(has_wrench)
}

/// The parameters of frames with wrenches, then those of the wrenches.
pub(super) fn groups(robot: &Robot) -> impl Iterator<Item = Group> {
    let of_frame = |frame: usize| {
        let frame = &robot.frames()[frame];
        let translation = frame.placement.translation;
        let entries = OF_FRAME.into_iter().zip(translation.iter().copied()).collect();
        Group { of: format!("frame {}", frame.name), joints: None, entries }
    };
    let of_wrench = |(k, applied): (usize, &AppliedWrench)| {
        let Wrench { moment, force, .. } = applied.wrench;
        let entries = OF_WRENCH.into_iter().zip(moment.into_iter().chain(force)).collect();
        let of = format!("wrench {k} at {}", robot.frames()[applied.frame].name);
        Group { of, joints: None, entries }
    };
    let frames: Vec<Group> = placed_frames(robot).map(of_frame).collect();
    frames.into_iter().chain(robot.wrenches().iter().enumerate().map(of_wrench))
}

/// Frames and wrenches of a tree with labels.
pub(super) struct Acting {
    pub frames: Vec<TreeFrame>,
    pub wrenches: Vec<AppliedWrench>,
}

/// The wrenches with labels of the parameters that follow, at frames with labels.
pub(super) fn labelled(
    robot: &Robot,
    turns: &[Matrix3<f64>],
    next: &mut impl FnMut() -> Expr,
    labels: &mut Labels,
) -> Acting {
    let mut frames: Vec<TreeFrame> = robot
        .frames()
        .iter()
        .map(|frame| {
            let rotation =
                frame.joint.map_or(frame.placement.rotation, |i| turns[i] * frame.placement.rotation);
            TreeFrame { joint: frame.joint, placement: Placement { rotation, translation: Vector3::zeros() } }
        })
        .collect();
    for frame in placed_frames(robot) {
        let TreeFrame { joint, placement } = &mut frames[frame];
        let translation = [0; 3].map(|_| next());
        let turn = joint.map_or(Matrix3::identity(), |i| turns[i]);
        placement.translation = labels.all(turned(&turn, translation)).into();
    }
    let wrenches = robot.wrenches().iter().map(|applied| {
        let [moment, force] = [[0; 3]; 2].map(|of| labels.all(of.map(|_| next())));
        AppliedWrench { wrench: Wrench { moment, force, ..applied.wrench }, ..*applied }
    });
    Acting { wrenches: wrenches.collect(), frames }
}

impl Acting {
    /// The constants that are no parameters: of directions, `world` among them.
    pub fn numbers(&self, world: &Matrix3<f64>) -> Vec<f64> {
        let rotations = self.wrenches.iter().map(|applied| &self.frames[applied.frame].placement.rotation);
        rotations.chain([world]).flat_map(|rotation| rotation.iter().copied()).collect()
    }
}
