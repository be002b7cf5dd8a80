//! Wrenches from outside for any robot.

use costate::robot::{FrameSpec, Placement, Robot, Wrench, WrenchAxes};

/// The same robot with wrenches in all axes, at a frame of its own, at a joint and in the world.
pub fn pulled(robot: &Robot, factor: f64) -> Robot {
    let [first, last] = [0, robot.joints().len() - 1].map(|i| format!("joint:{}", robot.joints()[i].name));
    let place = Placement::from_xyz_rpy([0.1 * factor, 0.2, -0.3], [0.4, -0.5, 0.6]);
    let wrench = |axes| Wrench { moment: [1.0, -factor, 0.5], force: [0.3 * factor, 2.0, -1.0], axes };
    let robot = robot.with_frame(FrameSpec::new("tip").on(&last).placed(place)).unwrap();
    let robot = robot.with_wrench("tip", wrench(WrenchAxes::Local)).unwrap();
    let robot = robot.with_wrench("world", wrench(WrenchAxes::Local)).unwrap();
    let robot = robot.with_wrench(&first, wrench(WrenchAxes::Local)).unwrap();
    robot.with_wrench("tip", wrench(WrenchAxes::Aligned)).unwrap()
}
