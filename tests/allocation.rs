//! No allocation after a workspace is built.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{Hamiltonian, SecondOrder};
use costate::robot::Robot;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// Counts what this thread asks of the system's allocator.
struct Counting;

#[expect(unsafe_code, reason = "an allocator is unsafe by nature; this one only counts and forwards")]
// SAFETY: every call is forwarded to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often `work` allocates.
fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(vec![0_u8; 100])), 1);
}

#[test]
fn analytic_derivatives_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.len();
        let (q, p, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; 2 * n]);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let mut second = SecondOrder::<f64>::new(&robot);
        let mut x = p.clone();
        let count = allocations(|| {
            hamiltonian.phase_velocity(&q, &p, &u).unwrap();
            hamiltonian.jacobian(&q, &p, &u).unwrap();
            hamiltonian.energy(&q, &p).unwrap();
            hamiltonian.momentum(&q, &p).unwrap();
            hamiltonian.momentum_jacobian(&q, &p).unwrap();
            hamiltonian.velocity_jacobian(&q, &p).unwrap();
            hamiltonian.inverse_mass_matrix(&q).unwrap();
            hamiltonian.solve_mass_matrix(&q, &mut x).unwrap();
            second.contracted_hessian(&q, &p, &u, &y).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn automatic_derivatives_do_not_allocate() {
    let robot = robot("ur5.urdf");
    let (x, y) = ([0.3; 12], [0.4; 12]);
    let function = || PhaseVelocity::new(&robot);
    let mut dual: Jacobian<_> = Jacobian::new(function());
    let mut nested = NestedHessian::new(function());
    let mut hyperdual = Hessian::new(function());
    let count = allocations(|| {
        dual.evaluate(&x).unwrap();
        nested.contracted(&x, &y).unwrap();
        hyperdual.contracted(&x, &y).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn a_refusal_allocates_but_the_next_call_does_not() {
    let robot = robot("ur5.urdf");
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    assert!(hamiltonian.phase_velocity(&[f64::NAN; 6], &[0.0; 6], &[0.0; 6]).is_err());
    assert_eq!(allocations(|| drop(hamiltonian.phase_velocity(&[0.0; 6], &[1.0; 6], &[0.0; 6]))), 0);
}
