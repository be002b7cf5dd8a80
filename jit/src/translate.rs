//! Translation of a program into machine code, function calls and a table of constants.

use crate::assembler::Width;
use crate::emit;
use crate::error::JitError;
use crate::lists::Lists;
use crate::place::{MOST, Place};
use crate::plan::{Function, PlannedStage, plan};
use crate::registers::{NEVER, Registers};
use crate::step::{Op, Step, Steps};
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// A function call: the place of its argument, and the slots of those of its values that are used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Call {
    pub function: Function,
    pub argument: Place,
    pub values: [Option<u32>; 2],
}

/// A pair of inputs, and the slot for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairedInput {
    pub slot: u32,
    pub inputs: [u32; 2],
}

/// A stretch of machine code, which may be empty, and the functions that are called after it: sines and
/// cosines first.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub entry: Option<usize>,
    pub calls: Vec<Call>,
    /// How many of them are sines and cosines.
    pub angles: usize,
}

/// Everything that is needed to run a program.
#[derive(Debug)]
pub(crate) struct Translation {
    pub code: Vec<u8>,
    pub stages: Vec<Stage>,
    pub constants: Vec<[f64; 2]>,
    /// In programs of pairs, the inputs, which a call gathers before anything else.
    pub inputs: Vec<PairedInput>,
    /// Numbers of memory that a call needs for itself, each of the width of the program.
    pub slots: usize,
}

/// Constants in the order of their first appearance, each once; steps that hold them.
fn constants(program: &Steps) -> (Vec<[f64; 2]>, Vec<(usize, Place)>) {
    let mut table = emit::SIGNS.to_vec();
    let mut positions = HashMap::new();
    let mut homes = Vec::new();
    for (k, step) in program.steps.iter().enumerate().filter(|(_, step)| step.op == Op::Constant) {
        let value = program.constants[step.operands[0] as usize];
        let position = *positions.entry(value.map(f64::to_bits)).or_insert_with(|| {
            table.push(value);
            table.len() as u32 - 1
        });
        homes.push((k, Place::Constant(position)));
    }
    (table, homes)
}

/// The places of inputs: where the caller has them, or slots for pairs of them.
fn inputs(program: &Steps, width: Width, registers: &mut Registers) -> Vec<PairedInput> {
    let mut paired = Vec::new();
    for (k, step) in program.steps.iter().enumerate().filter(|(_, step)| step.op == Op::Input) {
        let inputs = program.inputs[step.operands[0] as usize];
        let home = if width == Width::Two {
            let slot = registers.new_slot();
            paired.push(PairedInput { slot, inputs });
            Place::Slot(slot)
        } else {
            Place::Input(inputs[0])
        };
        registers.set_home(k, home);
    }
    paired
}

/// The times at which each node is used: steps count 1 each, the calls after a stage 1 together, the end 1.
fn uses(nodes: &[Step], stages: &[PlannedStage], results: &[usize]) -> Lists<u32> {
    let mut uses: Vec<(usize, u32)> = Vec::with_capacity(3 * nodes.len());
    let mut last = vec![NEVER; nodes.len()];
    let mut record = |node: usize, time: u32| {
        if last[node] != time {
            last[node] = time;
            uses.push((node, time));
        }
    };
    let mut time = 0;
    for stage in stages {
        for &step in &stage.steps {
            nodes[step].operands().for_each(|operand| record(operand, time));
            time += 1;
        }
        stage.calls.iter().for_each(|call| record(call.argument, time));
        time += 1;
    }
    results.iter().for_each(|&node| record(node, time));
    Lists::new(nodes.len(), &uses)
}

/// Writes the machine code of a program, for one state or four at a time; if `guarded`, its last result is
/// stored in slot 0 and not in the outputs.
///
/// # Errors
/// [`JitError::Malformed`], [`JitError::TooWide`].
pub(crate) fn translate(program: &Steps, width: Width, guarded: bool) -> Result<Translation, JitError> {
    let nodes = &program.steps;
    for (what, found) in
        [("nodes", nodes.len()), ("inputs", program.inputs.len()), ("outputs", program.results.len())]
    {
        if found > MOST {
            return Err(JitError::TooWide { what, found, limit: MOST });
        }
    }
    let planned = plan(nodes)?;
    let results = &program.results;
    // A result that is computed by a step is stored there; the others are copied at the end.
    let mut is_step = vec![false; nodes.len()];
    planned.iter().flat_map(|stage| &stage.steps).for_each(|&step| is_step[step] = true);
    let (mut stored, mut copied) = (Vec::new(), Vec::new());
    let guard = results.len().checked_sub(1).filter(|_| guarded);
    for (k, &(node, lane)) in results.iter().enumerate() {
        let place = if Some(k) == guard { Place::Slot(0) } else { Place::Output(k as u32) };
        match is_step.get(node as usize) {
            Some(true) => stored.push((node as usize, (place, lane))),
            _ => copied.push((place, node as usize, lane)),
        }
    }
    let outputs = Lists::new(nodes.len(), &stored);
    let late: Vec<usize> = copied.iter().map(|copied| copied.1).collect();
    let mut registers = Registers::new(width, nodes.len(), uses(nodes, &planned, &late));
    if guard.is_some() {
        registers.new_slot();
    }
    let inputs = inputs(program, width, &mut registers);
    let (constants, homes) = constants(program);
    homes.into_iter().for_each(|(node, home)| registers.set_home(node, home));
    let mut stages = Vec::new();
    let mut time = 0;
    for (number, stage) in planned.iter().enumerate() {
        let last = number + 1 == planned.len();
        let entry = registers.assembler.position();
        let has_code = !stage.steps.is_empty() || last;
        if has_code {
            registers.assembler.begin();
        }
        for &k in &stage.steps {
            step(&mut registers, nodes, k, time, outputs.of(k))?;
            time += 1;
        }
        if last {
            copy(&mut registers, &copied, time + 1)?;
        } else {
            registers.clear();
        }
        if has_code {
            registers.assembler.back();
        }
        let mut calls = calls(&mut registers, stage, time)?;
        calls.sort_by_key(|call| call.function != Function::SinCos);
        let angles = calls.partition_point(|call| call.function == Function::SinCos);
        time += 1;
        stages.push(Stage { entry: has_code.then_some(entry), calls, angles });
    }
    let slots = registers.slots();
    Ok(Translation { code: registers.assembler.into_code(), stages, constants, inputs, slots })
}

/// One step: its instructions, its stores to results, and the release of its operands.
fn step(
    registers: &mut Registers,
    nodes: &[Step],
    k: usize,
    time: u32,
    outputs: &[(Place, usize)],
) -> Result<(), JitError> {
    let node = &nodes[k];
    node.operands().for_each(|operand| registers.pass(operand, time));
    let target = emit::step(registers, k, node)?;
    registers.assign(k, target);
    for &(output, lane) in outputs {
        match lane {
            0 => registers.assembler.store(target, output),
            _ => registers.assembler.store_second(target, output),
        }
    }
    // Not the slot, which would be released with the value, and not one number of a pair.
    let whole = |output: &&(Place, usize)| matches!(output.0, Place::Output(_));
    if let Some(&(output, _)) = outputs.iter().find(whole).filter(|_| !registers.assembler.has_pairs()) {
        registers.set_home(k, output);
    }
    node.operands().chain([k]).for_each(|value| registers.release(value));
    Ok(())
}

/// Results that no step computes: constants, arguments, values of functions. Each is loaded once.
fn copy(registers: &mut Registers, copied: &[(Place, usize, usize)], time: u32) -> Result<(), JitError> {
    let mut outputs: BTreeMap<usize, Vec<Range<u32>>> = BTreeMap::new();
    for &(place, node, lane) in copied {
        let (Place::Output(output), 0) = (place, lane) else {
            let source = registers.load(node, registers.lock(&[]))?;
            match lane {
                0 => registers.assembler.store(source, place),
                _ => registers.assembler.store_second(source, place),
            }
            continue;
        };
        let ranges = outputs.entry(node).or_default();
        match ranges.last_mut().filter(|range| range.end == output) {
            Some(range) => range.end += 1,
            None => ranges.push(output..output + 1),
        }
    }
    for (node, outputs) in outputs {
        registers.pass(node, time);
        registers.fill(node, &outputs)?;
    }
    Ok(())
}

/// Slots for the values of functions; those of their arguments are free afterwards.
fn calls(registers: &mut Registers, stage: &PlannedStage, time: u32) -> Result<Vec<Call>, JitError> {
    let mut calls = Vec::with_capacity(stage.calls.len());
    for planned in &stage.calls {
        let argument =
            registers.home(planned.argument).ok_or(JitError::Malformed { node: planned.argument })?;
        let values = planned.values.map(|node| {
            node.map(|node| {
                let slot = registers.new_slot();
                registers.set_home(node, Place::Slot(slot));
                slot
            })
        });
        calls.push(Call { function: planned.function, argument, values });
    }
    for planned in &stage.calls {
        registers.pass(planned.argument, time);
        registers.release(planned.argument);
    }
    Ok(calls)
}
