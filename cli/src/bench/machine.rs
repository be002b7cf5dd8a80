//! Machine code: one state with all checks, and four states at once, whose guards are not checked.

use super::names::FOUR;
use super::routes::{ADJOINT, Candidate, F, FIRST, Failure, SECOND, State};
use costate::codegen::{CodegenError, Coordinates, Quantity, guarded_program};
use costate::robot::Robot;
use costate_jit::{Backend, Compiled, JitError, JitQuantity, LANES_LIMIT, Shape};
use std::hint::black_box;

const QUANTITIES: [(&str, Quantity); 4] =
    [(F, Quantity::F), (FIRST, Quantity::FX), (ADJOINT, Quantity::YFX), (SECOND, Quantity::YFXX)];

/// States that machine code for vectors computes at once.
const LANES: usize = 4;

pub fn candidates<'a>(
    robot: &Robot,
    state: &'a State,
    list: &mut Vec<Candidate<'a>>,
    notes: &mut Vec<String>,
) -> Result<(), Failure> {
    for (label, quantity) in QUANTITIES {
        let evaluator = JitQuantity::new(robot, quantity, Coordinates::Hamiltonian)?;
        let last = evaluator.results().last().map_or(0, Shape::entries);
        match evaluator.backend() {
            Backend::Generic { reason: reason @ JitError::Processor { .. } } => {
                notes.push(format!("No machine code: {reason}."));
                return Ok(());
            }
            Backend::Generic { reason } => notes.push(format!("No machine code for {label}: {reason}.")),
            _ => list.push(one_state(label, evaluator, state, last)),
        }
        let program = match guarded_program(robot, quantity, Coordinates::Hamiltonian, LANES_LIMIT) {
            Err(
                error @ (CodegenError::LargeRobot { .. }
                | CodegenError::LongRecording { .. }
                | CodegenError::TooLarge { .. }),
            ) => {
                notes.push(format!("No machine code for {label} at 4 states at once: {error}."));
                continue;
            }
            program => program?,
        };
        match Compiled::lanes(&program) {
            Ok(compiled) => list.push(four_states(label, compiled, robot, state, last)),
            Err(reason) => notes.push(format!("No machine code for {label} at 4 states at once: {reason}.")),
        }
    }
    Ok(())
}

/// q, p, u and y, as many as the program takes.
fn inputs(state: &State, count: usize) -> Vec<f64> {
    state.x.iter().chain(&state.u).chain(&state.y).copied().take(count).collect()
}

fn one_state<'a>(
    quantity: &'static str,
    mut evaluator: JitQuantity,
    state: &State,
    last: usize,
) -> Candidate<'a> {
    let inputs = inputs(state, evaluator.inputs());
    let mut outputs = vec![0.0; evaluator.outputs()];
    let work = move |to: Option<&mut Vec<f64>>| {
        evaluator.evaluate(black_box(&inputs), black_box(&mut outputs))?;
        if let Some(to) = to {
            to.extend(&outputs[outputs.len() - last..]);
        }
        Ok(())
    };
    Candidate { quantity, route: "machine code", work: Box::new(work) }
}

fn four_states<'a>(
    quantity: &'static str,
    compiled: Compiled<[f64; LANES]>,
    robot: &Robot,
    state: &State,
    last: usize,
) -> Candidate<'a> {
    let scales: [f64; LANES] = std::array::from_fn(|lane| 1.0 - 0.1 * lane as f64);
    let inputs = inputs(state, compiled.inputs());
    let mut inputs: Vec<[f64; LANES]> = inputs.iter().map(|&x| scales.map(|scale| scale * x)).collect();
    for free in robot.free_joints() {
        // Quaternions keep their length.
        let at = free.quaternion();
        (at..at + 4).for_each(|entry| inputs[entry] = [state.q[entry]; LANES]);
    }
    let mut outputs = vec![[0.0; LANES]; compiled.outputs()];
    let work = move |to: Option<&mut Vec<f64>>| {
        compiled.call(black_box(&inputs), black_box(&mut outputs))?;
        if let Some(to) = to {
            // The last output is the guard.
            let end = outputs.len() - 1;
            to.extend(outputs[end - last..end].iter().map(|lanes| lanes[0]));
        }
        Ok(())
    };
    Candidate { quantity, route: FOUR, work: Box::new(work) }
}
