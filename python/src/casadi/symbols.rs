//! The functions that CasADi loads by name, `costate_K` and its derivatives for each slot K.
//!
//! Their signatures are those of CasADi's external functions (3.6.7 and later). There is no `checkout`: a
//! workspace is taken for each call, so that calls with the same memory index are safe too.

use super::family::Family;
use super::layout::{Part, Port};
use super::{python, slots};
use std::ffi::{CStr, c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The value, or what to return where it panics: no panic may cross into C.
fn guarded<R>(otherwise: R, work: impl FnOnce() -> R) -> R {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or(otherwise)
}

/// Something of a function; `None` where the slot is empty.
fn of<R>(slot: usize, part: usize, what: impl FnOnce(&'static Part) -> R) -> Option<R> {
    // SAFETY: CasADi asks about functions that it has loaded, which hold their slot, and copies what it gets.
    let family: Option<&'static Family> = unsafe { slots::family(slot) };
    family.map(|family| what(&family.parts[part]))
}

fn count(slot: usize, part: usize, ports: fn(&Part) -> &[Port]) -> i64 {
    guarded(0, || of(slot, part, |part| ports(part).len() as i64).unwrap_or(0))
}

fn port(slot: usize, part: usize, ports: fn(&Part) -> &[Port], k: i64) -> Option<&'static Port> {
    let k = usize::try_from(k).ok()?;
    of(slot, part, |part| ports(part).get(k))?
}

fn name(slot: usize, part: usize, ports: fn(&Part) -> &[Port], k: i64) -> *const c_char {
    let null = std::ptr::null();
    guarded(null, || port(slot, part, ports, k).map_or(null, |port| port.name.as_ptr()))
}

fn sparsity(slot: usize, part: usize, ports: fn(&Part) -> &[Port], k: i64) -> *const i64 {
    /// A scalar.
    static SCALAR: [i64; 3] = [1, 1, 1];
    guarded(SCALAR.as_ptr(), || {
        port(slot, part, ports, k).map_or(SCALAR.as_ptr(), |port| port.sparsity.as_ptr())
    })
}

fn inputs(part: &Part) -> &[Port] {
    &part.inputs
}

fn outputs(part: &Part) -> &[Port] {
    &part.outputs
}

/// 0 if the function was evaluated.
///
/// # Safety
/// `arg` and `res` are as CasADi passes them, see [`Family::evaluate`].
unsafe fn evaluate(slot: usize, part: usize, arg: *const *const f64, res: *const *mut f64) -> c_int {
    let done = guarded(false, || {
        // SAFETY: CasADi evaluates functions that it has loaded, which hold their slot.
        let family = unsafe { slots::family(slot) };
        // SAFETY: by the contract of this function.
        family.is_some_and(|family| unsafe { family.evaluate(part, arg, res) })
    });
    c_int::from(!done)
}

/// Numbers of pointers that the evaluation needs; no other memory.
///
/// # Safety
/// Each pointer is null or points to a number.
unsafe fn work(slot: usize, part: usize, sizes: [*mut i64; 4]) -> c_int {
    let values = [count(slot, part, inputs), count(slot, part, outputs), 0, 0];
    for (size, value) in sizes.into_iter().zip(values) {
        if !size.is_null() {
            // SAFETY: by the contract of this function.
            unsafe { *size = value };
        }
    }
    0
}

/// 0 if a function may refer to the slot, see [`slots::config`]. The arguments are the file of this library
/// and, except for derivatives, the text of the function.
///
/// # Safety
/// `argv` points to `argc` strings.
unsafe fn config(slot: usize, argc: c_int, argv: *const *const c_char) -> c_int {
    // SAFETY: by the contract of this function.
    let text = (argc > 1).then(|| unsafe { CStr::from_ptr(*argv.add(1)) });
    c_int::from(!guarded(false, || slots::config(slot, text, python::read)))
}

/// One function of one slot.
macro_rules! function {
    ($slot:literal, $part:literal, $prefix:literal) => {
        const _: () = {
            #[unsafe(export_name = concat!($prefix, "costate_", $slot))]
            unsafe extern "C" fn eval(
                arg: *const *const f64,
                res: *const *mut f64,
                _iw: *mut i64,
                _w: *mut f64,
                _mem: c_int,
            ) -> c_int {
                // SAFETY: CasADi keeps the contract.
                unsafe { evaluate($slot, $part, arg, res) }
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_n_in"))]
            extern "C" fn n_in() -> i64 {
                count($slot, $part, inputs)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_n_out"))]
            extern "C" fn n_out() -> i64 {
                count($slot, $part, outputs)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_name_in"))]
            extern "C" fn name_in(k: i64) -> *const c_char {
                name($slot, $part, inputs, k)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_name_out"))]
            extern "C" fn name_out(k: i64) -> *const c_char {
                name($slot, $part, outputs, k)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_sparsity_in"))]
            extern "C" fn sparsity_in(k: i64) -> *const i64 {
                sparsity($slot, $part, inputs, k)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_sparsity_out"))]
            extern "C" fn sparsity_out(k: i64) -> *const i64 {
                sparsity($slot, $part, outputs, k)
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_work"))]
            unsafe extern "C" fn sizes(arg: *mut i64, res: *mut i64, iw: *mut i64, w: *mut i64) -> c_int {
                // SAFETY: CasADi keeps the contract.
                unsafe { work($slot, $part, [arg, res, iw, w]) }
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_config"))]
            unsafe extern "C" fn configure(argc: c_int, argv: *const *const c_char) -> c_int {
                // SAFETY: CasADi keeps the contract.
                unsafe { config($slot, argc, argv) }
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_incref"))]
            extern "C" fn incref() {
                guarded((), || slots::add_holder($slot));
            }
            #[unsafe(export_name = concat!($prefix, "costate_", $slot, "_decref"))]
            extern "C" fn decref() {
                guarded((), || slots::decref($slot));
            }
        };
    };
}

/// All functions of these slots.
macro_rules! slots {
    ($($slot:literal)*) => {
        $(
            function!($slot, 0, "");
            function!($slot, 1, "jac_");
            function!($slot, 2, "adj1_");
            function!($slot, 3, "jac_adj1_");
            function!($slot, 4, "jac_jac_");
        )*
        const _: () = assert!([$($slot),*].len() == slots::SLOTS);
    };
}

slots! {
    0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31
    32 33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61 62 63
}
