//! Rows as long as whole vectors of the processor, so that loops over them leave no rest.

/// Numbers of the widest vectors.
pub(crate) const LANES: usize = 8;

/// The least length of a row with room for so many numbers.
pub(crate) fn padded(count: usize) -> usize {
    count.next_multiple_of(LANES)
}

/// A row of whole vectors.
#[inline(always)]
fn vectors(row: &[f64]) -> impl Iterator<Item = &[f64; LANES]> {
    row.as_chunks::<LANES>().0.iter()
}

/// The same to change.
#[inline(always)]
fn vectors_mut(row: &mut [f64]) -> impl Iterator<Item = &mut [f64; LANES]> {
    row.as_chunks_mut::<LANES>().0.iter_mut()
}

/// `to += factor from`, both padded.
#[inline(always)]
pub(crate) fn add_multiple(to: &mut [f64], factor: f64, from: &[f64]) {
    for (to, from) in vectors_mut(to).zip(vectors(from)) {
        for c in 0..LANES {
            to[c] += factor * from[c];
        }
    }
}

/// `to = sum of factors times rows`, all padded.
#[inline(always)]
pub(crate) fn combine(to: &mut [f64], [f, g, h]: [f64; 3], [x, y, z]: [&[f64]; 3]) {
    for (((to, x), y), z) in vectors_mut(to).zip(vectors(x)).zip(vectors(y)).zip(vectors(z)) {
        for c in 0..LANES {
            to[c] = f * x[c] + (g * y[c] + h * z[c]);
        }
    }
}

/// `to += sum of factors times rows`, all padded.
#[inline(always)]
pub(crate) fn add_combined(to: &mut [f64], [f, g, h]: [f64; 3], [x, y, z]: [&[f64]; 3]) {
    for (((to, x), y), z) in vectors_mut(to).zip(vectors(x)).zip(vectors(y)).zip(vectors(z)) {
        for c in 0..LANES {
            to[c] += f * x[c] + (g * y[c] + h * z[c]);
        }
    }
}

/// `H += J' C J`: the rows of H and J are padded to `width`, C is diagonal. Rows of J whose curvature is zero
/// may be left out.
#[inline(always)]
pub(crate) fn add_squares(hessian: &mut [f64], width: usize, curvatures: &[f64], rows: &[f64]) {
    for (i, to) in hessian.chunks_exact_mut(width).enumerate() {
        for (v, to) in vectors_mut(to).enumerate() {
            let mut sum = *to;
            for (row, curvature) in rows.chunks_exact(width).zip(curvatures) {
                let (factor, row) = (curvature * row[i], row.as_chunks::<LANES>().0);
                for c in 0..LANES {
                    sum[c] += factor * row[v][c];
                }
            }
            *to = sum;
        }
    }
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
        add_squares(&mut hessian, width, &curvatures, &padded);
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
        add_combined(&mut sum, [1.0, 10.0, 100.0], rows.each_ref().map(|row| &row[..]));
        add_multiple(&mut sum, 2.0, &rows[1]);
        assert_eq!(sum, [330.0; LANES]);
        combine(&mut sum, [1.0, 10.0, 100.0], rows.each_ref().map(|row| &row[..]));
        assert_eq!(sum, [321.0; LANES]);
    }
}
