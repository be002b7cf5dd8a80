//! Division of a program into stretches of machine code and the function calls between them.

use crate::error::JitError;
use crate::order::Scheduler;
use crate::step::{Op, Step};
use std::collections::HashMap;

/// A function that the library evaluates between two stretches of machine code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    SinCos,
    Exp,
    ExpM1,
}

/// A function, the node of its argument, and those of its values: sine and cosine, or the one value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlannedCall {
    pub function: Function,
    pub argument: usize,
    pub values: [Option<usize>; 2],
}

/// A stretch of machine code, and the functions that are called after it.
#[derive(Clone, Debug, Default)]
pub(crate) struct PlannedStage {
    pub steps: Vec<usize>,
    pub calls: Vec<PlannedCall>,
}

/// The argument of a node that is a function.
fn argument(step: &Step) -> Option<usize> {
    match step.op {
        Op::Sin | Op::Cos | Op::Exp | Op::ExpM1 => step.operands().next(),
        _ => None,
    }
}

/// Divides a program: stage k holds the steps that functions of nesting k need, the last stage those that
/// none needs.
///
/// Functions of the arguments of the program are called before any machine code, in a first stage without
/// steps; a robot with Coulomb friction has a second one, for the exponential functions of its velocities.
///
/// # Errors
/// [`JitError::Malformed`] for a node that is not computed from nodes before it.
pub(crate) fn plan(nodes: &[Step]) -> Result<Vec<PlannedStage>, JitError> {
    check(nodes)?;
    let mut nesting = vec![0; nodes.len()];
    for (k, node) in nodes.iter().enumerate() {
        let deepest = node.operands().map(|operand| nesting[operand]).max().unwrap_or(0);
        nesting[k] = deepest + usize::from(argument(node).is_some());
    }
    let last = nesting.iter().max().copied().unwrap_or(0);
    let mut latest = vec![last; nodes.len()];
    let mut stages = vec![PlannedStage::default(); last + 1];
    for (k, node) in nodes.iter().enumerate().rev() {
        let limit = if argument(node).is_some() { nesting[k] - 1 } else { latest[k] };
        for operand in node.operands() {
            latest[operand] = latest[operand].min(limit);
        }
    }
    for (k, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf() && argument(node).is_none())
    {
        debug_assert!(node.operands().all(|operand| latest[operand] <= latest[k]));
        stages[latest[k]].steps.push(k);
    }
    call_functions(nodes, &nesting, &mut stages);
    let mut scheduler = Scheduler::new(nodes);
    for stage in &mut stages {
        stage.steps = scheduler.stage(&stage.steps);
        scheduler.finish(stage.calls.iter().flat_map(|call| call.values).flatten());
    }
    Ok(stages)
}

/// Checks that every node uses earlier nodes, and that selections, and only these, use comparisons.
fn check(nodes: &[Step]) -> Result<(), JitError> {
    let is_comparison = |operand: usize| nodes[operand].op == Op::Less;
    let sound = |k: usize, step: &Step| {
        let mut choices = step.operands();
        step.operands().all(|operand| operand < k)
            && (step.op != Op::Select || choices.next().is_some_and(is_comparison))
            && !choices.any(is_comparison)
    };
    match nodes.iter().enumerate().position(|(k, node)| !sound(k, node)) {
        Some(node) => Err(JitError::Malformed { node }),
        None => Ok(()),
    }
}

/// Puts each function into the stage before its nesting; sine and cosine of one argument are one call.
fn call_functions(nodes: &[Step], nesting: &[usize], stages: &mut [PlannedStage]) {
    let mut angles: HashMap<usize, usize> = HashMap::new();
    for (k, node) in nodes.iter().enumerate() {
        let Some(argument) = argument(node) else { continue };
        let stage = nesting[k] - 1;
        let calls = &mut stages[stage].calls;
        let (function, which) = match node.op {
            Op::Sin => (Function::SinCos, 0),
            Op::Cos => (Function::SinCos, 1),
            Op::Exp => (Function::Exp, 0),
            _ => (Function::ExpM1, 0),
        };
        let mut values = [None; 2];
        values[which] = Some(k);
        if function == Function::SinCos {
            if let Some(&at) = angles.get(&argument) {
                calls[at].values[which] = Some(k);
                continue;
            }
            angles.insert(argument, calls.len());
        }
        calls.push(PlannedCall { function, argument, values });
    }
}
