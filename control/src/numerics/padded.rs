//! Rows as long as whole vectors of the processor, so that loops over them leave no rest.

/// Numbers of the widest vectors.
pub(crate) const LANES: usize = 8;

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

/// `H += J' C J`: the rows of H and J are padded to `width`, C is diagonal.
#[inline(always)]
pub(crate) fn add_squares<const FUSED: bool>(
    hessian: &mut [f64],
    width: usize,
    curvatures: &[f64],
    rows: &[f64],
) {
    for (i, to) in hessian.chunks_exact_mut(width).enumerate() {
        for (v, to) in to.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let mut sum = *to;
            for (row, curvature) in rows.chunks_exact(width).zip(curvatures) {
                let (factor, row) = (curvature * row[i], &vectors(row)[v]);
                for c in 0..LANES {
                    sum[c] = multiply_add::<FUSED>(factor, row[c], sum[c]);
                }
            }
            *to = sum;
        }
    }
}

/// Rows of three parts, padded beyond the last one, with a factor for each part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts<'a> {
    pub rows: &'a [f64],
    pub factors: [f64; 3],
}

/// The sum, over all `terms`, of the factors times the parts of row `i`: the vector from `at` of each part.
/// Rows have `width` numbers, and their parts `n`.
#[inline(always)]
pub(crate) fn sum_of_parts<'a, const FUSED: bool>(
    terms: impl Iterator<Item = Parts<'a>>,
    [i, width, n, at]: [usize; 4],
) -> [f64; LANES] {
    let mut sum = [0.0; LANES];
    for Parts { rows, factors } in terms {
        let row = &rows[width * i..][..width];
        for (s, factor) in factors.into_iter().enumerate() {
            let part: &[f64; LANES] = vectors_from(row, n * s + at);
            for c in 0..LANES {
                sum[c] = multiply_add::<FUSED>(factor, part[c], sum[c]);
            }
        }
    }
    sum
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
        let (n, count) = (11, 3);
        let width = padded(n);
        assert_eq!(width, 16);
        let rows: Vec<f64> = (0..n * count).map(|_| random.f64() - 0.5).collect();
        let curvatures: Vec<f64> = (0..count).map(|_| random.f64()).collect();
        let mut padded = vec![0.0; width * count];
        pad(&rows, n, &mut padded, width);
        let mut hessian = vec![1.0; width * n];
        add_squares::<false>(&mut hessian, width, &curvatures, &padded);
        for i in 0..n {
            for j in 0..n {
                let sum: f64 = (0..count).map(|k| curvatures[k] * rows[n * k + i] * rows[n * k + j]).sum();
                assert!((hessian[width * i + j] - 1.0 - sum).abs() < 1e-15, "{i} {j}");
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
        let terms = [[1.0, 10.0, 100.0], [0.0, 0.0, 1.0]].map(|factors| Parts { rows: &rows, factors });
        let sum = sum_of_parts::<false>(terms.into_iter(), [1, width, n, 0]);
        let of = |c: usize| {
            let at = |s: usize| (width + n * s + c) as f64;
            at(0) + 10.0 * at(1) + 101.0 * at(2)
        };
        assert_eq!(sum[..n], [of(0), of(1)]);
    }
}
