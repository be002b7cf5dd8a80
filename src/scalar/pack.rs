//! Packs of one and of four lanes.

#[cfg(feature = "wide")]
use super::Vector;
use super::number::{Pack, Scalar};

/// The largest number of lanes of a pack.
pub(crate) const MOST_LANES: usize = 4;

impl<S: Scalar> Pack<S> for S {
    type Wide = S;
    const LANES: usize = 1;
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: S) -> Self {
        value
    }
    #[inline(always)]
    fn lane(&self, _: usize) -> S {
        *self
    }
    #[inline(always)]
    fn with_lane(self, _: usize, value: S) -> Self {
        value
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: S) {
        *self = value;
    }
    #[inline(always)]
    fn before(self, k: usize, other: Self) -> Self {
        if k == 0 { other } else { self }
    }
    #[inline(always)]
    fn write(&self, to: &mut [S]) {
        to[0] = *self;
    }
    #[inline(always)]
    fn read(from: &[S]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn transpose(_: &mut [Self]) {}
    #[inline(always)]
    fn splat_wide(value: S) -> S {
        value
    }
    #[inline(always)]
    fn join(packs: &[Self]) -> S {
        packs[0]
    }
    #[inline(always)]
    fn split(wide: S, packs: &mut [Self]) {
        packs[0] = wide;
    }
}

#[cfg(feature = "wide")]
impl Pack<f64> for super::F64x4 {
    #[cfg(not(target_feature = "avx512f"))]
    type Wide = Self;
    #[cfg(target_feature = "avx512f")]
    type Wide = super::F64x8;
    const LANES: usize = 4;
    const WIDTH: usize = if cfg!(target_feature = "avx512f") { 2 } else { 1 };

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::from_f64(value)
    }
    #[inline(always)]
    fn lane(&self, k: usize) -> f64 {
        self.as_slice()[k]
    }
    #[inline(always)]
    fn with_lane(self, k: usize, value: f64) -> Self {
        let mask = LANE[k & 3];
        Self::new(Vector::select(mask, wide::f64x4::splat(value), self.vector()))
    }
    #[inline(always)]
    fn set_lane(&mut self, k: usize, value: f64) {
        self.as_mut_slice()[k] = value;
    }
    #[inline(always)]
    fn before(self, k: usize, other: Self) -> Self {
        Self::new(Vector::select(BEFORE[k.min(4)], self.vector(), other.vector()))
    }
    #[inline(always)]
    fn write(&self, to: &mut [f64]) {
        match to.first_chunk_mut::<4>() {
            Some(to) => to.copy_from_slice(self.as_slice()),
            None => write_part(self, to),
        }
    }
    #[inline(always)]
    fn read(from: &[f64]) -> Self {
        if let Some(&four) = from.first_chunk::<4>() {
            return Self::new(wide::f64x4::new(four));
        }
        Self::new(wide::f64x4::new(match *from {
            [a, b, c] => [a, b, c, 0.0],
            [a, b] => [a, b, 0.0, 0.0],
            [a] => [a, 0.0, 0.0, 0.0],
            _ => [0.0; 4],
        }))
    }
    #[inline(always)]
    fn transpose(block: &mut [Self]) {
        if let Some(block) = block.first_chunk_mut::<4>() {
            *block = wide::f64x4::transpose(block.map(|pack| pack.vector())).map(Self::new);
        }
    }
    #[inline(always)]
    fn splat_wide(value: f64) -> Self::Wide {
        Self::Wide::from_f64(value)
    }
    #[cfg(not(target_feature = "avx512f"))]
    #[inline(always)]
    fn join(packs: &[Self]) -> Self {
        packs[0]
    }
    #[cfg(not(target_feature = "avx512f"))]
    #[inline(always)]
    fn split(wide: Self, packs: &mut [Self]) {
        packs[0] = wide;
    }
    #[cfg(target_feature = "avx512f")]
    #[inline(always)]
    fn join(packs: &[Self]) -> Self::Wide {
        let (low, high) = (packs[0].vector().to_array(), packs[1].vector().to_array());
        let [[a, b, c, d], [e, f, g, h]] = [low, high];
        Self::Wide::new(wide::f64x8::new([a, b, c, d, e, f, g, h]))
    }
    #[cfg(target_feature = "avx512f")]
    #[inline(always)]
    fn split(wide: Self::Wide, packs: &mut [Self]) {
        let [a, b, c, d, e, f, g, h] = wide.vector().to_array();
        packs[0] = Self::new(wide::f64x4::new([a, b, c, d]));
        packs[1] = Self::new(wide::f64x4::new([e, f, g, h]));
    }
}

/// Writes fewer lanes than all. Apart: beside it the compiler would write whole packs lane by lane.
#[cfg(feature = "wide")]
#[inline(never)]
fn write_part(pack: &super::F64x4, to: &mut [f64]) {
    match to {
        [x] => *x = pack.lane(0),
        [x, y] => [*x, *y] = [pack.lane(0), pack.lane(1)],
        [x, y, z] => [*x, *y, *z] = [pack.lane(0), pack.lane(1), pack.lane(2)],
        _ => {}
    }
}

/// All bits of a lane.
#[cfg(feature = "wide")]
const ALL: f64 = f64::from_bits(u64::MAX);

/// Masks of the first lanes.
#[cfg(feature = "wide")]
const BEFORE: [wide::f64x4; 5] = [
    wide::f64x4::new([0.0; 4]),
    wide::f64x4::new([ALL, 0.0, 0.0, 0.0]),
    wide::f64x4::new([ALL, ALL, 0.0, 0.0]),
    wide::f64x4::new([ALL, ALL, ALL, 0.0]),
    wide::f64x4::new([ALL; 4]),
];

/// Masks of one lane each.
#[cfg(feature = "wide")]
const LANE: [wide::f64x4; 4] = {
    [
        wide::f64x4::new([ALL, 0.0, 0.0, 0.0]),
        wide::f64x4::new([0.0, ALL, 0.0, 0.0]),
        wide::f64x4::new([0.0, 0.0, ALL, 0.0]),
        wide::f64x4::new([0.0, 0.0, 0.0, ALL]),
    ]
};
