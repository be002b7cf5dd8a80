//! The numbers of machine code: one double, or four doubles of four states.

use crate::assembler::Width;
use crate::error::JitError;
use crate::functions;
use crate::step::Steps;
use std::fmt::Debug;

/// `f64`, or `[f64; 4]` for four states at once.
pub trait JitNumber: Element<Outer = Self> + Pairable {}

impl JitNumber for f64 {}
impl JitNumber for [f64; 4] {}

/// Whether one number can be computed by a program of pairs.
pub trait Pairable: Sized {
    /// Such a program, or nothing.
    type Pairs: RunPairs<Self>;
}

/// A program of pairs as seen by callers with single numbers.
pub trait RunPairs<T>: Debug + Send + Sync {
    /// The program, if there is one that pays.
    fn compile(program: &Steps, images: &[u32], guarded: bool) -> Result<Option<Self>, JitError>
    where
        Self: Sized;
    /// Number of operations.
    fn steps(&self) -> usize;
    /// The machine code.
    fn bytes(&self) -> &[u8];
    /// Runs it and returns the guard.
    fn run(&self, inputs: &[T], outputs: &mut [T]) -> T;
}

/// The operations of a [`JitNumber`]; implemented by this crate only.
pub trait Element: Copy + Debug + 'static {
    /// Its arguments and results, as callers have them.
    type Outer: Copy + Debug;
    /// The same number in memory of the library, aligned so that it never spans two cache lines.
    type Stored: Copy + Debug + Send + Sync;
    /// The operand width of the assembler.
    const WIDTH: Width;
    /// Angles whose sines and cosines are computed together.
    const ANGLES: usize;

    fn store(self) -> Self::Stored;
    fn load(stored: Self::Stored) -> Self;
    /// An argument.
    fn argument(outer: Self::Outer) -> Self;
    /// A pair of arguments, of which only pairs use both.
    fn pair(first: Self::Outer, second: Self::Outer) -> Self;
    /// The number that is a result, of a pair the first one.
    fn result(self) -> Self::Outer;
    /// A constant of a program, of which only pairs use both numbers.
    fn constant(numbers: [f64; 2]) -> Self;
    /// A function of every lane.
    fn map_lanes(self, function: impl Fn(f64) -> f64) -> Self;
    /// Sine and cosine of [`ANGLES`](Self::ANGLES) angles, by their positions.
    ///
    /// # Safety
    /// The processor has AVX2 and FMA.
    unsafe fn sin_cos(angle: impl Fn(usize) -> Self, take: impl FnMut(usize, [Self; 2]));
}

impl Element for f64 {
    type Outer = f64;
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
    fn argument(outer: f64) -> f64 {
        outer
    }
    #[inline]
    fn pair(first: f64, _: f64) -> f64 {
        first
    }
    #[inline]
    fn result(self) -> f64 {
        self
    }
    #[inline]
    fn constant([value, _]: [f64; 2]) -> f64 {
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
    type Outer = Self;
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
    fn argument(outer: Self) -> Self {
        outer
    }
    #[inline]
    fn pair(first: Self, _: Self) -> Self {
        first
    }
    #[inline]
    fn result(self) -> Self {
        self
    }
    #[inline]
    fn constant([value, _]: [f64; 2]) -> Self {
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

/// Two doubles, of a step and its mirror image.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Pair(pub [f64; 2]);

impl Element for Pair {
    type Outer = f64;
    type Stored = Self;
    const WIDTH: Width = Width::Two;
    const ANGLES: usize = 2;

    #[inline]
    fn store(self) -> Self {
        self
    }
    #[inline]
    fn load(stored: Self) -> Self {
        stored
    }
    #[inline]
    fn argument(outer: f64) -> Self {
        Self([outer; 2])
    }
    #[inline]
    fn pair(first: f64, second: f64) -> Self {
        Self([first, second])
    }
    #[inline]
    fn result(self) -> f64 {
        self.0[0]
    }
    #[inline]
    fn constant(numbers: [f64; 2]) -> Self {
        Self(numbers)
    }
    #[inline]
    fn map_lanes(self, function: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(function))
    }
    #[inline]
    unsafe fn sin_cos(angle: impl Fn(usize) -> Self, mut take: impl FnMut(usize, [Self; 2])) {
        let (Self([a, b]), Self([c, d])) = (angle(0), angle(1));
        // SAFETY: the contract of this function.
        let ([sin_a, sin_b, sin_c, sin_d], [cos_a, cos_b, cos_c, cos_d]) =
            unsafe { functions::sin_cos(a, b, c, d) };
        take(0, [Self([sin_a, sin_b]), Self([cos_a, cos_b])]);
        take(1, [Self([sin_c, sin_d]), Self([cos_c, cos_d])]);
    }
}
