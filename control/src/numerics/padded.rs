//! Rows as long as whole vectors of the processor, so that loops over them leave no rest.

/// Numbers of the widest vectors.
pub(crate) const LANES: usize = 8;

/// Most vectors of a row that are summed at once.
const MOST_VECTORS: usize = 3;

/// The least length of a row with room for so many numbers.
pub(crate) fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// `a b + c`: with one rounding where the processor has an instruction for it.
#[inline(always)]
pub(crate) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The vectors of a row.
#[inline(always)]
fn vectors(row: &[f64]) -> &[[f64; LANES]] {
    row.as_chunks().0
}

/// `to = sum of factors times rows`.
// A loop over single numbers: compilers make gathers of one over whole vectors.
#[inline(always)]
pub(crate) fn combine<const FUSED: bool>(to: &mut [f64], [f, g, h]: [f64; 3], [x, y, z]: [&[f64]; 3]) {
    for (((to, x), y), z) in to.iter_mut().zip(x).zip(y).zip(z) {
        *to = multiply_add::<FUSED>(f, *x, multiply_add::<FUSED>(g, *y, h * z));
    }
}

/// `to += sum of factors times rows`: the rows, one after the other, are padded to the length of `to`.
#[inline(always)]
pub(crate) fn add_rows<const FUSED: bool>(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    let width = to.len();
    for (v, to) in to.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let mut sum = *to;
        for (row, factor) in rows.chunks_exact(width).zip(factors) {
            let row = &vectors(row)[v];
            for c in 0..LANES {
                sum[c] = multiply_add::<FUSED>(*factor, row[c], sum[c]);
            }
        }
        *to = sum;
    }
}

/// `H += J' C J`: the rows of H and J are padded to `width`, C is diagonal. The first `columns` of J, no more
/// than H has rows, are not zero.
#[inline(always)]
pub(crate) fn add_squares<const FUSED: bool>(
    hessian: &mut [f64],
    [width, columns]: [usize; 2],
    curvatures: &[f64],
    rows: &[f64],
) {
    let (hessian, vectors) = (&mut hessian[..width * columns], padded(columns) / LANES);
    // Vectors that stay in registers: each factor is made once for all of them.
    for first in (0..vectors).step_by(MOST_VECTORS) {
        match vectors - first {
            1 => add_squares_to::<FUSED, 1>(hessian, [width, first], curvatures, rows),
            2 => add_squares_to::<FUSED, 2>(hessian, [width, first], curvatures, rows),
            _ => add_squares_to::<FUSED, MOST_VECTORS>(hessian, [width, first], curvatures, rows),
        }
    }
}

/// The same for the vectors `first` to `first + V` of the rows of H.
#[inline(always)]
fn add_squares_to<const FUSED: bool, const V: usize>(
    hessian: &mut [f64],
    [width, first]: [usize; 2],
    curvatures: &[f64],
    rows: &[f64],
) {
    for (i, to) in hessian.chunks_exact_mut(width).enumerate() {
        let to: &mut [[f64; LANES]; V] = &mut to.as_chunks_mut::<LANES>().0[first..].as_chunks_mut().0[0];
        let mut sums = *to;
        for (row, curvature) in rows.chunks_exact(width).zip(curvatures) {
            let vectors: &[[f64; LANES]; V] = &vectors(row)[first..].as_chunks().0[0];
            let factor = curvature * row[i];
            for (sum, vector) in sums.iter_mut().zip(vectors) {
                for c in 0..LANES {
                    sum[c] = multiply_add::<FUSED>(factor, vector[c], sum[c]);
                }
            }
        }
        *to = sums;
    }
}

/// Rows of three parts, padded beyond the last one, with `B` factors for each part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts<'a, const B: usize> {
    pub rows: &'a [f64],
    pub factors: [[f64; B]; 3],
}

/// `B` sums, over all `terms`, of the factors times the parts of row `i`: the vector from `at` of each part.
/// Rows have `width` numbers, and their parts `n`.
#[inline(always)]
pub(crate) fn sums_of_parts<'a, const FUSED: bool, const B: usize>(
    terms: impl Iterator<Item = Parts<'a, B>>,
    [i, width, n, at]: [usize; 4],
) -> [[f64; LANES]; B] {
    let mut sums = [[0.0; LANES]; B];
    for Parts { rows, factors } in terms {
        let row = &rows[width * i..][..width];
        for (s, factors) in factors.iter().enumerate() {
            let part: &[f64; LANES] = vectors_from(row, n * s + at);
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for c in 0..LANES {
                    sum[c] = multiply_add::<FUSED>(*factor, part[c], sum[c]);
                }
            }
        }
    }
    sums
}

/// The vector that begins at a number of a row.
#[inline(always)]
fn vectors_from(row: &[f64], at: usize) -> &[f64; LANES] {
    &vectors(&row[at..at + LANES])[0]
}

/// Copies rows of length `from` into padded ones of length `to`.
#[inline(always)]
pub(crate) fn pad(rows: &[f64], from: usize, padded: &mut [f64], to: usize) {
    for (padded, row) in padded.chunks_exact_mut(to).zip(rows.chunks_exact(from)) {
        for (padded, entry) in padded.iter_mut().zip(row) {
            *padded = *entry;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_are_those_of_dense_matrices() {
        let mut random = fastrand::Rng::with_seed(1);
        // Rows of two, three and four vectors; then rows that are zero but for their first entries.
        for (n, columns) in [(11, 11), (20, 20), (27, 27), (20, 7)] {
            squares_are_dense(n, columns, &mut random);
        }
    }

    fn squares_are_dense(n: usize, columns: usize, random: &mut fastrand::Rng) {
        let (count, width) = (3, padded(n));
        let mut entry = |at: usize| if at % n < columns { random.f64() - 0.5 } else { 0.0 };
        let rows: Vec<f64> = (0..n * count).map(&mut entry).collect();
        let curvatures: Vec<f64> = (0..count).map(|_| random.f64()).collect();
        let mut padded = vec![0.0; width * count];
        pad(&rows, n, &mut padded, width);
        let mut hessian = vec![1.0; width * n];
        add_squares::<false>(&mut hessian, [width, columns], &curvatures, &padded);
        for i in 0..n {
            for j in 0..n {
                let sum: f64 = (0..count).map(|k| curvatures[k] * rows[n * k + i] * rows[n * k + j]).sum();
                assert!((hessian[width * i + j] - 1.0 - sum).abs() < 1e-15, "{n} {i} {j}");
            }
        }
    }

    #[test]
    fn rows_are_combined() {
        let rows = [[1.0; LANES], [2.0; LANES], [3.0; LANES]];
        let mut sum = [5.0; LANES];
        add_rows::<false>(&mut sum, &[1.0, 10.0, 100.0], rows.as_flattened());
        assert_eq!(sum, [326.0; LANES]);
        combine::<false>(&mut sum, [1.0, 10.0, 100.0], rows.each_ref().map(|row| &row[..]));
        assert_eq!(sum, [321.0; LANES]);
    }

    #[test]
    fn parts_of_rows_are_summed() {
        // Two rows with three parts of two numbers each, padded.
        let n = 2;
        let width = padded(2 * n + padded(n));
        let rows: Vec<f64> = (0..2 * width).map(|at| at as f64).collect();
        let factors = [[[1.0, 2.0], [10.0, 0.0], [100.0, 0.0]], [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]]];
        let terms = factors.map(|factors| Parts { rows: &rows, factors });
        let [sum, other] = sums_of_parts::<false, 2>(terms.into_iter(), [1, width, n, 0]);
        let of = |c: usize| {
            let at = |s: usize| (width + n * s + c) as f64;
            at(0) + 10.0 * at(1) + 101.0 * at(2)
        };
        assert_eq!(sum[..n], [of(0), of(1)]);
        assert_eq!(other[..n], [0, 1].map(|c| 3.0 * (width + c) as f64));
    }
}
