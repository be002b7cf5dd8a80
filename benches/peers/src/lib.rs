//! costate behind the interface of `peers/peer.h`, so that one C program can time it beside others.
//!
//! `peer_open` builds every workspace for a robot file; each quantity of [`quantities`] becomes a function
//! that is timed and one that copies its result out, which is not.

mod quantities;
mod standing;
mod workspaces;

use quantities::{Quantity, State};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::hint::black_box;
use std::marker::PhantomData;
use std::ptr::null;
use workspaces::{Size, Workspaces};

/// `struct quantity`.
#[repr(C)]
struct Entry {
    name: *const c_char,
    length: c_int,
    run: extern "C" fn(*mut c_void, *const f64),
    values: extern "C" fn(*mut c_void, *mut f64),
}

/// `struct peer`.
#[repr(C)]
struct Peer {
    context: *mut c_void,
    count: c_int,
    quantities: *const Entry,
}

/// What `context` points to.
struct Context {
    workspaces: Workspaces,
    last: *const f64,
}

/// The two functions of one quantity.
struct Of<Q>(PhantomData<Q>);

impl<Q: Quantity> Of<Q> {
    extern "C" fn run(context: *mut c_void, state: *const f64) {
        // SAFETY: the driver passes the context that peer_open has made, and a state that lives as long as
        // the driver.
        let (context, state) = unsafe { Self::arguments(context, state) };
        context.last = state.q.as_ptr();
        match Q::evaluate(&mut context.workspaces, &state) {
            Ok(result) => drop(black_box(result)),
            Err(error) => stop(&error.to_string()),
        }
    }

    extern "C" fn values(context: *mut c_void, out: *mut f64) {
        let last = context.cast::<Context>();
        // SAFETY: as above; `last` is the state of the last run, and `out` has room for `length` numbers.
        let (context, state) = unsafe { Self::arguments(context, (*last).last) };
        let n = context.workspaces.size();
        let mut numbers = Vec::with_capacity(Q::length(n));
        match Q::evaluate(&mut context.workspaces, &state) {
            Ok(result) => Q::write(result, &mut numbers),
            Err(error) => stop(&error.to_string()),
        }
        // SAFETY: as above.
        unsafe { out.copy_from_nonoverlapping(numbers.as_ptr(), numbers.len().min(Q::length(n))) };
    }

    /// # Safety
    /// `context` is one of `peer_open`'s, used by nobody else; `state` points to a whole state.
    #[inline(always)]
    unsafe fn arguments<'a>(context: *mut c_void, state: *const f64) -> (&'a mut Context, State<'a>) {
        // SAFETY: the caller's promise.
        let context = unsafe { &mut *context.cast::<Context>() };
        let Size { nq, n, .. } = context.workspaces.size();
        // SAFETY: the caller's promise.
        let numbers = unsafe { std::slice::from_raw_parts(state, nq + 6 * n) };
        (context, State::new(numbers, nq, n))
    }

    fn entry(n: Size) -> Entry {
        Entry {
            name: Q::NAME.as_ptr(),
            length: c_int::try_from(Q::length(n)).unwrap_or(c_int::MAX),
            run: Self::run,
            values: Self::values,
        }
    }
}

/// Builds the workspaces of the robot in a file; null, with a message on standard error, where that fails.
///
/// # Safety
/// `file` is a C string.
#[unsafe(no_mangle)]
unsafe extern "C" fn peer_open(file: *const c_char, n: c_int) -> *const c_void {
    // SAFETY: the caller's promise.
    let path = unsafe { CStr::from_ptr(file) }.to_string_lossy();
    let workspaces = match Workspaces::open(&path) {
        Ok(workspaces) if c_int::try_from(workspaces.size().n) == Ok(n) => workspaces,
        Ok(workspaces) => {
            eprintln!("costate: {path} has {} coordinates, not {n}", workspaces.size().n);
            return null();
        }
        Err(error) => {
            eprintln!("costate: {error}");
            return null();
        }
    };
    let entries = entries(workspaces.size()).leak();
    let context = Box::leak(Box::new(Context { workspaces, last: null() }));
    let peer = Box::leak(Box::new(Peer {
        context: std::ptr::from_mut(context).cast(),
        count: c_int::try_from(entries.len()).unwrap_or(c_int::MAX),
        quantities: entries.as_ptr(),
    }));
    std::ptr::from_ref(peer).cast()
}

fn entries(n: Size) -> Vec<Entry> {
    use quantities::*;
    use standing::*;
    if n.k > 0 {
        return vec![Of::<Contact>::entry(n), Of::<ContactHessian>::entry(n)];
    }
    let mut all = vec![
        Of::<PhaseVelocity>::entry(n),
        Of::<Jacobian>::entry(n),
        Of::<RuleHessian>::entry(n),
        Of::<ForwardDynamics>::entry(n),
        Of::<ForwardJacobian>::entry(n),
        Of::<ForwardHessian>::entry(n),
        Of::<MassMatrix>::entry(n),
        Of::<InverseMassMatrix>::entry(n),
        Of::<InverseDynamics>::entry(n),
        Of::<InverseJacobian>::entry(n),
        Of::<InverseHessian>::entry(n),
    ];
    // A dual pass takes no quaternions.
    if n.nq == n.n {
        all.push(Of::<DualPassHessian>::entry(n));
    }
    all
}

/// A value that cannot be computed ends the comparison.
fn stop(message: &str) -> ! {
    eprintln!("costate: {message}");
    std::process::exit(1)
}
