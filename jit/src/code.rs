//! Executable memory, and calls into it.

use crate::error::JitError;
use crate::number::Element;
use memmap2::{Mmap, MmapMut};
use std::mem::MaybeUninit;

/// Machine code in its own memory, which is freed on drop.
#[derive(Debug)]
pub(crate) struct Code {
    memory: Mmap,
}

/// Machine code as a function of inputs, outputs, constants and slots, each address offset by
/// [`BIAS`](crate::place::BIAS).
#[cfg(target_arch = "x86_64")]
type Entry = unsafe extern "sysv64" fn(*const u8, *mut u8, *const u8, *mut u8);

impl Code {
    /// Whether this process can run what [`Assembler`](crate::assembler::Assembler) writes.
    ///
    /// # Errors
    /// [`JitError::Processor`].
    pub fn supported() -> Result<(), JitError> {
        #[cfg(target_arch = "x86_64")]
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return Ok(());
        }
        Err(JitError::Processor { architecture: std::env::consts::ARCH })
    }

    /// Copies machine code into memory that is executable and not writable.
    ///
    /// # Errors
    /// [`JitError::Memory`].
    pub fn new(bytes: &[u8]) -> Result<Self, JitError> {
        let mut memory = MmapMut::map_anon(bytes.len())?;
        memory.copy_from_slice(bytes);
        Ok(Self { memory: memory.make_exec()? })
    }

    /// The machine code.
    pub fn bytes(&self) -> &[u8] {
        &self.memory
    }

    /// Runs the code that begins at `entry`.
    ///
    /// # Safety
    /// `entry` is where a stretch of code begins that was made for numbers of this type and for inputs,
    /// outputs, constants and slots of these lengths: it reads and writes nothing else, reads of the slots
    /// only what was written, and ends by a return. The processor is [`supported`](Self::supported).
    #[cfg(target_arch = "x86_64")]
    pub unsafe fn run<T: Element>(
        &self,
        entry: usize,
        inputs: &[T::Outer],
        outputs: &mut [T::Outer],
        constants: &[T::Stored],
        slots: &mut [MaybeUninit<T::Stored>],
    ) {
        let address = self.memory[entry..].as_ptr();
        // SAFETY: the memory holds a function of this type at `entry` (contract of this function) and cannot
        // be written any more; it lives as long as `self`.
        let function = unsafe { std::mem::transmute::<*const u8, Entry>(address) };
        const BIAS: usize = crate::place::BIAS;
        // SAFETY: the code stays within the four slices (contract of this function), which are borrowed for
        // as long as it runs. The addresses are moved by wrapping arithmetic, since alone they may point
        // outside, and the code's displacements move them back. It uses registers that the convention lets it
        // change, and no stack.
        unsafe {
            function(
                inputs.as_ptr().cast::<u8>().wrapping_add(BIAS),
                outputs.as_mut_ptr().cast::<u8>().wrapping_add(BIAS),
                constants.as_ptr().cast::<u8>().wrapping_add(BIAS),
                slots.as_mut_ptr().cast::<u8>().wrapping_add(BIAS),
            );
        }
    }

    /// There is no code for other processors, so this is never called: [`supported`](Self::supported) fails.
    ///
    /// # Safety
    /// None is needed.
    #[cfg(not(target_arch = "x86_64"))]
    pub unsafe fn run<T: Element>(
        &self,
        _: usize,
        _: &[T::Outer],
        _: &mut [T::Outer],
        _: &[T::Stored],
        _: &mut [MaybeUninit<T::Stored>],
    ) {
    }
}
