//! The registers and memory that hold the values of a program while its machine code is written.
//!
//! The next use of every value is known. The value that is evicted from a register is always the one that is
//! used latest (Belady's rule); it is stored only if memory does not hold it yet.

use crate::assembler::{Assembler, Operand, Register, Width};
use crate::error::JitError;
use crate::lists::Lists;
use crate::place::Place;
use std::collections::BTreeSet;
use std::ops::Range;

const REGISTERS: usize = 16;

/// A value that is used again within this many steps is loaded into a register at its first use: one load
/// instead of several. Of 0, 4, 16, 64 and 256, the two next to it were fastest on UR5 and Panda, and it was
/// no slower.
const SOON: u32 = 8;

/// Registers that must keep their values during one step, a bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Locked(u16);

impl Locked {
    pub fn with(self, register: Register) -> Self {
        Self(self.0 | 1 << register)
    }

    fn holds(self, register: usize) -> bool {
        self.0 >> register & 1 == 1
    }
}

#[derive(Clone, Debug)]
struct Value {
    register: Option<Register>,
    /// Its place in memory.
    home: Option<Place>,
    /// The places of its next uses in the list of all.
    uses: Range<usize>,
    /// Time of the next one.
    next: u32,
}

/// The state of registers and memory at one point of the code, and the code up to that point.
pub(crate) struct Registers {
    pub assembler: Assembler,
    values: Vec<Value>,
    /// Times of the uses of all values.
    uses: Lists<u32>,
    owners: [Option<usize>; REGISTERS],
    /// Time of the next use of what is in each register; of a free one [`FREE`].
    due: [u64; REGISTERS],
    free_slots: BTreeSet<u32>,
    slots: u32,
    /// Time of the last use that was passed.
    time: u32,
}

/// Time of the next use of a value without one.
pub(crate) const NEVER: u32 = u32::MAX;

/// That of a free register: later than any.
const FREE: u64 = u64::MAX;

impl Registers {
    /// The state before the first step; `uses` has the times of the uses of each of so many values, rising.
    pub fn new(width: Width, count: usize, uses: Lists<u32>) -> Self {
        let value = |value: usize| {
            let next = uses.of(value).first().copied().unwrap_or(NEVER);
            Value { register: None, home: None, uses: uses.range(value), next }
        };
        Self {
            assembler: Assembler::new(width),
            values: (0..count).map(value).collect(),
            uses,
            owners: [None; REGISTERS],
            due: [FREE; REGISTERS],
            free_slots: BTreeSet::new(),
            slots: 0,
            time: 0,
        }
    }

    /// Number of slots that were in use at once.
    pub fn slots(&self) -> usize {
        self.slots as usize
    }

    /// The register that holds a value.
    pub fn register(&self, value: usize) -> Option<Register> {
        self.values[value].register
    }

    /// The memory that holds a value.
    pub fn home(&self, value: usize) -> Option<Place> {
        self.values[value].home
    }

    /// Memory holds the value from here on.
    pub fn set_home(&mut self, value: usize, home: Place) {
        self.values[value].home = Some(home);
    }

    /// Time of the next use of a value.
    pub fn next_use(&self, value: usize) -> u32 {
        self.values[value].next
    }

    /// Passes the use at `time`: later ones count from here on.
    pub fn pass(&mut self, value: usize, time: u32) {
        self.time = time;
        let passed = &mut self.values[value];
        if passed.next == time && !passed.uses.is_empty() {
            passed.uses.start += 1;
            passed.next = if passed.uses.is_empty() { NEVER } else { self.uses.at(passed.uses.start) };
            if let Some(register) = passed.register {
                self.due[usize::from(register)] = passed.next.into();
            }
        }
    }

    /// Those registers that hold any of these values.
    pub fn lock(&self, values: &[usize]) -> Locked {
        let registers = values.iter().filter_map(|&value| self.register(value));
        registers.fold(Locked::default(), Locked::with)
    }

    /// A value as the last operand of an instruction, wherever it is.
    pub fn operand(&self, value: usize) -> Result<Operand, JitError> {
        let &Value { register, home, .. } = &self.values[value];
        let register = register.map(Operand::Register);
        register.or(home.map(Operand::Memory)).ok_or(JitError::Malformed { node: value })
    }

    /// A register that is not locked; its previous value is in memory if it is needed again.
    pub fn take(&mut self, locked: Locked) -> Register {
        let open = (0..REGISTERS).rev().filter(|&register| !locked.holds(register));
        // Of equals the lowest, whose encoding is shortest.
        let register = open.max_by_key(|&register| self.due[register]).unwrap_or(0);
        if let Some(value) = self.owners[register] {
            self.store(value);
            self.drop_register(register as Register);
        }
        register as Register
    }

    /// Loads a value into a register if it is in none.
    pub fn fetch(&mut self, value: usize, locked: &mut Locked) -> Result<Register, JitError> {
        let register = match self.register(value) {
            Some(register) => register,
            None => {
                let register = self.load(value, *locked)?;
                self.assign(value, register);
                register
            }
        };
        *locked = locked.with(register);
        Ok(register)
    }

    /// Loads the operands of a step that are used again soon.
    pub fn keep(&mut self, operands: &[usize]) -> Result<(), JitError> {
        for &value in operands {
            let next = self.next_use(value);
            if self.register(value).is_some() || next == NEVER || next.saturating_sub(self.time) > SOON {
                continue;
            }
            let mut locked = self.lock(operands);
            let later = |owner: Option<usize>| owner.is_none_or(|owner| self.next_use(owner) > next);
            if (0..REGISTERS).any(|register| !locked.holds(register) && later(self.owners[register])) {
                self.fetch(value, &mut locked)?;
            }
        }
        Ok(())
    }

    /// Loads a value into a register for one use.
    pub fn load(&mut self, value: usize, locked: Locked) -> Result<Register, JitError> {
        let home = self.home(value).ok_or(JitError::Malformed { node: value })?;
        let register = self.take(locked);
        self.assembler.load(register, home);
        Ok(register)
    }

    /// Writes a value that is in memory to ranges of outputs.
    pub fn fill(&mut self, value: usize, outputs: &[Range<u32>]) -> Result<(), JitError> {
        let home = self.home(value).ok_or(JitError::Malformed { node: value })?;
        let register = self.take(Locked::default());
        if outputs.iter().any(|outputs| outputs.len() > 1) {
            self.assembler.spread(register, home);
        } else {
            self.assembler.load(register, home);
        }
        outputs.iter().for_each(|outputs| self.assembler.fill(register, outputs.clone()));
        Ok(())
    }

    /// The register holds the value from here on.
    pub fn assign(&mut self, value: usize, register: Register) {
        self.drop_register(register);
        self.owners[usize::from(register)] = Some(value);
        self.values[value].register = Some(register);
        self.due[usize::from(register)] = self.values[value].next.into();
    }

    /// Marks a register as free.
    fn drop_register(&mut self, register: Register) {
        if let Some(value) = self.owners[usize::from(register)].take() {
            self.values[value].register = None;
            self.due[usize::from(register)] = FREE;
        }
    }

    /// A slot for a value that no machine code computes.
    pub fn new_slot(&mut self) -> u32 {
        self.free_slots.pop_first().unwrap_or_else(|| {
            self.slots += 1;
            self.slots - 1
        })
    }

    /// Stores a value that is needed again and that memory does not hold.
    fn store(&mut self, value: usize) {
        if let (Some(register), None) = (self.register(value), self.home(value))
            && self.next_use(value) != NEVER
        {
            let home = Place::Slot(self.new_slot());
            self.assembler.store(register, home);
            self.set_home(value, home);
        }
    }

    /// Frees register and slot of a value that is not used any more.
    pub fn release(&mut self, value: usize) {
        if self.next_use(value) == NEVER {
            if let Some(register) = self.register(value) {
                self.drop_register(register);
            }
            if let Some(Place::Slot(slot)) = self.home(value) {
                self.free_slots.insert(slot);
                self.values[value].home = None;
            }
        }
    }

    /// The end of a stretch of code: stores every value that is still needed.
    pub fn clear(&mut self) {
        for register in 0..REGISTERS {
            if let Some(value) = self.owners[register] {
                self.store(value);
                self.drop_register(register as Register);
            }
        }
    }
}
