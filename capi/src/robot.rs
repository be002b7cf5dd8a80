//! Robots.

use crate::handle::Handle;
use crate::numbers::{name, set, text};
use crate::status::{Failure, Status, guarded};
use costate::robot::{LoadOptions, Robot, RobotFormat};
use std::ffi::{CString, c_char, c_int, c_uint};
use std::sync::Arc;

/// A robot, with its names as C reads them.
#[derive(Clone)]
pub struct Model {
    pub robot: Arc<Robot>,
    name: CString,
    joints: Vec<CString>,
    frames: Vec<CString>,
}

pub type CostateRobot = Handle<Model>;

impl Model {
    fn new(robot: Robot) -> Self {
        Self {
            name: name(robot.name()),
            joints: robot.independent_joints().map(|joint| name(&joint.name)).collect(),
            frames: robot.frames().iter().map(|frame| name(&frame.name)).collect(),
            robot: Arc::new(robot),
        }
    }
}

/// The robot of a handle.
///
/// # Safety
/// `robot` is null or a handle.
pub unsafe fn robot_of(robot: *const CostateRobot) -> Result<Arc<Robot>, Failure> {
    // SAFETY: by the contract of this function.
    unsafe { CostateRobot::with("robot", robot, |model| Ok(model.robot.clone())) }
}

/// Bits of `options`.
const FRICTION: c_uint = 1;
const STRICT: c_uint = 2;

fn options(bits: c_uint) -> Result<LoadOptions, Failure> {
    if bits & !(FRICTION | STRICT) != 0 {
        let message = format_args!(
            "options is {bits}; add up COSTATE_LOAD_FRICTION and COSTATE_LOAD_STRICT, or give 0"
        );
        return Err(Failure::new(Status::Argument, message));
    }
    Ok(LoadOptions::default().friction(bits & FRICTION != 0).strict(bits & STRICT != 0))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_from_file(
    path: *const c_char,
    options: c_uint,
    robot: *mut *mut CostateRobot,
) -> c_int {
    guarded(|| {
        let read = || {
            // SAFETY: the header asks for a text.
            let path = unsafe { text("path", path) }?;
            Ok(Model::new(Robot::from_file_with(path, self::options(options)?)?))
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { CostateRobot::give("robot", robot, read()) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_from_text(
    description: *const c_char,
    options: c_uint,
    robot: *mut *mut CostateRobot,
) -> c_int {
    guarded(|| {
        let read = || {
            // SAFETY: the header asks for a text.
            let text = unsafe { text("description", description) }?;
            let format = RobotFormat::of_text(text);
            Ok(Model::new(Robot::read(text.as_bytes(), format, self::options(options)?)?))
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { CostateRobot::give("robot", robot, read()) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_delete(robot: *mut CostateRobot) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { CostateRobot::delete(robot) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_n(robot: *const CostateRobot, n: *mut usize) -> c_int {
    // SAFETY: the header asks for a handle and a place for the number.
    guarded(|| unsafe { set("n", n, robot_of(robot)?.dof()) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_name(robot: *const CostateRobot, name: *mut *const c_char) -> c_int {
    // SAFETY: the header asks for a handle and a place for the pointer, which it keeps as long as the handle.
    guarded(|| unsafe { CostateRobot::with("robot", robot, |model| set("name", name, model.name.as_ptr())) })
}

/// The k-th of some names.
fn pick(names: &[CString], what: &str, k: usize) -> Result<*const c_char, Failure> {
    let found = names.get(k).map(|name| name.as_ptr());
    let missing = || {
        Failure::new(Status::Argument, format_args!("there is no {what} {k}: the robot has {}", names.len()))
    };
    found.ok_or_else(missing)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_joint_name(
    robot: *const CostateRobot,
    k: usize,
    name: *mut *const c_char,
) -> c_int {
    guarded(|| {
        // SAFETY: as for `costate_robot_name`.
        unsafe {
            CostateRobot::with("robot", robot, |model| set("name", name, pick(&model.joints, "joint", k)?))
        }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_frames(robot: *const CostateRobot, count: *mut usize) -> c_int {
    // SAFETY: the header asks for a handle and a place for the number.
    guarded(|| unsafe { set("count", count, robot_of(robot)?.frames().len()) })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_frame_name(
    robot: *const CostateRobot,
    k: usize,
    name: *mut *const c_char,
) -> c_int {
    guarded(|| {
        // SAFETY: as for `costate_robot_name`.
        unsafe {
            CostateRobot::with("robot", robot, |model| set("name", name, pick(&model.frames, "frame", k)?))
        }
    })
}
