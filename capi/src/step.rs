//! Time steps.

use crate::dynamics::{coordinates_of, read_all};
use crate::handle::{Handle, handle};
use crate::numbers::{check_size, write, write_if};
use crate::robot::{costate_robot, robot_of};
use crate::status::costate_status::COSTATE_ARGUMENT;
use crate::status::{Failure, guarded};
use costate::robot::Robot;
use costate::step::{ImplicitMidpoint, RungeKutta4, SemiImplicitEuler, Step, StepError, StoermerVerlet};
use costate::{Coordinates, EvalError};
use costate_jit::{JitModel, JitVelocityModel};
use std::ffi::c_int;
use std::sync::{Arc, Mutex};

type AnyStep = Box<dyn Step<f64, Error = StepError<EvalError>> + Send>;

/// A step of any scheme, with the arguments and results of a call.
pub struct Workspace {
    n: usize,
    step: AnyStep,
    inputs: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
}

/// A time step: x after dt seconds under constant tau.
pub struct costate_step(Mutex<Workspace>);

handle!(costate_step, Workspace);

/// Schemes of time steps.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum costate_scheme {
    /// The classical method of Runge and Kutta, of order four.
    COSTATE_RK4 = 0,
    /// The implicit midpoint rule, of order two.
    COSTATE_MIDPOINT = 1,
    /// Stoermer-Verlet, of order two, with COSTATE_QP.
    COSTATE_VERLET = 2,
    /// v first, then q with the new v, of order one, with COSTATE_QV.
    COSTATE_SEMI_IMPLICIT_EULER = 3,
}

const RK4: c_int = costate_scheme::COSTATE_RK4 as c_int;
const MIDPOINT: c_int = costate_scheme::COSTATE_MIDPOINT as c_int;
const VERLET: c_int = costate_scheme::COSTATE_VERLET as c_int;
const SEMI_IMPLICIT_EULER: c_int = costate_scheme::COSTATE_SEMI_IMPLICIT_EULER as c_int;

fn scheme(number: c_int, robot: &Robot, coordinates: Coordinates) -> Result<AnyStep, Failure> {
    let needs = |needed, letters, scheme| {
        if coordinates == needed {
            return Ok(());
        }
        Err(Failure::new(COSTATE_ARGUMENT, format_args!("{scheme} needs {letters}")))
    };
    let model = || JitModel::new(robot, coordinates);
    Ok(match number {
        RK4 => Box::new(RungeKutta4::new(model()?)),
        MIDPOINT => Box::new(ImplicitMidpoint::new(model()?)),
        VERLET => {
            needs(Coordinates::Hamiltonian, "COSTATE_QP", "COSTATE_VERLET")?;
            Box::new(StoermerVerlet::new(model()?))
        }
        SEMI_IMPLICIT_EULER => {
            needs(Coordinates::Lagrangian, "COSTATE_QV", "COSTATE_SEMI_IMPLICIT_EULER")?;
            Box::new(SemiImplicitEuler::new(JitVelocityModel::new(robot)?))
        }
        _ => {
            let message = format_args!("scheme is {number}; give one of costate_scheme");
            return Err(Failure::new(COSTATE_ARGUMENT, message));
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

/// Makes a step, for values of costate_coordinates and of costate_scheme.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_new(
    robot: *const costate_robot,
    coordinates: c_int,
    scheme: c_int,
    step: *mut *mut costate_step,
) -> c_int {
    guarded(|| {
        let new = || {
            // SAFETY: the header asks for a handle.
            let robot: Arc<Robot> = unsafe { robot_of(robot) }?;
            Workspace::new(&robot, coordinates, scheme)
        };
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_step::give("step", step, new()) }
    })
}

/// Deletes a step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_delete(step: *mut costate_step) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { costate_step::delete(step) };
        Ok(())
    });
}

/// The next state [2n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_f(
    step: *mut costate_step,
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
        unsafe { costate_step::with("step", step, work) }
    })
}

/// The next state [2n], which may be NULL, and its Jacobian in z [2n * 3n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_jacobian(
    step: *mut costate_step,
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
        unsafe { costate_step::with("step", step, work) }
    })
}

/// The next state [2n] and its Jacobian in z [2n * 3n], which may be NULL, and the second derivatives of
/// y' next in z [3n * 3n], y [2n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_step_contract(
    step: *mut costate_step,
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
        unsafe { costate_step::with("step", step, work) }
    })
}
