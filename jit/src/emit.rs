//! Machine code from the steps of a program.

use crate::assembler::{Arithmetic, Form, Fused, Operand, Register};
use crate::error::JitError;
use crate::place::Place;
use crate::registers::{NEVER, Registers};
use crate::step::{Op, Step};

/// The sign bits for negations: entries 0 and 1 of the constants, because at least 16 bytes are read.
pub(crate) const SIGNS: [[f64; 2]; 2] = [[-0.0; 2]; 2];

/// Writes the instructions of one step and returns the register that holds its value.
///
/// # Errors
/// [`JitError::Malformed`] where an operand is neither in a register nor in memory.
pub(crate) fn step(registers: &mut Registers, k: usize, step: &Step) -> Result<Register, JitError> {
    use Arithmetic::{Add, Div, Mul, Sub};
    let operands = step.operands.map(|operand| operand as usize);
    registers.keep(&operands[..step.arity()])?;
    let [a, b, c] = operands;
    match step.op {
        Op::Add => either_way(registers, Add, a, b),
        Op::Mul => either_way(registers, Mul, a, b),
        Op::Sub => one_way(registers, Sub, a, b),
        Op::Div => one_way(registers, Div, a, b),
        Op::MulAdd => fused(registers, Fused::MulAdd, [a, b, c]),
        Op::MulSub => fused(registers, Fused::MulSub, [a, b, c]),
        Op::NegMulAdd => fused(registers, Fused::NegMulAdd, [a, b, c]),
        Op::Neg => {
            let ([a], target) = sources(registers, [a])?;
            registers.assembler.negate(target, a, Operand::Memory(Place::Constant(0)));
            Ok(target)
        }
        Op::Sqrt => {
            let ([a], target) = sources(registers, [a])?;
            registers.assembler.sqrt(target, a);
            Ok(target)
        }
        Op::Less => {
            let ([a, b], target) = sources(registers, [a, b])?;
            registers.assembler.less(target, a, b);
            Ok(target)
        }
        Op::Select => {
            let ([mask, a, b], target) = sources(registers, [a, b, c])?;
            registers.assembler.select(target, mask, a, b);
            Ok(target)
        }
        Op::Exchange => {
            let source = registers.operand(a)?;
            let target = target(registers, &[a]);
            registers.assembler.exchange(target, source);
            Ok(target)
        }
        Op::Constant | Op::Input | Op::Sin | Op::Cos | Op::Exp | Op::ExpM1 => {
            // These are in memory before any step: the plan has no such steps.
            Err(JitError::Malformed { node: k })
        }
    }
}

/// All operands in registers, and one for the outcome.
fn sources<const N: usize>(
    registers: &mut Registers,
    values: [usize; N],
) -> Result<([Register; N], Register), JitError> {
    let mut locked = registers.lock(&values);
    let mut found = [0; N];
    for (found, &value) in found.iter_mut().zip(&values) {
        *found = registers.fetch(value, &mut locked)?;
    }
    Ok((found, target(registers, &values)))
}

/// A register for the outcome: that of an operand that is not used again, or another one.
fn target(registers: &mut Registers, values: &[usize]) -> Register {
    let over = values.iter().filter(|&&value| registers.next_use(value) == NEVER);
    match over.filter_map(|&value| registers.register(value)).min() {
        Some(register) => register,
        None => registers.take(registers.lock(values)),
    }
}

/// `a op b`, where only b can be in memory.
fn one_way(registers: &mut Registers, op: Arithmetic, a: usize, b: usize) -> Result<Register, JitError> {
    let source = registers.fetch(a, &mut registers.lock(&[a, b]))?;
    let operand = registers.operand(b)?;
    let target = target(registers, &[a, b]);
    registers.assembler.arithmetic(op, target, source, operand);
    Ok(target)
}

/// `a op b = b op a`: the one in memory comes last, of two the one that is used later.
fn either_way(registers: &mut Registers, op: Arithmetic, a: usize, b: usize) -> Result<Register, JitError> {
    let swapped = match (registers.register(a), registers.register(b)) {
        (None, Some(_)) => true,
        (None, None) => registers.next_use(b) < registers.next_use(a),
        // The shorter encoding.
        (Some(a), Some(b)) => a < 8 && b >= 8,
        (Some(_), None) => false,
    };
    if swapped { one_way(registers, op, b, a) } else { one_way(registers, op, a, b) }
}

/// `a b + c` and its like, which overwrite one of their sources.
///
/// The overwritten source is one without further use, or a copy; a value in memory is loaded as the copy or
/// is the last operand.
fn fused(registers: &mut Registers, op: Fused, [a, b, c]: [usize; 3]) -> Result<Register, JitError> {
    let roles = [a, b, c];
    let mut locked = registers.lock(&roles);
    let mut stored: Vec<usize> = roles.into_iter().filter(|&v| registers.register(v).is_none()).collect();
    stored.sort_by_key(|&value| (registers.next_use(value), value));
    stored.dedup();
    let once = |value: usize| roles.iter().filter(|&&role| role == value).count() == 1;
    let may_stay = |stored: &[usize]| stored.is_empty() || stored.len() == 1 && once(stored[0]);
    let over = [c, a, b].into_iter().filter(|&value| registers.next_use(value) == NEVER);
    let over = over.filter_map(|value| registers.register(value).map(|register| (value, register))).next();
    let (overwritten, target) = match over {
        Some(over) if may_stay(&stored) => over,
        _ => match stored.pop() {
            Some(value) => (value, registers.load(value, locked)?),
            None => {
                let source = registers.fetch(c, &mut locked)?;
                let target = registers.take(locked);
                registers.assembler.copy(target, source);
                (c, target)
            }
        },
    };
    locked = locked.with(target);
    while !may_stay(&stored) {
        registers.fetch(stored.remove(0), &mut locked)?;
    }
    let operand = |value: usize| match value == overwritten {
        true => Ok(Operand::Register(target)),
        false => registers.operand(value),
    };
    let (form, source, last) = if overwritten == c {
        (Form::F231, operand(a)?, operand(b)?)
    } else {
        let other = if overwritten == a { b } else { a };
        match (operand(other)?, operand(c)?) {
            (Operand::Register(other), c) => (Form::F213, Operand::Register(other), c),
            (other, c) => (Form::F132, c, other),
        }
    };
    let (source, last) = match (source, last) {
        (Operand::Register(source), last) => (source, last),
        // Of a product the factor in memory comes last.
        (last, Operand::Register(source)) => (source, last),
        _ => return Err(JitError::Malformed { node: c }),
    };
    registers.assembler.fused(op, form, target, source, last);
    Ok(target)
}
