//! Positions of the entries of a matrix that can differ from zero.

/// A set of positions (i, j) in an n x n matrix: row i is a set of bits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Pattern {
    n: usize,
    words: usize,
    bits: Vec<u64>,
}

impl Pattern {
    /// The empty set.
    fn empty(n: usize) -> Self {
        let words = n.div_ceil(64);
        Self { n, words, bits: vec![0; n * words] }
    }

    /// The positions (i, j), j in the row i.
    pub fn from_rows<'a>(n: usize, row: impl Fn(usize) -> &'a [usize]) -> Self {
        let mut pattern = Self::empty(n);
        for i in 0..n {
            row(i).iter().for_each(|&j| pattern.insert(i, j));
        }
        pattern
    }

    fn insert(&mut self, i: usize, j: usize) {
        self.bits[i * self.words + j / 64] |= 1 << (j % 64);
    }

    /// Number of rows and columns.
    pub fn size(&self) -> usize {
        self.n
    }

    /// Whether it contains (i, j).
    pub fn has(&self, i: usize, j: usize) -> bool {
        self.bits[i * self.words + j / 64] >> (j % 64) & 1 == 1
    }

    /// Row i.
    fn row(&self, i: usize) -> &[u64] {
        &self.bits[i * self.words..][..self.words]
    }

    /// The columns in any of these rows, as bits.
    pub fn columns_of(&self, rows: impl IntoIterator<Item = usize>) -> Vec<u64> {
        let mut columns = vec![0; self.words];
        for i in rows {
            columns.iter_mut().zip(self.row(i)).for_each(|(columns, row)| *columns |= row);
        }
        columns
    }

    /// The same with the diagonal.
    pub fn with_diagonal(&self) -> Self {
        self.with_diagonal_to(self.n)
    }

    /// The same with so many entries of the diagonal.
    pub fn with_diagonal_to(&self, count: usize) -> Self {
        let mut with = self.clone();
        (0..count).for_each(|i| with.insert(i, i));
        with
    }

    /// The same positions in a larger matrix.
    pub fn enlarged(&self, n: usize) -> Self {
        let mut enlarged = Self::empty(n.max(self.n));
        for i in 0..self.n {
            (0..self.n).filter(|&j| self.has(i, j)).for_each(|j| enlarged.insert(i, j));
        }
        enlarged
    }

    /// The union with another set.
    pub fn or(&self, other: &Self) -> Self {
        let mut union = self.clone();
        union.bits.iter_mut().zip(&other.bits).for_each(|(bits, other)| *bits |= other);
        union
    }

    /// The positions on and below the diagonal.
    pub fn lower(&self) -> Self {
        let mut lower = Self::empty(self.n);
        for i in 0..self.n {
            (0..=i).filter(|&j| self.has(i, j)).for_each(|j| lower.insert(i, j));
        }
        lower
    }

    /// The positions (j, i).
    pub fn transposed(&self) -> Self {
        let mut transposed = Self::empty(self.n);
        for i in 0..self.n {
            (0..self.n).filter(|&j| self.has(i, j)).for_each(|j| transposed.insert(j, i));
        }
        transposed
    }

    /// The entries of the product A B that can differ from zero.
    pub fn times(&self, other: &Self) -> Self {
        let mut product = Self::empty(self.n);
        for i in 0..self.n {
            let columns = other.columns_of((0..self.n).filter(|&k| self.has(i, k)));
            product.bits[i * self.words..][..self.words].copy_from_slice(&columns);
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::Pattern;

    #[test]
    fn a_product_of_patterns_has_the_entries_of_a_product_of_matrices() {
        let n = 70;
        let (a, b): (Vec<Vec<usize>>, Vec<Vec<usize>>) = (0..n)
            .map(|i| {
                let some = |step: usize| (0..n).filter(|j| (7 * i + j * j) % step == 0).collect::<Vec<_>>();
                (some(11), some(13))
            })
            .unzip();
        let (a, b) = (Pattern::from_rows(n, |i| &a[i]), Pattern::from_rows(n, |i| &b[i]));
        let (product, across) = (a.times(&b), a.transposed());
        for i in 0..n {
            for j in 0..n {
                assert_eq!(product.has(i, j), (0..n).any(|k| a.has(i, k) && b.has(k, j)));
                assert_eq!(across.has(i, j), a.has(j, i));
                assert_eq!(a.or(&b).has(i, j), a.has(i, j) || b.has(i, j));
                assert_eq!(a.with_diagonal().has(i, j), a.has(i, j) || i == j);
            }
        }
    }
}
