//! Frames: poses, Jacobians, second derivatives.

use crate::handle::{Handle, handle};
use crate::numbers::{check_size, read, text, write, write_if};
use crate::robot::{costate_robot, robot_of};
use crate::status::costate_status::COSTATE_ARGUMENT;
use crate::status::{Failure, guarded};
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::Robot;
use std::ffi::{c_char, c_int};
use std::sync::Mutex;

/// A frame of a robot.
pub struct Workspace {
    kinematics: Kinematics<f64>,
    frame: usize,
    axes: ReferenceFrame,
    q: Vec<f64>,
}

/// A frame of a robot. Its six-vectors are (angular, linear); Pinocchio has the linear part first.
pub struct costate_frame(Mutex<Workspace>);

handle!(costate_frame, Workspace);

/// Axes and point of six-vectors, as in Pinocchio.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum costate_axes {
    /// Axes of the world, velocity of the origin of the frame.
    COSTATE_LOCAL_WORLD_ALIGNED = 0,
    /// Axes of the frame, velocity of its origin.
    COSTATE_LOCAL = 1,
    /// Axes of the world, velocity of the point of the body at the origin of the world.
    COSTATE_WORLD = 2,
}

const LOCAL_WORLD_ALIGNED: c_int = costate_axes::COSTATE_LOCAL_WORLD_ALIGNED as c_int;
const LOCAL: c_int = costate_axes::COSTATE_LOCAL as c_int;
const WORLD: c_int = costate_axes::COSTATE_WORLD as c_int;

fn axes_of(number: c_int) -> Result<ReferenceFrame, Failure> {
    match number {
        LOCAL_WORLD_ALIGNED => Ok(ReferenceFrame::LocalWorldAligned),
        LOCAL => Ok(ReferenceFrame::Local),
        WORLD => Ok(ReferenceFrame::World),
        _ => {
            let message = format_args!("axes is {number}; give one of costate_axes");
            Err(Failure::new(COSTATE_ARGUMENT, message))
        }
    }
}

impl Workspace {
    fn new(robot: &Robot, name: &str, axes: c_int) -> Result<Self, Failure> {
        let (frame, axes) = (robot.frame_index(name)?, axes_of(axes)?);
        Ok(Self { kinematics: Kinematics::new(robot), frame, axes, q: vec![0.0; robot.dof()] })
    }

    /// Moves the robot to q.
    ///
    /// # Safety
    /// `q` is null or points to n numbers.
    unsafe fn place(&mut self, n: usize, q: *const f64) -> Result<(), Failure> {
        check_size(self.q.len(), n)?;
        // SAFETY: by the contract of this function.
        unsafe { read("q", q, &mut self.q) }?;
        Ok(self.kinematics.set_position(&self.q)?)
    }
}

/// Makes the frame of this name with a value of costate_axes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_new(
    robot: *const costate_robot,
    name: *const c_char,
    axes: c_int,
    frame: *mut *mut costate_frame,
) -> c_int {
    guarded(|| {
        let new = || {
            // SAFETY: the header asks for a handle and a text.
            let (robot, name) = unsafe { (robot_of(robot)?, text("name", name)?) };
            Workspace::new(&robot, name, axes)
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_frame::give("frame", frame, new()) }
    })
}

/// Deletes a frame.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_delete(frame: *mut costate_frame) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { costate_frame::delete(frame) };
        Ok(())
    });
}

/// Orientation [3 * 3], whose columns are the axes of the frame, and position [3] in the world; either may
/// be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_pose(
    frame: *mut costate_frame,
    n: usize,
    q: *const f64,
    rotation: *mut f64,
    position: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            // SAFETY: the header asks for as many numbers.
            unsafe { of.place(n, q) }?;
            let pose = of.kinematics.pose(of.frame)?;
            // SAFETY: as above.
            unsafe {
                write_if(pose.rotation.as_flattened(), rotation);
                write_if(&pose.position, position);
            }
            Ok(())
        };
        // SAFETY: the header asks for a handle.
        unsafe { costate_frame::with("frame", frame, work) }
    })
}

/// J [6 * n]: twist = J v.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_jacobian(
    frame: *mut costate_frame,
    n: usize,
    q: *const f64,
    jacobian: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            // SAFETY: the header asks for as many numbers.
            unsafe { of.place(n, q) }?;
            let matrix = of.kinematics.jacobian(of.frame, of.axes)?;
            // SAFETY: as above.
            unsafe { write("jacobian", matrix.as_slice(), jacobian) }
        };
        // SAFETY: the header asks for a handle.
        unsafe { costate_frame::with("frame", frame, work) }
    })
}

/// Second derivatives [n * n] of w'x, x the position in the world and w [3].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_position_hessian(
    frame: *mut costate_frame,
    n: usize,
    q: *const f64,
    w: *const f64,
    hessian: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            let mut weights = [0.0; 3];
            // SAFETY: the header asks for as many numbers.
            unsafe {
                of.place(n, q)?;
                read("w", w, &mut weights)?;
            }
            let matrix = of.kinematics.position_hessian(of.frame, &weights)?;
            // SAFETY: as above.
            unsafe { write("hessian", matrix.as_slice(), hessian) }
        };
        // SAFETY: the header asks for a handle.
        unsafe { costate_frame::with("frame", frame, work) }
    })
}
