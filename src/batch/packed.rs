//! Scalars that hold the values of several nodes.

use crate::scalar::{Count, Scalar, Tangent};
use num_dual::{Dual, DualNum};

/// A scalar with the values of [`LANES`](Self::LANES) nodes; one for `f64`.
///
/// The arrays of a batch have the element type [`Lane`](Self::Lane): `f64` for `f64` and its lanes, a dual
/// number over `f64` for a dual number over lanes.
pub trait Packed: Scalar + Send + Sync {
    /// The scalar of one node.
    type Lane: Scalar + Send + Sync;

    /// Number of nodes per scalar.
    const LANES: usize;

    /// The value of node `k`.
    fn lane(&self, k: usize) -> Self::Lane;

    /// Sets the value of node `k`.
    fn set_lane(&mut self, k: usize, value: Self::Lane);

    /// Packs consecutive nodes of `width` entries each: lane k of `into[j]` is entry j of node k.
    ///
    /// If there are fewer nodes than lanes, the last one is repeated; if there is none, nothing is done.
    #[inline]
    fn gather(nodes: &[Self::Lane], width: usize, into: &mut [Self]) {
        gather_columns(nodes, width, into, 0);
    }

    /// The inverse of [`gather`](Self::gather), for as many nodes as `nodes` can hold.
    #[inline]
    fn scatter(from: &[Self], width: usize, nodes: &mut [Self::Lane]) {
        scatter_columns(from, width, nodes, 0);
    }
}

/// [`Packed::gather`], entry by entry, from column `start`.
#[inline]
fn gather_columns<S: Packed>(nodes: &[S::Lane], width: usize, into: &mut [S], start: usize) {
    let Some(last) = (nodes.len() / width.max(1)).checked_sub(1) else { return };
    for j in start..width.min(into.len()) {
        for k in 0..S::LANES {
            into[j].set_lane(k, nodes[k.min(last) * width + j]);
        }
    }
}

/// [`Packed::scatter`], entry by entry, from column `start`.
#[inline]
fn scatter_columns<S: Packed>(from: &[S], width: usize, nodes: &mut [S::Lane], start: usize) {
    for k in 0..(nodes.len() / width.max(1)).min(S::LANES) {
        for j in start..width.min(from.len()) {
            nodes[k * width + j] = from[j].lane(k);
        }
    }
}

/// A scalar with one lane.
macro_rules! impl_packed_alone {
    ($($scalar:ty),*) => {$(
        impl Packed for $scalar {
            type Lane = Self;
            const LANES: usize = 1;
            #[inline(always)]
            fn lane(&self, _: usize) -> Self {
                *self
            }
            #[inline(always)]
            fn set_lane(&mut self, _: usize, value: Self) {
                *self = value;
            }
            #[inline]
            fn gather(nodes: &[Self], width: usize, into: &mut [Self]) {
                let reach = width.min(nodes.len()).min(into.len());
                into[..reach].copy_from_slice(&nodes[..reach]);
            }
            #[inline]
            fn scatter(from: &[Self], width: usize, nodes: &mut [Self]) {
                let reach = width.min(nodes.len()).min(from.len());
                nodes[..reach].copy_from_slice(&from[..reach]);
            }
        }
    )*};
}

impl_packed_alone!(f64, f32, Count);

/// A scalar with two components.
macro_rules! impl_packed_by_parts {
    ($dual:ident, $($bound:ident)?) => {
        impl<S: Packed<Lane: $($bound +)? Scalar> $(+ $bound)? + Send + Sync> Packed for $dual<S>
        where
            $dual<S>: Scalar + Send + Sync,
            $dual<S::Lane>: Scalar + Send + Sync,
        {
            type Lane = $dual<S::Lane>;
            const LANES: usize = S::LANES;
            #[inline(always)]
            fn lane(&self, k: usize) -> Self::Lane {
                $dual::new(self.re.lane(k), self.eps.lane(k))
            }
            #[inline(always)]
            fn set_lane(&mut self, k: usize, value: Self::Lane) {
                self.re.set_lane(k, value.re);
                self.eps.set_lane(k, value.eps);
            }
        }
    };
}

impl_packed_by_parts!(Tangent,);
impl_packed_by_parts!(Dual, DualNum);

/// Size of the square blocks that are transposed in registers.
#[cfg(feature = "wide")]
const QUAD: usize = 4;

/// Transposes a block of four rows of four entries.
#[cfg(feature = "wide")]
#[inline(always)]
fn transposed(rows: [&[f64; QUAD]; QUAD]) -> [wide::f64x4; QUAD] {
    let [a, b, c, d] = rows;
    wide::f64x4::transpose([
        wide::f64x4::new(*a),
        wide::f64x4::new(*b),
        wide::f64x4::new(*c),
        wide::f64x4::new(*d),
    ])
}

/// Blocks of four nodes and four entries are transposed in registers; the rest is copied entry by entry.
#[cfg(feature = "wide")]
macro_rules! impl_packed_for_lanes {
    ($($scalar:ty, $lanes:literal;)*) => {$(
        impl Packed for $scalar {
            type Lane = f64;
            const LANES: usize = $lanes;
            #[inline(always)]
            fn lane(&self, k: usize) -> f64 {
                self.as_slice()[k]
            }
            #[inline(always)]
            fn set_lane(&mut self, k: usize, value: f64) {
                self.as_mut_slice()[k] = value;
            }
            fn gather(nodes: &[f64], width: usize, into: &mut [Self]) {
                let squares = width / QUAD;
                if nodes.len() != $lanes * width || into.len() < width || squares == 0 {
                    return gather_columns(nodes, width, into, 0);
                }
                for (k, quad) in nodes.chunks_exact(QUAD * width).enumerate() {
                    let [first, second, third, fourth] = rows(quad, width);
                    let above = first.iter().zip(second).zip(third.iter().zip(fourth));
                    for (square, ((a, b), (c, d))) in into.as_chunks_mut::<QUAD>().0.iter_mut().zip(above) {
                        let columns = transposed([a, b, c, d]);
                        for (packed, column) in square.iter_mut().zip(&columns) {
                            let lanes = &mut packed.as_mut_slice()[QUAD * k..QUAD * (k + 1)];
                            lanes.copy_from_slice(column.as_array());
                        }
                    }
                }
                gather_columns(nodes, width, into, squares * QUAD);
            }
            fn scatter(from: &[Self], width: usize, nodes: &mut [f64]) {
                let squares = width / QUAD;
                if nodes.len() != $lanes * width || from.len() < width || squares == 0 {
                    return scatter_columns(from, width, nodes, 0);
                }
                for (k, quad) in nodes.chunks_exact_mut(QUAD * width).enumerate() {
                    let (upper, lower) = quad.split_at_mut(2 * width);
                    let (first, second) = upper.split_at_mut(width);
                    let (third, fourth) = lower.split_at_mut(width);
                    let upper = first.as_chunks_mut().0.iter_mut().zip(second.as_chunks_mut().0);
                    let lower = third.as_chunks_mut().0.iter_mut().zip(fourth.as_chunks_mut().0);
                    for ([p, q, r, s], ((a, b), (c, d))) in from.as_chunks().0.iter().zip(upper.zip(lower)) {
                        let quarters = [p, q, r, s].map(|packed| quarter(packed.as_slice(), k));
                        let [column_a, column_b, column_c, column_d] = transposed(quarters);
                        (*a, *b) = (column_a.to_array(), column_b.to_array());
                        (*c, *d) = (column_c.to_array(), column_d.to_array());
                    }
                }
                scatter_columns(from, width, nodes, squares * QUAD);
            }
        }
    )*};
}

/// Lanes 4 k to 4 k + 3.
#[cfg(feature = "wide")]
#[inline(always)]
fn quarter(lanes: &[f64], k: usize) -> &[f64; QUAD] {
    &lanes.as_chunks().0[k]
}

/// Four nodes of so many entries, four entries at a time.
#[cfg(feature = "wide")]
#[inline(always)]
fn rows(quad: &[f64], width: usize) -> [&[[f64; QUAD]]; QUAD] {
    let (upper, lower) = quad.split_at(2 * width);
    let ((a, b), (c, d)) = (upper.split_at(width), lower.split_at(width));
    [a.as_chunks().0, b.as_chunks().0, c.as_chunks().0, d.as_chunks().0]
}

#[cfg(feature = "wide")]
impl_packed_for_lanes! { crate::scalar::F64x4, 4; crate::scalar::F64x8, 8; }

#[cfg(test)]
mod tests {
    use super::Packed;
    use crate::scalar::Tangent;

    /// Packing and unpacking returns the same nodes, for any number of them; unused lanes repeat the last
    /// node.
    fn round_trip<S: Packed>(number: impl Fn(f64) -> S::Lane, value: impl Fn(S::Lane) -> f64) {
        for width in 0..20 {
            for count in 1..=S::LANES {
                let entries: Vec<_> = (0..width * count).map(|i| number(i as f64 + 1.0)).collect();
                let mut packed = vec![S::zero(); width];
                S::gather(&entries, width, &mut packed);
                for (j, entry) in packed.iter().enumerate() {
                    for k in 0..S::LANES {
                        let expected = (k.min(count - 1) * width + j) as f64 + 1.0;
                        assert_eq!(value(entry.lane(k)), expected, "{width} entries, {count} nodes");
                    }
                }
                let mut back = vec![number(0.0); width * count];
                S::scatter(&packed, width, &mut back);
                let values = |entries: &[S::Lane]| entries.iter().map(|&x| value(x)).collect::<Vec<_>>();
                assert_eq!(values(&back), values(&entries));
            }
        }
    }

    #[test]
    fn nodes_are_packed_and_unpacked() {
        round_trip::<f64>(|x| x, |x| x);
        round_trip::<f32>(|x| x as f32, f64::from);
        round_trip::<Tangent<f64>>(|x| Tangent::new(x, -x), |x| x.re - 0.0 * x.eps.abs());
        round_trip::<num_dual::Dual64>(|x| num_dual::Dual64::new(0.5, x), |x| x.eps);
    }

    #[cfg(feature = "wide")]
    #[test]
    fn nodes_are_packed_into_lanes_and_unpacked() {
        use crate::scalar::{F64x4, F64x8, Scalar};
        round_trip::<F64x4>(|x| x, |x| x);
        round_trip::<F64x8>(|x| x, |x| x);
        round_trip::<Tangent<F64x4>>(|x| Tangent::new(0.5, x), |x| x.eps);
        round_trip::<num_dual::Dual<F64x8>>(|x| num_dual::Dual::new(x, x + 1.0), |x| x.eps - 1.0);
        assert!(F64x4::zero().lane(3) == 0.0);
    }
}
