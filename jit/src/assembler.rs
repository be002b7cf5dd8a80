//! The few AVX and FMA instructions that compiled programs are made of, as bytes.
//!
//! All of them have a target register, a first source register and a last operand, register or memory (Intel
//! 64 and IA-32 Architectures Software Developer's Manual, volume 2, section 2.3).

mod encode;

use crate::place::{Base, Place, SLOTS, STRIDE};
use encode::{Instruction, Last, Map, PREFIX_66, PREFIX_F2};
use std::ops::Range;

pub use encode::Width;

/// A vector register, 0 to 15.
pub(crate) type Register = u8;

/// The last operand of an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operand {
    Register(Register),
    Memory(Place),
}

/// `target = source op operand`; the value is the opcode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Arithmetic {
    Add = 0x58,
    Mul = 0x59,
    Sub = 0x5C,
    Div = 0x5E,
}

/// The signs of product and addend of a fused operation; the value is the opcode of its form 132 for four
/// doubles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Fused {
    /// `a b + c`
    MulAdd = 0x98,
    /// `a b - c`
    MulSub = 0x9A,
    /// `c - a b`
    NegMulAdd = 0x9C,
}

/// The order of the operands of a fused operation: target is 1, source 2, operand 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Form {
    /// `target = target operand + source`
    F132 = 0x00,
    /// `target = source target + operand`
    F213 = 0x10,
    /// `target = source operand + target`
    F231 = 0x20,
}

/// Machine code while it is written.
#[derive(Debug)]
pub(crate) struct Assembler {
    code: Vec<u8>,
    width: Width,
    /// Whether the upper halves of registers were written.
    upper: bool,
}

impl Assembler {
    /// For numbers of this width.
    pub fn new(width: Width) -> Self {
        Self { code: Vec::new(), width, upper: width == Width::Four }
    }

    /// The bytes of one number in memory of the program.
    fn size(&self) -> usize {
        match self.width {
            Width::One => 8,
            Width::Two => 16,
            Width::Four => 32,
        }
    }

    /// Whether a value is two numbers, with a result for each.
    pub fn has_pairs(&self) -> bool {
        self.width == Width::Two
    }

    /// The bytes of one argument or result: those of a pair are apart.
    fn outer_size(&self) -> usize {
        if self.width == Width::Two { 8 } else { self.size() }
    }

    /// The prefix for one double or packed ones.
    fn prefix(&self) -> u8 {
        match self.width {
            Width::One => PREFIX_F2,
            Width::Two | Width::Four => PREFIX_66,
        }
    }

    /// Number of bytes so far: the position of the next instruction.
    pub fn position(&self) -> usize {
        self.code.len()
    }

    /// All bytes.
    pub fn into_code(self) -> Vec<u8> {
        self.code
    }

    /// `target = source op operand`.
    pub fn arithmetic(&mut self, op: Arithmetic, target: Register, source: Register, operand: Operand) {
        self.write(self.instruction(Map::Of0F, self.prefix(), op as u8), target, source, operand);
    }

    /// `target = sqrt(source)`; the packed instruction has no first source.
    pub fn sqrt(&mut self, target: Register, source: Register) {
        let first = if self.width == Width::One { source } else { 0 };
        self.write(
            self.instruction(Map::Of0F, self.prefix(), 0x51),
            target,
            first,
            Operand::Register(source),
        );
    }

    /// A multiplication and a sum, rounded once.
    pub fn fused(&mut self, op: Fused, form: Form, target: Register, source: Register, operand: Operand) {
        let opcode = op as u8 + form as u8 + u8::from(self.width == Width::One);
        let fused = Instruction { wide: true, ..self.instruction(Map::Of0F38, PREFIX_66, opcode) };
        self.write(fused, target, source, operand);
    }

    /// `target = -source`; the operand holds numbers with only the sign bits set.
    pub fn negate(&mut self, target: Register, source: Register, signs: Operand) {
        self.write(self.instruction(Map::Of0F, PREFIX_66, 0x57), target, source, signs);
    }

    /// All bits of the target are 1 where `source < operand`, else 0; 0 where one of them is not a number.
    pub fn less(&mut self, target: Register, source: Register, operand: Register) {
        const ORDERED_QUIET_LESS: u8 = 0x11;
        let less = self.instruction(Map::Of0F, self.prefix(), 0xC2);
        self.write(less, target, source, Operand::Register(operand));
        self.code.push(ORDERED_QUIET_LESS);
    }

    /// `target = if mask { if_true } else { if_false }`.
    pub fn select(&mut self, target: Register, mask: Register, if_true: Register, if_false: Register) {
        let select = self.instruction(Map::Of0F3A, PREFIX_66, 0x4B);
        self.write(select, target, if_false, Operand::Register(if_true));
        self.code.push(mask << 4);
    }

    /// `target = place`.
    pub fn load(&mut self, target: Register, place: Place) {
        self.write(self.instruction(Map::Of0F, self.prefix(), 0x10), target, 0, Operand::Memory(place));
    }

    /// `place = source`; of a pair, the first number where the place is a result.
    pub fn store(&mut self, source: Register, place: Place) {
        if let (Width::Two, Place::Output(_)) = (self.width, place) {
            let first = Instruction { width: Width::One, ..self.instruction(Map::Of0F, PREFIX_F2, 0x11) };
            return self.write(first, source, 0, Operand::Memory(place));
        }
        self.write(self.instruction(Map::Of0F, self.prefix(), 0x11), source, 0, Operand::Memory(place));
    }

    /// The second number of a pair as a result.
    pub fn store_second(&mut self, source: Register, place: Place) {
        self.write(self.instruction(Map::Of0F, PREFIX_66, 0x17), source, 0, Operand::Memory(place));
    }

    /// The two numbers of a pair, exchanged.
    pub fn exchange(&mut self, target: Register, source: Operand) {
        const SECOND_FIRST: u8 = 1;
        self.write(self.instruction(Map::Of0F3A, PREFIX_66, 0x05), target, 0, source);
        self.code.push(SECOND_FIRST);
    }

    /// `target = place`, in every lane of the register; of a pair, the first number.
    pub fn spread(&mut self, target: Register, place: Place) {
        match self.width {
            Width::One | Width::Two => {
                self.upper = true;
                let spread =
                    Instruction { width: Width::Four, ..self.instruction(Map::Of0F38, PREFIX_66, 0x19) };
                self.write(spread, target, 0, Operand::Memory(place));
            }
            Width::Four => self.load(target, place),
        }
    }

    /// Stores a value that was [`spread`](Self::spread) in these outputs, as whole registers where possible.
    pub fn fill(&mut self, source: Register, outputs: Range<u32>) {
        let Range { mut start, end } = outputs;
        if self.width != Width::Four {
            let four = Instruction { width: Width::Four, ..self.instruction(Map::Of0F, PREFIX_66, 0x11) };
            while end - start >= 4 {
                self.write(four, source, 0, Operand::Memory(Place::Output(start)));
                start += 4;
            }
        }
        (start..end).for_each(|output| self.store(source, Place::Output(output)));
    }

    /// `target = source`, registers.
    pub fn copy(&mut self, target: Register, source: Register) {
        self.write(self.instruction(Map::Of0F, PREFIX_66, 0x28), target, 0, Operand::Register(source));
    }

    /// Computes the further addresses of slots, at the begin of each stretch of code.
    pub fn begin(&mut self) {
        for (group, &target) in SLOTS.iter().enumerate().skip(1) {
            self.address(target, SLOTS[0], (group * STRIDE) as i32);
        }
    }

    /// `target = base + displacement`, general registers.
    fn address(&mut self, target: Base, base: Base, displacement: i32) {
        let rex = 0x48 | (target.0 >> 3) << 2 | base.0 >> 3;
        self.code.extend([rex, 0x8D, 0x80 | (target.0 & 7) << 3 | base.0 & 7]);
        self.code.extend(displacement.to_le_bytes());
    }

    /// Returns to the caller, with the upper halves of registers cleared for code that uses the lower ones
    /// only.
    pub fn back(&mut self) {
        if self.upper {
            self.code.extend([0xC5, 0xF8, 0x77]);
        }
        self.code.push(0xC3);
    }

    /// An instruction of the width of this code.
    fn instruction(&self, map: Map, prefix: u8, opcode: u8) -> Instruction {
        Instruction { map, prefix, opcode, wide: false, width: self.width }
    }

    fn write(&mut self, instruction: Instruction, target: Register, source: Register, last: Operand) {
        let last = match last {
            Operand::Register(register) => Last::Register(register),
            Operand::Memory(place) => {
                let (Base(base), displacement) = place.address(self.size(), self.outer_size());
                Last::Memory { base, displacement }
            }
        };
        instruction.encode(&mut self.code, target, source, last);
    }
}

#[cfg(test)]
mod tests;
