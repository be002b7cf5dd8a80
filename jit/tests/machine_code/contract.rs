//! What callers may rely on: errors, threads, Debug and Send, bounded memory, no allocation, reproducible
//! code.

use costate::codegen::{Coordinates, Program, ProgramOptions, Quantity, robot_program};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use costate::{EvalError, LengthError};
use costate_jit::{Backend, Compiled, JitError, JitQuantity};
use nalgebra::Matrix3;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
    /// Bytes that this thread holds more than it gave back, and the most that it held.
    static HELD: Cell<isize> = const { Cell::new(0) };
    static MOST_HELD: Cell<isize> = const { Cell::new(0) };
}

/// Counts the allocations of this thread.
struct Counting;

// SAFETY: every call is forwarded to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        HELD.set(HELD.get() + layout.size() as isize);
        MOST_HELD.set(MOST_HELD.get().max(HELD.get()));
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.set(HELD.get() - layout.size() as isize);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/../{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

fn program(robot: &Robot, quantity: Quantity) -> Program {
    robot_program(robot, quantity, Coordinates::Hamiltonian, &ProgramOptions::default()).unwrap()
}

/// Machine code, if the processor is supported.
fn compiled(program: &Program) -> Option<Compiled> {
    match Compiled::new(program) {
        Ok(compiled) => Some(compiled),
        Err(JitError::Processor { .. }) => None,
        Err(error) => panic!("{error}"),
    }
}

fn some_inputs(program: &Program) -> Vec<f64> {
    (0..program.inputs()).map(|k| 0.9 - 0.13 * k as f64).collect()
}

#[test]
fn wrong_lengths_are_refused_and_leave_the_outputs_alone() {
    let program = program(&robot("robots/ur5.urdf"), Quantity::FX);
    let mut outputs = vec![7.0; program.outputs()];
    let inputs = some_inputs(&program);
    let mut evaluator =
        JitQuantity::new(&robot("robots/ur5.urdf"), Quantity::FX, Coordinates::Hamiltonian).unwrap();
    let wrong = EvalError::WrongLength(LengthError { what: "inputs", expected: 18, found: 17 });
    assert_eq!(evaluator.evaluate(&inputs[1..], &mut outputs), Err(wrong.clone()));
    let short = EvalError::WrongLength(LengthError { what: "outputs", expected: 156, found: 155 });
    assert_eq!(evaluator.evaluate(&inputs, &mut outputs[1..]), Err(short.clone()));
    if let Some(compiled) = compiled(&program) {
        assert_eq!(compiled.call(&inputs[1..], &mut outputs), Err(wrong));
        assert_eq!(compiled.call(&inputs, &mut outputs[1..]), Err(short));
    }
    assert!(outputs.iter().all(|output| *output == 7.0));
}

/// With friction: selections between values that are not numbers.
#[test]
fn nan_passes_through_machine_code_and_is_an_error_of_the_evaluator() {
    let robot = robot("tests/fixtures/friction_tree.toml");
    let program = program(&robot, Quantity::F);
    let n = robot.dof();
    let Some(compiled) = compiled(&program) else { return };
    let mut evaluator = JitQuantity::new(&robot, Quantity::F, Coordinates::Hamiltonian).unwrap();
    let mut work = Vec::new();
    for (index, bad) in [(0, f64::NAN), (n, f64::NAN), (n + 1, f64::INFINITY), (2 * n, f64::NEG_INFINITY)] {
        let mut inputs = some_inputs(&program);
        inputs[index] = bad;
        let (mut found, mut expected) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        compiled.call(&inputs, &mut found).unwrap();
        program.evaluate(&inputs, &mut expected, &mut work).unwrap();
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let both_odd = !found.is_finite() && !expected.is_finite();
            assert!(
                both_odd || (found - expected).abs() <= 1e-12 * expected.abs().max(1.0),
                "entry {k} for {bad}"
            );
        }
        assert!(found.iter().any(|value| !value.is_finite()));
        let error = evaluator.evaluate(&inputs, &mut found).unwrap_err();
        assert!(matches!(error, EvalError::NonFinite { index: at, .. } if at == index % n), "{error}");
    }
}

#[test]
fn a_singular_mass_matrix_is_an_error_of_the_evaluator() {
    let body = LinkInertia::about_com(1.0, [0.0; 3], Matrix3::zeros());
    let builder = Robot::builder("point on its axis").joint(JointSpec::revolute("a").carrying(body));
    let mut evaluator =
        JitQuantity::new(&builder.build().unwrap(), Quantity::FX, Coordinates::Hamiltonian).unwrap();
    let error = evaluator.evaluate(&[0.3, 0.2, 0.0], &mut [0.0; 6]).unwrap_err();
    assert!(matches!(error, EvalError::SingularMassMatrix { .. }), "{error}");
}

#[test]
fn calls_do_not_allocate() {
    for (file, quantity) in [
        ("robots/panda.urdf", Quantity::FX),
        ("robots/biped.toml", Quantity::YFXX),
        ("tests/fixtures/friction_tree.toml", Quantity::YFXX),
    ] {
        let robot = robot(file);
        let program = program(&robot, quantity);
        let (inputs, mut outputs) = (some_inputs(&program), vec![0.0; program.outputs()]);
        let mut evaluator = JitQuantity::new(&robot, quantity, Coordinates::Hamiltonian).unwrap();
        let mut fallback = JitQuantity::with_limit(&robot, quantity, Coordinates::Hamiltonian, 0).unwrap();
        let before = ALLOCATIONS.get();
        evaluator.evaluate(&inputs, &mut outputs).unwrap();
        fallback.evaluate(&inputs, &mut outputs).unwrap();
        assert_eq!(ALLOCATIONS.get() - before, 0, "{file}");
    }
}

#[test]
fn public_types_are_debug_send_and_sync() {
    fn check<T: std::fmt::Debug + Send + Sync>() {}
    check::<Compiled>();
    check::<Compiled<[f64; 4]>>();
    check::<JitQuantity>();
    check::<JitError>();
    check::<Backend<'_>>();
}

#[test]
fn threads_call_the_same_code_at_once() {
    let program = program(&robot("robots/panda.urdf"), Quantity::YFXX);
    let Some(compiled) = compiled(&program) else { return };
    let alone = |seed: f64| {
        let inputs: Vec<f64> = some_inputs(&program).iter().map(|x| x * seed).collect();
        let mut outputs = vec![0.0; program.outputs()];
        compiled.call(&inputs, &mut outputs).unwrap();
        outputs
    };
    let expected: Vec<Vec<f64>> = (1..5).map(|k| alone(0.2 * f64::from(k))).collect();
    std::thread::scope(|scope| {
        for (k, expected) in (1..5).zip(&expected) {
            let alone = &alone;
            scope.spawn(move || (0..300).for_each(|_| assert_eq!(&alone(0.2 * f64::from(k)), expected)));
        }
    });
}

/// Bytes of memory that can be executed and belong to no file.
#[cfg(target_os = "linux")]
fn executable() -> usize {
    let text = std::fs::read_to_string("/proc/self/maps").unwrap();
    let size = |line: &str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let (from, to) = fields[0].split_once('-').unwrap();
        let [from, to] = [from, to].map(|address| usize::from_str_radix(address, 16).unwrap());
        if fields[1].contains('x') && fields.len() == 5 { to - from } else { 0 }
    };
    text.lines().map(size).sum()
}

#[cfg(target_os = "linux")]
#[test]
fn memory_is_freed_on_drop() {
    let program = program(&robot("robots/panda.urdf"), Quantity::FX);
    let Some(first) = compiled(&program) else { return };
    // Other tests of this process compile at the same time: a few of these programs, not a hundred.
    let before = executable();
    assert!(before >= first.code_len(), "{before} bytes do not hold the first");
    let many: Vec<_> = (0..600).map(|_| compiled(&program)).collect();
    let kept = executable().saturating_sub(before);
    assert!(kept > 450 * first.code_len(), "{kept} bytes do not hold 600 more");
    drop(many);
    let kept = executable().saturating_sub(before);
    assert!(kept < 150 * first.code_len(), "{kept} bytes are kept");
    first.call(&some_inputs(&program), &mut vec![0.0; program.outputs()]).unwrap();
}

#[test]
fn the_same_program_becomes_the_same_code() {
    let robot = robot("tests/fixtures/friction_tree.toml");
    let programs = [program(&robot, Quantity::YFXX), program(&robot, Quantity::YFXX)];
    let [Some(first), Some(second)] = programs.each_ref().map(compiled) else { return };
    assert_eq!(first.code_bytes(), second.code_bytes());
    let inputs = some_inputs(&programs[0]);
    let mut results = [vec![0.0; first.outputs()], vec![0.0; first.outputs()]];
    first.call(&inputs, &mut results[0]).unwrap();
    second.call(&inputs, &mut results[1]).unwrap();
    assert_eq!(results[0], results[1]);
}

/// The whole recording of this quantity would be some three million operations, more than 100 MB.
#[test]
fn a_program_that_is_much_too_long_is_refused_early() {
    let body = LinkInertia::about_com(1.0, [0.1, 0.2, 0.3], Matrix3::identity() * 0.1);
    let mut builder = Robot::builder("snake");
    for k in 0..60_usize {
        let axis = [[1.0, 0.2, 0.0], [0.0, 1.0, 0.3], [0.1, 0.0, 1.0]][k % 3];
        let joint = JointSpec::revolute(format!("j{k}")).axis(axis).carrying(body);
        let joint = if k > 0 { joint.on(format!("j{}", k - 1)) } else { joint };
        builder = builder.joint(joint.placed(Placement::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])));
    }
    let robot = builder.build().unwrap();
    let before = HELD.get();
    MOST_HELD.set(before);
    let evaluator = JitQuantity::new(&robot, Quantity::YFXX, Coordinates::Hamiltonian).unwrap();
    let most = MOST_HELD.get() - before;
    let Backend::Generic { reason } = evaluator.backend() else { panic!("{}", evaluator.backend()) };
    assert!(matches!(reason, JitError::GivenUp { .. } | JitError::Processor { .. }), "{reason}");
    assert!(most < 40_000_000, "{most} bytes");
}
