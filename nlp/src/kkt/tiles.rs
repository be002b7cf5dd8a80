//! The innermost loops of the factorisation: parts of columns that fit into registers.

use super::front::LANES;

/// Factors of a sum of products.
#[inline(always)]
pub(super) fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The largest absolute value.
#[inline(always)]
pub(super) fn largest(values: &[f64]) -> f64 {
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    // From the end: padding makes it a multiple of the vectors.
    let (rest, chunks) = values.as_rchunks::<LANES>();
    let mut most = [0.0; LANES];
    for chunk in chunks {
        for lane in 0..LANES {
            most[lane] = larger(most[lane], chunk[lane].abs());
        }
    }
    let [p, q, r, s] = most;
    rest.iter().fold(larger(larger(p, q), larger(r, s)), |most, value| larger(most, value.abs()))
}

/// Keeps values in `product`, and multiplies them by a factor.
#[inline(always)]
pub(super) fn scale(values: &mut [f64], factor: f64, product: &mut [f64]) {
    for (value, product) in
        values.as_chunks_mut::<LANES>().0.iter_mut().zip(product.as_chunks_mut::<LANES>().0)
    {
        *product = *value;
        value.iter_mut().for_each(|value| *value *= factor);
    }
}

/// `a_ij -= sum_k l_ik p_jk` for rows i from `first` on, of four, two or one of `count` columns from j on:
/// returns how many. `to` begins with column j.
#[inline(always)]
pub(super) fn update<const FUSED: bool>(
    (columns, products): (&[f64], &[f64]),
    to: &mut [f64],
    stride: usize,
    (j, count): (usize, usize),
    first: usize,
) -> usize {
    let from = (columns, products);
    let mut row = first;
    if count >= 4 {
        while row + 8 <= stride {
            tile::<FUSED, 4, 8>(from, to, stride, j, row);
            row += 8;
        }
        if row < stride {
            tile::<FUSED, 4, 4>(from, to, stride, j, row);
        }
        return 4;
    }
    if count >= 2 {
        while row + 8 <= stride {
            tile::<FUSED, 2, 8>(from, to, stride, j, row);
            row += 8;
        }
        if row < stride {
            tile::<FUSED, 2, 4>(from, to, stride, j, row);
        }
        return 2;
    }
    while row + 16 <= stride {
        tile::<FUSED, 1, 16>(from, to, stride, j, row);
        row += 16;
    }
    while row < stride {
        tile::<FUSED, 1, 4>(from, to, stride, j, row);
        row += 4;
    }
    1
}

/// The same for R rows from `row` on, of W columns.
#[inline(always)]
fn tile<const FUSED: bool, const W: usize, const R: usize>(
    (columns, products): (&[f64], &[f64]),
    to: &mut [f64],
    stride: usize,
    j: usize,
    row: usize,
) {
    let mut sums = [[0.0; R]; W];
    for (sum, to) in sums.iter_mut().zip(to.chunks_exact(stride)) {
        sum.copy_from_slice(&to[row..row + R]);
    }
    for (column, weights) in columns.chunks_exact(stride).zip(products.chunks_exact(stride)) {
        let (column, weights) = (&column[row..row + R], &weights[j..j + W]);
        for w in 0..W {
            for r in 0..R {
                sums[w][r] = fused::<FUSED>(-weights[w], column[r], sums[w][r]);
            }
        }
    }
    for (sum, to) in sums.iter().zip(to.chunks_exact_mut(stride)) {
        to[row..row + R].copy_from_slice(sum);
    }
}
