//! The numbers of machine code: one double, or four doubles of four states.

use crate::assembler::Width;
use crate::functions;
use std::fmt::Debug;

/// `f64`, or `[f64; 4]` for four states at once.
pub trait JitNumber: Element {}

impl JitNumber for f64 {}
impl JitNumber for [f64; 4] {}

/// The operations of a [`JitNumber`]; implemented by this crate only.
pub trait Element: Copy + Debug + 'static {
    /// The same number in memory of the library, aligned so that it never spans two cache lines.
    type Stored: Copy + Debug + Send + Sync;
    /// The operand width of the assembler.
    const WIDTH: Width;
    /// Angles whose sines and cosines are computed together.
    const ANGLES: usize;

    fn store(self) -> Self::Stored;
    fn load(stored: Self::Stored) -> Self;
    /// The same double in every lane.
    fn splat(value: f64) -> Self;
    /// A function of every lane.
    fn map_lanes(self, function: impl Fn(f64) -> f64) -> Self;
    /// Sine and cosine of [`ANGLES`](Self::ANGLES) angles, by their positions.
    ///
    /// # Safety
    /// The processor has AVX2 and FMA.
    unsafe fn sin_cos(angle: impl Fn(usize) -> Self, take: impl FnMut(usize, [Self; 2]));
}

impl Element for f64 {
    type Stored = f64;
    const WIDTH: Width = Width::One;
    const ANGLES: usize = 4;

    #[inline]
    fn store(self) -> f64 {
        self
    }
    #[inline]
    fn load(stored: f64) -> f64 {
        stored
    }
    #[inline]
    fn splat(value: f64) -> f64 {
        value
    }
    #[inline]
    fn map_lanes(self, function: impl Fn(f64) -> f64) -> f64 {
        function(self)
    }
    #[inline]
    unsafe fn sin_cos(angle: impl Fn(usize) -> f64, mut take: impl FnMut(usize, [f64; 2])) {
        // SAFETY: the contract of this function.
        let (sines, cosines) = unsafe { functions::sin_cos(angle(0), angle(1), angle(2), angle(3)) };
        sines.into_iter().zip(cosines).enumerate().for_each(|(k, (sin, cos))| take(k, [sin, cos]));
    }
}

/// Four doubles within one cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Quad([f64; 4]);

impl Element for [f64; 4] {
    type Stored = Quad;
    const WIDTH: Width = Width::Four;
    const ANGLES: usize = 1;

    #[inline]
    fn store(self) -> Quad {
        Quad(self)
    }
    #[inline]
    fn load(stored: Quad) -> Self {
        stored.0
    }
    #[inline]
    fn splat(value: f64) -> Self {
        [value; 4]
    }
    #[inline]
    fn map_lanes(self, function: impl Fn(f64) -> f64) -> Self {
        self.map(function)
    }
    #[inline]
    unsafe fn sin_cos(angle: impl Fn(usize) -> Self, mut take: impl FnMut(usize, [Self; 2])) {
        let [a, b, c, d] = angle(0);
        // SAFETY: the contract of this function.
        let (sines, cosines) = unsafe { functions::sin_cos(a, b, c, d) };
        take(0, [sines, cosines]);
    }
}
