//! Dynamics: f and its derivatives in either coordinates.

use crate::handle::{Handle, handle};
use crate::numbers::{check_size, read, write, write_if};
use crate::robot::{costate_robot, robot_of};
use crate::status::costate_status::COSTATE_ARGUMENT;
use crate::status::{Failure, guarded};
use costate::Coordinates;
use costate::codegen::Quantity;
use costate::dynamics::Dynamics;
use costate::robot::Robot;
use costate_jit::{JitModel, JitQuantity};
use std::ffi::c_int;
use std::sync::{Arc, Mutex};

/// Everything that calls need; quantities are recorded when they are asked for first.
#[derive(Clone)]
pub struct Workspace {
    robot: Arc<Robot>,
    n: usize,
    model: JitModel,
    quantities: Vec<(Quantity, JitQuantity)>,
    /// The arguments of a call.
    inputs: Vec<f64>,
    /// The results of a quantity, or the Jacobian and the Hessian of f.
    outputs: Vec<f64>,
}

/// Dynamics of a robot in one of costate_coordinates, on machine code.
pub struct costate_dynamics(Mutex<Workspace>);

handle!(costate_dynamics, Workspace);

/// The state x.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub enum costate_coordinates {
    /// x = (q, v).
    COSTATE_QV = 0,
    /// x = (q, p), p = M v: functions take p in the place of v.
    COSTATE_QP = 1,
}

const QV: c_int = costate_coordinates::COSTATE_QV as c_int;
const QP: c_int = costate_coordinates::COSTATE_QP as c_int;

/// The coordinates of a number of the header.
pub fn coordinates_of(number: c_int) -> Result<Coordinates, Failure> {
    match number {
        QV => Ok(Coordinates::Lagrangian),
        QP => Ok(Coordinates::Hamiltonian),
        _ => {
            let message = format_args!("coordinates is {number}; give COSTATE_QV or COSTATE_QP");
            Err(Failure::new(COSTATE_ARGUMENT, message))
        }
    }
}

/// The arguments q, v, tau (n each) and y (2n) of functions.
pub type Arguments<'a> = &'a [(&'a str, *const f64, usize)];

/// Copies arguments one after the other.
///
/// # Safety
/// Each pointer is null or points to so many numbers.
pub unsafe fn read_all(arguments: Arguments<'_>, inputs: &mut [f64]) -> Result<(), Failure> {
    let mut rest = inputs;
    for &(name, from, length) in arguments {
        let (to, more) = rest.split_at_mut(length);
        // SAFETY: by the contract of this function.
        unsafe { read(name, from, to) }?;
        rest = more;
    }
    Ok(())
}

impl Workspace {
    fn new(robot: Arc<Robot>, coordinates: Coordinates) -> Result<Self, Failure> {
        let n = robot.dof();
        let model = JitModel::new(&robot, coordinates)?;
        let (inputs, outputs) = (vec![0.0; 5 * n], vec![0.0; n + 15 * n * n]);
        Ok(Self { robot, n, model, quantities: Vec::new(), inputs, outputs })
    }

    /// Evaluates a quantity in (q, v) at the arguments; its results.
    ///
    /// # Safety
    /// Each argument is null or points to so many numbers.
    pub unsafe fn quantity(
        &mut self,
        quantity: Quantity,
        n: usize,
        arguments: Arguments<'_>,
    ) -> Result<&[f64], Failure> {
        check_size(self.n, n)?;
        // SAFETY: by the contract of this function.
        unsafe { read_all(arguments, &mut self.inputs) }?;
        let place = match self.quantities.iter().position(|(known, _)| *known == quantity) {
            Some(place) => place,
            None => {
                let code = JitQuantity::new(&self.robot, quantity, Coordinates::Lagrangian)?;
                self.quantities.push((quantity, code));
                self.quantities.len() - 1
            }
        };
        let code = &mut self.quantities[place].1;
        let outputs = &mut self.outputs[..code.outputs()];
        code.evaluate(&self.inputs[..code.inputs()], outputs)?;
        Ok(outputs)
    }
}

/// Results of f; those that are null are not wanted.
struct Wanted {
    f: *mut f64,
    jacobian: *mut f64,
    hessian: *mut f64,
}

const NONE: *mut f64 = std::ptr::null_mut();

/// f and its derivatives, the second ones if there is a y.
///
/// # Safety
/// `dynamics` is null or a handle; all other pointers are null or point to as many numbers as the header
/// says.
unsafe fn evaluate(
    dynamics: *mut costate_dynamics,
    n: usize,
    [q, v, tau]: [*const f64; 3],
    y: Option<*const f64>,
    wanted: &Wanted,
) -> Result<(), Failure> {
    let work = |of: &mut Workspace| {
        check_size(of.n, n)?;
        let Workspace { model, inputs, outputs, .. } = of;
        let arguments = [("q", q, n), ("v", v, n), ("tau", tau, n), ("y", y.unwrap_or(q), 2 * n)];
        let count = if y.is_some() { 4 } else { 3 };
        // SAFETY: by the contract of this function.
        unsafe { read_all(&arguments[..count], inputs) }?;
        let (x, rest) = inputs.split_at(2 * n);
        let (tau, y) = rest.split_at(n);
        let (jacobian, hessian) = outputs[..15 * n * n].split_at_mut(6 * n * n);
        let first = if count == 4 {
            let second = model.contract(x, tau, y)?;
            second.hessian(hessian);
            // SAFETY: by the contract of this function.
            unsafe { write_if(hessian, wanted.hessian) };
            second.first
        } else if wanted.jacobian.is_null() {
            // SAFETY: by the contract of this function.
            return unsafe { write("f", model.evaluate(x, tau)?, wanted.f) };
        } else {
            model.linearise(x, tau)?
        };
        first.jacobian(jacobian);
        // SAFETY: by the contract of this function.
        unsafe {
            write_if(jacobian, wanted.jacobian);
            write_if(first.f, wanted.f);
        }
        Ok(())
    };
    // SAFETY: by the contract of this function.
    unsafe { costate_dynamics::with("dynamics", dynamics, work) }
}

/// Makes dynamics in these coordinates, a value of costate_coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_dynamics_new(
    robot: *const costate_robot,
    coordinates: c_int,
    dynamics: *mut *mut costate_dynamics,
) -> c_int {
    guarded(|| {
        // SAFETY: the header asks for a handle.
        let new = || Workspace::new(unsafe { robot_of(robot) }?, coordinates_of(coordinates)?);
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_dynamics::give("dynamics", dynamics, new()) }
    })
}

/// Makes a copy for another thread; both share machine code.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_dynamics_clone(
    dynamics: *const costate_dynamics,
    copy: *mut *mut costate_dynamics,
) -> c_int {
    guarded(|| {
        // SAFETY: the header asks for a handle.
        let copied = unsafe { costate_dynamics::with("dynamics", dynamics, |of| Ok(of.clone())) };
        // SAFETY: the header asks for a place for the handle.
        unsafe { costate_dynamics::give("copy", copy, copied) }
    })
}

/// Deletes dynamics.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_dynamics_delete(dynamics: *mut costate_dynamics) {
    guarded(|| {
        // SAFETY: the header asks for a handle that is not used again.
        unsafe { costate_dynamics::delete(dynamics) };
        Ok(())
    });
}

/// f = dx/dt [2n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_f(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    f: *mut f64,
) -> c_int {
    let wanted = Wanted { f, jacobian: NONE, hessian: NONE };
    // SAFETY: the header asks for what `evaluate` asks for.
    guarded(|| unsafe { evaluate(dynamics, n, [q, v, tau], None, &wanted) })
}

/// f [2n], which may be NULL, and df/dz [2n * 3n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_jacobian(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    f: *mut f64,
    jacobian: *mut f64,
) -> c_int {
    guarded(|| {
        if jacobian.is_null() {
            return Err(Failure::null("jacobian"));
        }
        let wanted = Wanted { f, jacobian, hessian: NONE };
        // SAFETY: the header asks for what `evaluate` asks for.
        unsafe { evaluate(dynamics, n, [q, v, tau], None, &wanted) }
    })
}

/// d2(y'f)/dz2 [3n * 3n], y [2n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_hessian(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    y: *const f64,
    hessian: *mut f64,
) -> c_int {
    // SAFETY: the header asks for the same.
    unsafe { costate_contract(dynamics, n, q, v, tau, y, NONE, NONE, hessian) }
}

/// f [2n] and df/dz [2n * 3n], which may be NULL, and d2(y'f)/dz2 [3n * 3n] from one sweep, y [2n].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_contract(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    y: *const f64,
    f: *mut f64,
    jacobian: *mut f64,
    hessian: *mut f64,
) -> c_int {
    guarded(|| {
        if hessian.is_null() {
            return Err(Failure::null("hessian"));
        }
        // SAFETY: the header asks for what `evaluate` asks for.
        unsafe { evaluate(dynamics, n, [q, v, tau], Some(y), &Wanted { f, jacobian, hessian }) }
    })
}
