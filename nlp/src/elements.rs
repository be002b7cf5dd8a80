//! Vectors, and products with the blocks of elements.

use crate::dense::Dense;
use crate::layout::{Element, Layout};
use crate::tiles::{LANES, Sums, add_all_rows, add_entries, add_rows, four, fused, products};

/// A square matrix of zeros for each element, its rows padded for tiles.
pub(crate) fn squares(layout: &Layout) -> Vec<Dense> {
    let square = |width: usize| Dense::zeros(width, width.next_multiple_of(LANES));
    layout.elements().map(|element| square(layout.width(element))).collect()
}

/// Entries of one element, twice, and partial sums of scalar products.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    first: Vec<f64>,
    second: Vec<f64>,
    pub sums: Sums,
}

impl Room {
    /// For any element.
    pub fn new(layout: &Layout) -> Self {
        let most = layout.elements().map(|element| layout.width(element)).max().unwrap_or(0);
        Self { first: vec![0.0; most], second: vec![0.0; most], sums: Sums::default() }
    }

    /// For an element with so many unknowns.
    #[inline(always)]
    pub fn of(&mut self, width: usize) -> (&mut [f64], &mut [f64], &mut Sums) {
        (&mut self.first[..width], &mut self.second[..width], &mut self.sums)
    }
}

/// A Jacobian, the rows of which are multiplied by factors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jacobian<'a> {
    pub rows: &'a Dense,
    pub pattern: &'a Pattern,
    pub factors: &'a [f64],
}

/// Rows with more entries that are not zero, or more than one in four, are dense ones: from there on products
/// of whole vectors are faster than those of single entries.
const MOST_ENTRIES: usize = 8;

/// Most entries of sparse rows of this length.
fn most_entries(width: usize) -> usize {
    (width / 4).clamp(1, MOST_ENTRIES)
}

/// Which rows of a Jacobian have few entries that are not zero, such as limits of one unknown, or of a joint
/// at a point between nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pattern {
    /// Rows, and where their entries end in the list of all of them.
    sparse: Vec<(usize, usize)>,
    /// Columns in their order, and entries.
    entries: Vec<(usize, f64)>,
    pub dense: Vec<usize>,
}

impl Pattern {
    /// Of so many rows, all dense, for good.
    pub fn dense(rows: usize) -> Self {
        Self { dense: (0..rows).collect(), ..Self::default() }
    }

    /// With room for that of so many rows of this length.
    pub fn with_room(rows: usize, width: usize) -> Self {
        let entries = Vec::with_capacity(most_entries(width) * rows);
        Self { sparse: Vec::with_capacity(rows), entries, ..Self::dense(rows) }
    }

    /// That of these rows.
    #[inline(always)]
    pub fn set(&mut self, rows: &Dense) {
        self.sparse.clear();
        self.entries.clear();
        self.dense.clear();
        for i in 0..rows.rows() {
            match add_entries(rows.row(i), most_entries(rows.columns()), &mut self.entries) {
                true => self.sparse.push((i, self.entries.len())),
                false => self.dense.push(i),
            }
        }
    }

    /// The rows with few entries: columns in their order, and entries.
    #[inline(always)]
    pub fn sparse(&self) -> impl Iterator<Item = (usize, &[(usize, f64)])> {
        let mut first = 0;
        self.sparse.iter().map(move |&(row, end)| {
            let entries = &self.entries[first..end];
            first = end;
            (row, entries)
        })
    }

    /// The dense rows, four at a time; the last ones are repeated.
    #[inline(always)]
    pub fn fours(&self) -> impl Iterator<Item = [usize; 4]> {
        self.dense.chunks(4).map(|rows| four(|r| rows[r.min(rows.len() - 1)]))
    }
}

/// The entries of a vector that an element depends on, in the order of its columns, times factors.
#[inline(always)]
pub(crate) fn gather(layout: &Layout, element: Element, (from, factors): (&[f64], &[f64]), to: &mut [f64]) {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let (from, factors) = (&from[range.clone()], &factors[range]);
        let end = at + from.len();
        let to = to[at..end].iter_mut();
        to.zip(from.iter().zip(factors)).for_each(|(to, (from, factor))| *to = from * factor);
        at = end;
    }
}

/// Adds the entries of an element, times factors, to a vector.
#[inline(always)]
pub(crate) fn scatter(layout: &Layout, element: Element, from: &[f64], (to, factors): (&mut [f64], &[f64])) {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let (to, factors) = (&mut to[range.clone()], &factors[range]);
        let end = at + to.len();
        let from = from[at..end].iter();
        to.iter_mut().zip(from.zip(factors)).for_each(|(to, (from, factor))| *to += from * factor);
        at = end;
    }
}

/// `to = A d`, for the entries d of an element.
#[inline(always)]
pub(crate) fn times<const FUSED: bool>(
    Jacobian { rows, pattern, factors }: Jacobian<'_>,
    d: &[f64],
    to: &mut [f64],
    sums: &mut Sums,
) {
    for (i, entries) in pattern.sparse() {
        to[i] = factors[i] * entries.iter().map(|&(column, entry)| entry * d[column]).sum::<f64>();
    }
    for places in pattern.fours() {
        let found = products::<FUSED>(four(|r| rows.row(places[r])), d, sums);
        places.into_iter().zip(found).for_each(|(i, product)| to[i] = factors[i] * product);
    }
}

/// `to += A' y`, for the entries `to` of an element.
#[inline(always)]
pub(crate) fn add_transposed<const FUSED: bool>(
    Jacobian { rows, pattern, factors }: Jacobian<'_>,
    y: &[f64],
    to: &mut [f64],
) {
    for (i, entries) in pattern.sparse() {
        let factor = factors[i] * y[i];
        for &(column, entry) in entries {
            to[column] = fused::<FUSED>(factor, entry, to[column]);
        }
    }
    let row = |&i: &usize| (rows.row(i), factors[i] * y[i]);
    add_all_rows::<FUSED>(pattern.dense.iter().map(row), to);
}

/// `to += W d`, of the upper triangle of W.
#[inline(always)]
pub(crate) fn add_symmetric<const FUSED: bool>(hessian: &Dense, d: &[f64], to: &mut [f64], sums: &mut Sums) {
    let n = d.len();
    let whole = n / 4 * 4;
    for i in (0..whole).step_by(4) {
        // The square on the diagonal, then the rest of its rows.
        let [a, b, c, e] = four(|r| hessian.row(i + r)[i..n].split_at(4));
        let [p, q, r, s] = [d[i], d[i + 1], d[i + 2], d[i + 3]];
        let square = [
            (a.0[0] * p + a.0[1] * q) + (a.0[2] * r + a.0[3] * s),
            (a.0[1] * p + b.0[1] * q) + (b.0[2] * r + b.0[3] * s),
            (a.0[2] * p + b.0[2] * q) + (c.0[2] * r + c.0[3] * s),
            (a.0[3] * p + b.0[3] * q) + (c.0[3] * r + e.0[3] * s),
        ];
        let rows = [a.1, b.1, c.1, e.1];
        let found = products::<FUSED>(rows, &d[i + 4..], sums);
        add_rows::<FUSED>(rows, [p, q, r, s], &mut to[i + 4..]);
        for r in 0..4 {
            to[i + r] += square[r] + found[r];
        }
    }
    for row in whole..n {
        to[row] = fused::<FUSED>(hessian[(row, row)], d[row], to[row]);
        for column in row + 1..n {
            let entry = hessian[(row, column)];
            to[row] = fused::<FUSED>(entry, d[column], to[row]);
            to[column] = fused::<FUSED>(entry, d[row], to[column]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Jacobian, MOST_ENTRIES, Pattern, add_symmetric, add_transposed, most_entries, times};
    use crate::dense::Dense;
    use crate::tiles::Sums;

    /// Products of blocks of all sizes with vectors, against sums over all entries.
    #[test]
    fn products_are_those_of_all_entries() {
        let mut random = fastrand::Rng::with_seed(7);
        let mut number = || 2.0 * random.f64() - 1.0;
        for n in 0..40 {
            let mut dense = |rows: usize| {
                let mut matrix = Dense::zeros(rows, n);
                matrix.entries_mut().iter_mut().for_each(|entry| *entry = number());
                matrix
            };
            // Full rows, then one without entries, with one, two and so on.
            let full = 1 + n % 6;
            let rows = full + 1 + (MOST_ENTRIES + 1).min(n);
            let (hessian, mut jacobian) = (dense(n), dense(rows));
            for count in 0..rows - full {
                let row = jacobian.row_mut(full + count);
                row.fill(0.0);
                (0..count).for_each(|entry| row[n - 1 - entry * n / count] = 3.0 - entry as f64 / 7.0);
            }
            let mut pattern = Pattern::with_room(rows, n);
            pattern.set(&jacobian);
            let most = most_entries(n);
            let few = (0..rows).filter(|&i| if i < full { n <= most } else { i - full <= most });
            assert!(pattern.sparse().map(|(i, _)| i).eq(few), "{n}");
            let mut vector = |len: usize| -> Vec<f64> { (0..len).map(|_| number()).collect() };
            let (d, start) = (vector(n), vector(n));
            let (y, factors) = (vector(jacobian.rows()), vector(jacobian.rows()));
            for pattern in [&pattern, &Pattern::dense(rows)] {
                let rows = Jacobian { rows: &jacobian, pattern, factors: &factors };
                let (mut sums, mut found) = (Sums::default(), start.clone());
                add_symmetric::<false>(&hessian, &d, &mut found, &mut sums);
                add_transposed::<false>(rows, &y, &mut found);
                for i in 0..n {
                    let of_hessian: f64 = (0..n).map(|j| hessian[(i.min(j), i.max(j))] * d[j]).sum();
                    let of_rows: f64 = (0..y.len()).map(|r| jacobian[(r, i)] * factors[r] * y[r]).sum();
                    assert!((found[i] - start[i] - of_hessian - of_rows).abs() < 1e-13, "{n} {i}");
                }
                let mut products = vec![f64::NAN; y.len()];
                times::<false>(rows, &d, &mut products, &mut sums);
                for (r, product) in products.iter().enumerate() {
                    let expected: f64 = (0..n).map(|j| jacobian[(r, j)] * d[j]).sum();
                    assert!((product - factors[r] * expected).abs() < 1e-13, "{n} {r}");
                }
            }
        }
    }
}
