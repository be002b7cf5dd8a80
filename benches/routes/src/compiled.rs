//! Machine code of the recorded program, and several states at once.

use crate::cases::Case;
use crate::names::{FIRST, FUNCTION, NODES, SECOND};
use crate::routes::{Candidate, Failure};
use costate::batch::{Batch, FirstOrderArrays, Model, Packed, SecondOrderArrays};
use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::scalar::{F64x4, F64x8};
use costate_jit::Compiled;
use std::hint::black_box;

/// For F, F_x and y'F_xx: machine code for one state and for four, batches over `F64x4` and `F64x8`.
pub fn candidates<'a>(
    case: &'a Case,
    wanted: &dyn Fn(&str, &str) -> bool,
    list: &mut Vec<Candidate<'a>>,
) -> Result<(), Failure> {
    for (label, quantity) in [(FUNCTION, Quantity::F), (FIRST, Quantity::FX), (SECOND, Quantity::YFXX)] {
        if [JIT, JIT_LANES].iter().any(|route| wanted(label, route)) {
            machine_code(case, label, quantity, list)?;
        }
        lanes::<F64x4>(case, [label, BATCH_4], list);
        lanes::<F64x8>(case, [label, BATCH_8], list);
    }
    Ok(())
}

const JIT: &str = "machine code (jit)";
const JIT_LANES: &str = "machine code, 4 states at once: one of them";
const BATCH_4: &str = "batch of 16 states over F64x4: one of them";
const BATCH_8: &str = "batch of 16 states over F64x8: one of them";

/// States that one call of a method computes, where it is one of these.
pub fn states(route: &str) -> Option<usize> {
    match route {
        JIT_LANES => Some(4),
        BATCH_4 | BATCH_8 => Some(NODES),
        _ => None,
    }
}

/// A method is left out where the program is above its limit, or the processor has no machine code.
fn machine_code<'a>(
    case: &'a Case,
    label: &'static str,
    quantity: Quantity,
    list: &mut Vec<Candidate<'a>>,
) -> Result<(), Failure> {
    let program = robot_program(&case.robot, quantity, Coordinates::Hamiltonian, &ProgramOptions::default())?;
    let above = |route: &str| {
        println!("{}: {label}: {} steps are above the limit of {route}", case.title, program.steps());
    };
    let results = program.outputs() - entries(label, case.robot.dof())..program.outputs();
    let state = &case.state;
    let inputs: Vec<f64> =
        state.x.iter().chain(&state.u).chain(&state.y).copied().take(program.inputs()).collect();
    let fours: Vec<[f64; 4]> =
        inputs.iter().map(|&x| [1.0, 0.9, 0.8, 0.7].map(|factor| factor * x)).collect();
    if let Ok(one) = Compiled::new(&program) {
        let (mut outputs, wanted, inputs) = (vec![0.0; one.outputs()], results.clone(), inputs);
        let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
            one.call(black_box(&inputs), black_box(&mut outputs))?;
            if let Some(to) = to {
                to.extend(&outputs[wanted.clone()]);
            }
            Ok(())
        };
        list.push(Candidate { quantity: label, route: JIT, work: Box::new(work) });
    } else {
        above(JIT);
    }
    if let Ok(four) = Compiled::lanes(&program) {
        let mut outputs = vec![[0.0; 4]; four.outputs()];
        let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
            four.call(black_box(&fours), black_box(&mut outputs))?;
            if let Some(to) = to {
                to.extend(outputs[results.clone()].iter().map(|lanes| lanes[0]));
            }
            Ok(())
        };
        list.push(Candidate { quantity: label, route: JIT_LANES, work: Box::new(work) });
    } else {
        above(JIT_LANES);
    }
    Ok(())
}

/// Entries of a quantity, without the results it builds on.
fn entries(label: &str, n: usize) -> usize {
    if label == FUNCTION { 2 * n } else { 4 * n * n }
}

/// [`NODES`] states from node-major arrays to node-major arrays; the first is that of all other methods.
fn lanes<'a, S: Packed<Lane = f64> + 'a>(
    case: &'a Case,
    [quantity, route]: [&'static str; 2],
    list: &mut Vec<Candidate<'a>>,
) where
    Model<HamiltonianSecondOrder<S>>: Send,
{
    let n = case.robot.dof();
    let spread = |entries: &[f64]| -> Vec<f64> {
        (0..NODES).flat_map(|k| entries.iter().map(move |x| x * (1.0 - 0.05 * k as f64))).collect()
    };
    let [x, u, y] = [&case.state.x, &case.state.u, &case.state.y].map(|entries| spread(entries));
    let [mut f, mut f_x, mut xx] = [2 * n, 4 * n * n, 4 * n * n].map(|entries| vec![0.0; NODES * entries]);
    let mut batch = Batch::<S, _>::new(Model(HamiltonianSecondOrder::<S>::new(&case.robot)));
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        let x = black_box(&x);
        let into = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
        let (failures, result) = match quantity {
            FUNCTION => (batch.evaluate(x, &u, &mut f)?, &f[..2 * n]),
            FIRST => (batch.linearise(x, &u, into)?, &f_x[..4 * n * n]),
            _ => {
                let second = SecondOrderArrays { xx: &mut xx, ..Default::default() };
                (batch.contract([x, &u, &y], into, second)?, &xx[..4 * n * n])
            }
        };
        if !failures.is_empty() {
            return Err("a state of the batch failed".into());
        }
        black_box(result);
        if let Some(to) = to {
            to.extend(result);
        }
        Ok(())
    };
    list.push(Candidate { quantity, route, work: Box::new(work) });
}
