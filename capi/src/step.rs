//! Time steps.

use crate::dynamics::{coordinates_of, read_all};
use crate::handle::Handle;
use crate::numbers::{check_size, write, write_if};
use crate::robot::{CostateRobot, robot_of};
use crate::status::{Failure, Status, guarded};
use costate::robot::Robot;
use costate::step::{ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step, StepError, StoermerVerlet};
use costate::{Coordinates, EvalError};
use costate_jit::{JitModel, JitVelocityModel};
use std::ffi::c_int;
use std::sync::Arc;

type AnyStep = Box<dyn Step<f64, Error = StepError<EvalError>> + Send>;

/// A step of any scheme, with the arguments and results of a call.
pub struct Workspace {
    n: usize,
    step: AnyStep,
    inputs: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
}

pub type CostateStep = Handle<Workspace>;

fn scheme(number: c_int, robot: &Robot, coordinates: Coordinates) -> Result<AnyStep, Failure> {
    let needs = |needed, letters, scheme| {
        if coordinates == needed {
            return Ok(());
        }
        Err(Failure::new(Status::Argument, format_args!("{scheme} needs {letters}")))
    };
    let model = || JitModel::new(robot, coordinates);
    Ok(match number {
        0 => Box::new(RungeKutta4::new(model()?)),
        1 => Box::new(ImplicitMidpoint::new(model()?)),
        2 => {
            needs(Coordinates::Hamiltonian, "COSTATE_QP", "COSTATE_VERLET")?;
            Box::new(StoermerVerlet::new(model()?))
        }
        3 => {
            needs(Coordinates::Lagrangian, "COSTATE_QV", "COSTATE_SEMI_IMPLICIT_EULER")?;
            Box::new(SemiImplicitEuler::new(JitVelocityModel::new(robot)?))
        }
        _ => {
            let message = format_args!("scheme is {number}; give one of enum costate_scheme");
            return Err(Failure::new(Status::Argument, message));
        }
    })
}

impl Workspace {
    fn new(robot: &Robot, coordinates: c_int, number: c_int) -> Result<Self, Failure> {
        let (n, coordinates) = (robot.dof(), coordinates_of(coordinates)?);
        let step = scheme(number, robot, coordinates)?;
        let (inputs, jacobian, hessian) = (vec![0.0; 5 * n], vec![0.0; 6 * n * n], vec![0.0; 9 * n * n]);
        Ok(Self { n, step, inputs, jacobian, hessian })
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_new(
    robot: *const CostateRobot,
    coordinates: c_int,
    scheme: c_int,
    step: *mut *mut CostateStep,
) -> c_int {
    guarded(|| {
        let new = || {
            // SAFETY: the header asks for a handle.
            let robot: Arc<Robot> = unsafe { robot_of(robot) }?;
            Workspace::new(&robot, coordinates, scheme)
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { CostateStep::give("step", step, new()) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_delete(step: *mut CostateStep) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { CostateStep::delete(step) };
        Ok(())
    });
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_f(
    step: *mut CostateStep,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    dt: f64,
    next: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            check_size(of.n, n)?;
            // SAFETY: the header asks for as many numbers.
            unsafe { read_all(&[("q", q, n), ("v", v, n), ("tau", tau, n)], &mut of.inputs) }?;
            let (x, rest) = of.inputs.split_at(2 * n);
            // SAFETY: as above.
            unsafe { write("next", of.step.evaluate(x, &rest[..n], dt)?, next) }
        };
        // SAFETY: the header asks for a handle.
        unsafe { CostateStep::with("step", step, work) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_jacobian(
    step: *mut CostateStep,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    dt: f64,
    next: *mut f64,
    jacobian: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            check_size(of.n, n)?;
            // SAFETY: the header asks for as many numbers.
            unsafe { read_all(&[("q", q, n), ("v", v, n), ("tau", tau, n)], &mut of.inputs) }?;
            let (x, rest) = of.inputs.split_at(2 * n);
            let first = of.step.linearise(x, &rest[..n], dt)?;
            first.jacobian(&mut of.jacobian);
            // SAFETY: as above.
            unsafe {
                write("jacobian", &of.jacobian, jacobian)?;
                write_if(first.next, next);
            }
            Ok(())
        };
        // SAFETY: the header asks for a handle.
        unsafe { CostateStep::with("step", step, work) }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_contract(
    step: *mut CostateStep,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    dt: f64,
    y: *const f64,
    next: *mut f64,
    jacobian: *mut f64,
    hessian: *mut f64,
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            check_size(of.n, n)?;
            let arguments = [("q", q, n), ("v", v, n), ("tau", tau, n), ("y", y, 2 * n)];
            // SAFETY: the header asks for as many numbers.
            unsafe { read_all(&arguments, &mut of.inputs) }?;
            let (x, rest) = of.inputs.split_at(2 * n);
            let (tau, y) = rest.split_at(n);
            let second = of.step.contract(x, tau, dt, y)?;
            second.hessian(&mut of.hessian);
            second.first.jacobian(&mut of.jacobian);
            // SAFETY: as above.
            unsafe {
                write("hessian", &of.hessian, hessian)?;
                write_if(&of.jacobian, jacobian);
                write_if(second.first.next, next);
            }
            Ok(())
        };
        // SAFETY: the header asks for a handle.
        unsafe { CostateStep::with("step", step, work) }
    })
}
