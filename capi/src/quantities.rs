//! The quantities in (q, v): accelerations, torques with their Jacobian, the mass matrix.

use crate::dynamics::{Arguments, Workspace, costate_dynamics};
use crate::handle::Handle;
use crate::numbers::write;
use crate::status::guarded;
use costate::codegen::Quantity;
use std::ffi::c_int;

/// Evaluates a quantity in (q, v) and writes what `part` takes of its results.
///
/// # Safety
/// `dynamics` is null or a handle; all other pointers are null or point to as many numbers as the header
/// says.
unsafe fn quantity(
    dynamics: *mut costate_dynamics,
    n: usize,
    quantity: Quantity,
    arguments: Arguments<'_>,
    (name, to): (&str, *mut f64),
    part: impl FnOnce(&[f64]) -> &[f64],
) -> c_int {
    guarded(|| {
        let work = |of: &mut Workspace| {
            // SAFETY: by the contract of this function.
            let results = unsafe { of.quantity(quantity, n, arguments) }?;
            // SAFETY: as above.
            unsafe { write(name, part(results), to) }
        };
        // SAFETY: as above.
        unsafe { costate_dynamics::with("dynamics", dynamics, work) }
    })
}

/// Forward dynamics: accelerations a [n], for velocities v in either coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_aba(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    tau: *const f64,
    a: *mut f64,
) -> c_int {
    let arguments = [("q", q, n), ("v", v, n), ("tau", tau, n)];
    // SAFETY: the header asks for what `quantity` asks for.
    unsafe { quantity(dynamics, n, Quantity::F, &arguments, ("a", a), |all| all) }
}

/// Inverse dynamics: tau [n] for velocities and accelerations, in either coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_rnea(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    a: *const f64,
    tau: *mut f64,
) -> c_int {
    let arguments = [("q", q, n), ("v", v, n), ("a", a, n)];
    // SAFETY: the header asks for what `quantity` asks for.
    unsafe { quantity(dynamics, n, Quantity::InverseDynamics, &arguments, ("tau", tau), |all| all) }
}

/// d tau/d(q, v, a) [n * 3n], for velocities and accelerations, in either coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_rnea_jacobian(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    v: *const f64,
    a: *const f64,
    jacobian: *mut f64,
) -> c_int {
    let arguments = [("q", q, n), ("v", v, n), ("a", a, n)];
    // SAFETY: the header asks for what `quantity` asks for.
    unsafe { quantity(dynamics, n, Quantity::TauZ, &arguments, ("jacobian", jacobian), |all| &all[n..]) }
}

/// The mass matrix M [n * n], armature included.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn costate_crba(
    dynamics: *mut costate_dynamics,
    n: usize,
    q: *const f64,
    m: *mut f64,
) -> c_int {
    // SAFETY: the header asks for what `quantity` asks for.
    unsafe { quantity(dynamics, n, Quantity::MassMatrix, &[("q", q, n)], ("m", m), |all| all) }
}
