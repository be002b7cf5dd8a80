//! The places of values in memory while a program runs, and their addresses in machine code.

/// A general register that addresses are relative to, by its number in the encoding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Base(pub u8);

/// A number in memory: one double, or four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Input(u32),
    Output(u32),
    Constant(u32),
    /// Memory of one call.
    Slot(u32),
}

/// Most entries of each kind: displacements stay far within 32 bits.
pub(crate) const MOST: usize = 1 << 24;

/// The four addresses passed to machine code are offset by this many bytes, so that one byte of displacement
/// reaches 256 bytes.
pub(crate) const BIAS: usize = 128;

/// Arguments of the calling convention of System V: inputs, outputs, constants, slots.
const INPUTS: Base = Base(7);
const OUTPUTS: Base = Base(6);
const CONSTANTS: Base = Base(2);
/// The first address of slots is an argument; each further one is [`STRIDE`] bytes later.
pub(crate) const SLOTS: [Base; 6] = [Base(1), Base(8), Base(9), Base(10), Base(11), Base(0)];
pub(crate) const STRIDE: usize = 256;

impl Place {
    /// As base and displacement, for numbers of `size` bytes, and of `outer_size` as arguments and results.
    pub fn address(self, size: usize, outer_size: usize) -> (Base, i32) {
        let (base, index, skipped) = match self {
            Place::Input(k) => (INPUTS, k, 0),
            Place::Output(k) => (OUTPUTS, k, 0),
            Place::Constant(k) => (CONSTANTS, k, 0),
            Place::Slot(k) => {
                let group = (k as usize * size / STRIDE).min(SLOTS.len() - 1);
                (SLOTS[group], k, group * STRIDE)
            }
        };
        let size = if matches!(self, Place::Input(_) | Place::Output(_)) { outer_size } else { size };
        // At most 32 MOST = 2^29.
        (base, (index as usize * size) as i32 - (BIAS + skipped) as i32)
    }
}
