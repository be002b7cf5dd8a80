//! Robots.

use crate::handle::{Handle, handle};
use crate::numbers::{name, set, text};
use crate::status::costate_status::COSTATE_ARGUMENT;
use crate::status::{Failure, guarded};
use costate::robot::{LoadOptions, Robot, RobotFormat};
use std::ffi::{CString, c_char, c_int, c_uint};
use std::sync::{Arc, Mutex};

/// A robot, with its names as C reads them.
#[derive(Clone)]
pub struct Model {
    /// The robot, which dynamics, steps and frames share.
    pub robot: Arc<Robot>,
    name: CString,
    joints: Vec<CString>,
    frames: Vec<CString>,
}

/// A robot: joints, masses, limits, frames.
///
/// It may be deleted before what was made from it.
pub struct costate_robot(Mutex<Model>);

handle!(costate_robot, Model);

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
pub unsafe fn robot_of(robot: *const costate_robot) -> Result<Arc<Robot>, Failure> {
    // SAFETY: by the contract of this function.
    unsafe { costate_robot::with("robot", robot, |model| Ok(model.robot.clone())) }
}

/// Options of robots, which can be added up.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum costate_load {
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction.
    COSTATE_LOAD_FRICTION = 1,
    /// Refuse what suggests a mistake, such as an inertia that no rigid body has.
    COSTATE_LOAD_STRICT = 2,
}

const FRICTION: c_uint = costate_load::COSTATE_LOAD_FRICTION as c_uint;
const STRICT: c_uint = costate_load::COSTATE_LOAD_STRICT as c_uint;

fn options(bits: c_uint) -> Result<LoadOptions, Failure> {
    if bits & !(FRICTION | STRICT) != 0 {
        let message = format_args!(
            "options is {bits}; add up COSTATE_LOAD_FRICTION and COSTATE_LOAD_STRICT, or give 0"
        );
        return Err(Failure::new(COSTATE_ARGUMENT, message));
    }
    Ok(LoadOptions::default().friction(bits & FRICTION != 0).strict(bits & STRICT != 0))
}

/// Reads a robot from a .urdf or .toml file; options are values of costate_load added up, or 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_from_file(
    path: *const c_char,
    options: c_uint,
    robot: *mut *mut costate_robot,
) -> c_int {
    guarded(|| {
        let read = || {
            // SAFETY: the header asks for a text.
            let path = unsafe { text("path", path) }?;
            Ok(Model::new(Robot::from_file_with(path, self::options(options)?)?))
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_robot::give("robot", robot, read()) }
    })
}

/// Reads a robot from the text of a URDF or of a robot in TOML.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_from_text(
    description: *const c_char,
    options: c_uint,
    robot: *mut *mut costate_robot,
) -> c_int {
    guarded(|| {
        let read = || {
            // SAFETY: the header asks for a text.
            let text = unsafe { text("description", description) }?;
            let format = RobotFormat::of_text(text);
            Ok(Model::new(Robot::read(text.as_bytes(), format, self::options(options)?)?))
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_robot::give("robot", robot, read()) }
    })
}

/// Deletes a robot, and with it the names that were read from it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_delete(robot: *mut costate_robot) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { costate_robot::delete(robot) };
        Ok(())
    });
}

/// Number of joints that mimic no other one: the length of q, v and tau.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_n(robot: *const costate_robot, n: *mut usize) -> c_int {
    // SAFETY: the header asks for a handle and a place for the number.
    guarded(|| unsafe { set("n", n, robot_of(robot)?.dof()) })
}

/// Name of the robot, which lives as long as the handle. So do those of joints and frames.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_name(robot: *const costate_robot, name: *mut *const c_char) -> c_int {
    // SAFETY: the header asks for a handle and a place for the pointer, which it keeps as long as the handle.
    guarded(|| unsafe { costate_robot::with("robot", robot, |model| set("name", name, model.name.as_ptr())) })
}

/// The k-th of some names.
fn pick(names: &[CString], what: &str, k: usize) -> Result<*const c_char, Failure> {
    let found = names.get(k).map(|name| name.as_ptr());
    let missing = || {
        Failure::new(COSTATE_ARGUMENT, format_args!("there is no {what} {k}: the robot has {}", names.len()))
    };
    found.ok_or_else(missing)
}

/// Name of the joint of q[k], k < n.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_joint_name(
    robot: *const costate_robot,
    k: usize,
    name: *mut *const c_char,
) -> c_int {
    guarded(|| {
        // SAFETY: as for `costate_robot_name`.
        unsafe {
            costate_robot::with("robot", robot, |model| set("name", name, pick(&model.joints, "joint", k)?))
        }
    })
}

/// Number of frames.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_frames(robot: *const costate_robot, count: *mut usize) -> c_int {
    // SAFETY: the header asks for a handle and a place for the number.
    guarded(|| unsafe { set("count", count, robot_of(robot)?.frames().len()) })
}

/// Name of a frame, k < count: the world, then those of joints, of links, and added ones.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_robot_frame_name(
    robot: *const costate_robot,
    k: usize,
    name: *mut *const c_char,
) -> c_int {
    guarded(|| {
        // SAFETY: as for `costate_robot_name`.
        unsafe {
            costate_robot::with("robot", robot, |model| set("name", name, pick(&model.frames, "frame", k)?))
        }
    })
}
