//! Symmetric positive definite matrices with a band.

/// Rows of the lower triangle: entry (i, i - k) of row i at `i (width + 1) + width - k`.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    size: usize,
    width: usize,
    entries: Vec<f64>,
}

impl Band {
    /// Zeros; `width` diagonals beside the main one.
    pub fn zeros(size: usize, width: usize) -> Self {
        Self { size, width, entries: vec![0.0; size * (width + 1)] }
    }

    pub fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    pub fn copy_from(&mut self, other: &Self) {
        self.entries.copy_from_slice(&other.entries);
    }

    /// Entry (i, j), j <= i <= j + width.
    pub fn entry_mut(&mut self, i: usize, j: usize) -> &mut f64 {
        &mut self.entries[i * (self.width + 1) + self.width + j - i]
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.entries[i * (self.width + 1) + self.width + j - i]
    }

    pub fn diagonal(&self, i: usize) -> f64 {
        self.entry(i, i)
    }

    /// `L L' = A` in place; false, and useless entries, where A is not positive definite.
    pub fn factor(&mut self) -> bool {
        for i in 0..self.size {
            let first = i.saturating_sub(self.width);
            for j in first..=i {
                let start = first.max(j.saturating_sub(self.width));
                let sum: f64 = (start..j).map(|k| self.entry(i, k) * self.entry(j, k)).sum();
                let rest = self.entry(i, j) - sum;
                *self.entry_mut(i, j) = if i > j {
                    rest / self.entry(j, j)
                } else if rest > 0.0 && rest.is_finite() {
                    rest.sqrt()
                } else {
                    return false;
                };
            }
        }
        true
    }

    /// `x <- A^-1 x` after [`Band::factor`].
    pub fn solve(&self, x: &mut [f64]) {
        for i in 0..self.size {
            let sum: f64 = (i.saturating_sub(self.width)..i).map(|j| self.entry(i, j) * x[j]).sum();
            x[i] = (x[i] - sum) / self.entry(i, i);
        }
        for i in (0..self.size).rev() {
            x[i] /= self.entry(i, i);
            for j in i.saturating_sub(self.width)..i {
                x[j] -= self.entry(i, j) * x[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_solves() {
        let (size, width) = (9, 3);
        let value = |i: usize, j: usize| {
            if i == j { 5.0 + i as f64 } else { ((i * 7 + j * 3) as f64).sin() }
        };
        let mut band = Band::zeros(size, width);
        for i in 0..size {
            for j in i.saturating_sub(width)..=i {
                *band.entry_mut(i, j) = value(i, j);
            }
        }
        let entry = |i: usize, j: usize| {
            let (i, j) = (i.max(j), i.min(j));
            if i - j <= width { value(i, j) } else { 0.0 }
        };
        let expected: Vec<f64> = (0..size).map(|i| (i as f64).cos()).collect();
        let mut x: Vec<f64> = (0..size).map(|i| (0..size).map(|j| entry(i, j) * expected[j]).sum()).collect();
        assert!(band.factor());
        band.solve(&mut x);
        assert!(x.iter().zip(&expected).all(|(x, e)| (x - e).abs() < 1e-13));
    }

    #[test]
    fn what_is_not_positive_definite_is_told() {
        let mut band = Band::zeros(2, 1);
        (*band.entry_mut(0, 0), *band.entry_mut(1, 0), *band.entry_mut(1, 1)) = (1.0, 2.0, 1.0);
        assert!(!band.factor());
        *band.entry_mut(0, 0) = f64::NAN;
        assert!(!band.factor());
    }
}
