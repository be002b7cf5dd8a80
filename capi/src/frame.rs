//! Frames: poses, Jacobians, second derivatives.

use crate::handle::Handle;
use crate::numbers::{check_size, read, text, write, write_if};
use crate::robot::{CostateRobot, robot_of};
use crate::status::{Failure, Status, guarded};
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::Robot;
use std::ffi::{c_char, c_int};

/// A frame of a robot.
pub struct Workspace {
    kinematics: Kinematics<f64>,
    frame: usize,
    axes: ReferenceFrame,
    q: Vec<f64>,
}

pub type CostateFrame = Handle<Workspace>;

fn axes_of(number: c_int) -> Result<ReferenceFrame, Failure> {
    match number {
        0 => Ok(ReferenceFrame::LocalWorldAligned),
        1 => Ok(ReferenceFrame::Local),
        2 => Ok(ReferenceFrame::World),
        _ => {
            let message = format_args!("axes is {number}; give one of enum costate_axes");
            Err(Failure::new(Status::Argument, message))
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

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_new(
    robot: *const CostateRobot,
    name: *const c_char,
    axes: c_int,
    frame: *mut *mut CostateFrame,
) -> c_int {
    guarded(|| {
        let new = || {
            // SAFETY: the header asks for a handle and a text.
            let (robot, name) = unsafe { (robot_of(robot)?, text("name", name)?) };
            Workspace::new(&robot, name, axes)
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { CostateFrame::give("frame", frame, new()) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_delete(frame: *mut CostateFrame) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { CostateFrame::delete(frame) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_pose(
    frame: *mut CostateFrame,
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
        unsafe { CostateFrame::with("frame", frame, work) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_jacobian(
    frame: *mut CostateFrame,
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
        unsafe { CostateFrame::with("frame", frame, work) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_frame_position_hessian(
    frame: *mut CostateFrame,
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
        unsafe { CostateFrame::with("frame", frame, work) }
    })
}
