//! The encoding of an instruction: VEX prefix, opcode, ModRM, displacement.

/// The content of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// One double.
    One,
    /// Two doubles with the same operations.
    Two,
    /// Four doubles with the same operations.
    Four,
}

/// The opcode maps.
#[derive(Clone, Copy)]
pub(super) enum Map {
    Of0F = 1,
    Of0F38 = 2,
    Of0F3A = 3,
}
pub(super) const PREFIX_66: u8 = 1;
pub(super) const PREFIX_F2: u8 = 3;

/// An instruction without its operands.
#[derive(Clone, Copy)]
pub(super) struct Instruction {
    pub map: Map,
    /// The mandatory prefix.
    pub prefix: u8,
    pub opcode: u8,
    /// The bit W of the prefix.
    pub wide: bool,
    pub width: Width,
}

/// The last operand, with general registers by their numbers.
#[derive(Clone, Copy)]
pub(super) enum Last {
    Register(u8),
    Memory { base: u8, displacement: i32 },
}

impl Instruction {
    /// Appends the instruction in its shortest form.
    pub fn encode(self, code: &mut Vec<u8>, target: u8, source: u8, last: Last) {
        let (last_number, displacement) = match last {
            Last::Register(register) => (register, None),
            Last::Memory { base, displacement } => (base, Some(displacement)),
        };
        let long = u8::from(self.width == Width::Four) << 2;
        // The prefix holds the high bits of register numbers inverted.
        let high = |register: u8| (register >> 3 & 1) ^ 1;
        let tail = (source & 15 ^ 15) << 3 | long | self.prefix;
        if matches!(self.map, Map::Of0F) && !self.wide && high(last_number) == 1 {
            code.extend([0xC5, high(target) << 7 | tail]);
        } else {
            let first = high(target) << 7 | 1 << 6 | high(last_number) << 5 | self.map as u8;
            code.extend([0xC4, first, u8::from(self.wide) << 7 | tail]);
        }
        code.push(self.opcode);
        let mod_rm = (target & 7) << 3 | last_number & 7;
        match displacement.map(|displacement| (displacement, i8::try_from(displacement))) {
            None => code.push(0xC0 | mod_rm),
            Some((_, Ok(short))) => code.extend([0x40 | mod_rm, short as u8]),
            Some((displacement, Err(_))) => {
                code.push(0x80 | mod_rm);
                code.extend(displacement.to_le_bytes());
            }
        }
    }
}
