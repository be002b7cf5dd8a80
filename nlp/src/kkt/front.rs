//! Partial LDL' factorisation of a dense symmetric matrix, with pivots of order 1 and 2.
//!
//! $$ P A P^T = \begin{pmatrix} L & 0 \\\\ M & 1 \end{pmatrix} \begin{pmatrix} D & 0 \\\\ 0 & S \end{pmatrix}
//! \begin{pmatrix} L^T & M^T \\\\ 0 & 1 \end{pmatrix} $$
//!
//! Pivots are taken among the first rows alone, the candidates, but are compared with their whole columns.
//! One of order 1 is accepted if `|a_jj| >= u |a_ij|` for all i, one of order 2 if no entry of `|E^-1| (max_i
//! |a_ij|, max_i |a_ir|)` exceeds 1/u: no entry of L is larger (Duff and Reid, "The multifrontal solution of
//! indefinite sparse symmetric linear equations", ACM TOMS 9 (1983), 302-325). Rows and columns are scaled to
//! entries of about 1, so that a pivot does no harm either if no entry of `L D L^T` that it gives exceeds
//! 1/u, `|a_ij|^2 <= |a_jj| / u`: these bound the error of the factorisation (N. J. Higham, "Accuracy and
//! Stability of Numerical Algorithms", 2nd edition, theorem 11.3). Definite matrices pass whatever the
//! entries of L. What finds no pivot is left in S.
//!
//! A column is updated when it is examined, by all columns that were eliminated since its last update. As
//! long as pivots are accepted in their order, the lower triangle is enough; the first column that is
//! refused completes the square of the candidates, so that every column has all of its entries.

use crate::tiles::{
    LANES, PANEL, Sums, add, factor_square, four, largest_number, scale, solve_panel, update,
};

/// u. That of Duff and Reid, section 2, and of MA57 is 0.01 as well.
const THRESHOLD: f64 = 0.01;

/// Columns whose entries are all below this part of what they were before are zero up to rounding.
const ZERO: f64 = 1e-12;

/// One pivot: its order, and the block E of D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pivot {
    /// A column of zeros: the row depends on others, or the unknown has no effect.
    Zero,
    One(f64),
    /// `(e_11, e_21, e_22)`.
    Two([f64; 3]),
}

impl Pivot {
    /// How many rows it eliminates.
    pub fn order(self) -> usize {
        if matches!(self, Self::Two(_)) { 2 } else { 1 }
    }
}

/// `E^-1 (x, y)` for the block `(a, b; b, c)` of a pivot of order 2. Divided by b first: products of small
/// entries would vanish.
#[inline(always)]
pub(super) fn inverse_of_two([a, b, c]: [f64; 3]) -> impl Fn(f64, f64) -> [f64; 2] {
    let (p, q) = (a / b, c / b);
    let scale = (p * q - 1.0).recip() / b;
    move |x, y| [(q * x - y) * scale, (p * y - x) * scale]
}

/// A matrix under factorisation, and the outcome.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    size: usize,
    /// Length of a column with its padding.
    stride: usize,
    /// Columns, the lower triangle of which is used; first those of L and M, then S.
    entries: Vec<f64>,
    /// Columns of `(L; M) D`.
    products: Vec<f64>,
    /// By how many eliminated columns each candidate was updated.
    levels: Vec<usize>,
    /// Whether candidates have the entries above the diagonal too.
    is_complete: bool,
    /// The row of the matrix as assembled that stands in each place.
    pub order: Vec<usize>,
    pub pivots: Vec<Pivot>,
    /// Rows that have been eliminated.
    pub eliminated: usize,
    /// Largest entry of each column as assembled.
    pub sizes: Vec<f64>,
    lanes: Sums,
}

impl Front {
    /// A matrix of this size: zeros, or these columns with their padding.
    pub fn reset(&mut self, size: usize, entries: Option<&[f64]>) {
        self.size = size;
        self.stride = size.next_multiple_of(LANES);
        self.entries.clear();
        match entries {
            Some(entries) => self.entries.extend_from_slice(entries),
            None => self.entries.resize(size * self.stride, 0.0),
        }
        if self.products.len() < size * self.stride {
            self.products.resize(size * self.stride, 0.0);
        }
        self.order.clear();
        self.order.extend(0..size);
        self.levels.clear();
        self.levels.resize(size, 0);
        self.sizes.clear();
        self.sizes.resize(self.stride, 0.0);
        self.pivots.clear();
        self.eliminated = 0;
        self.is_complete = false;
    }

    /// Room for matrices of this size.
    pub fn reserve(&mut self, size: usize) {
        self.reset(size, None);
        self.pivots.reserve(size);
    }

    /// Length of a column with its padding.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The eliminated columns of L and M, with padding and whatever stands above the diagonal.
    pub fn factors(&self) -> &[f64] {
        &self.entries[..self.eliminated * self.stride]
    }

    /// Column j from the diagonal on, as it stands in place j.
    #[inline(always)]
    pub fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.stride + j..][..self.size - j]
    }

    /// Adds to the entry (i, j) of either triangle.
    #[inline(always)]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.entries[column * self.stride + row] += value;
    }

    /// Adds to the entries (row, first), (row, first + 1), .. of either triangle; the columns are all before
    /// the row, or none is.
    #[inline(always)]
    pub fn add_run(&mut self, row: usize, first: usize, values: &[f64]) {
        if first >= row {
            add(&mut self.entries[row * self.stride + first..], values);
        } else {
            let columns = self.entries[first * self.stride..].chunks_exact_mut(self.stride);
            columns.zip(values).for_each(|(column, value)| column[row] += value);
        }
    }

    /// Notes the sizes of columns that were not set before.
    #[inline(always)]
    pub fn take_sizes(&mut self) {
        let (stride, larger) = (self.stride, |a: f64, b: f64| if b > a { b } else { a });
        for j in (0..self.size).step_by(LANES) {
            let count = LANES.min(self.size - j);
            // The square on the diagonal, then four columns below it; the last one is repeated.
            for column in j..j + count {
                for row in column..j + count {
                    let entry = self.entries[column * stride + row].abs();
                    self.sizes[row] = larger(self.sizes[row], entry);
                    self.sizes[column] = larger(self.sizes[column], entry);
                }
            }
            let columns = four(|w| &self.entries[(j + w.min(count - 1)) * stride..][..stride]);
            let mut lanes = Sums::default();
            for at in (j + LANES..stride).step_by(LANES) {
                let Some(sizes) = self.sizes[at..].first_chunk_mut::<LANES>() else { break };
                let mut most = *sizes;
                for w in 0..4 {
                    let Some(column) = columns[w][at..].first_chunk::<LANES>() else { break };
                    for lane in 0..LANES {
                        let entry = column[lane].abs();
                        most[lane] = larger(most[lane], entry);
                        lanes[w][lane] = larger(lanes[w][lane], entry);
                    }
                }
                *sizes = most;
            }
            self.lanes = lanes;
            for (size, [p, q, r, s]) in self.sizes[j..j + count].iter_mut().zip(self.lanes) {
                *size = larger(*size, larger(larger(p, q), larger(r, s)));
            }
        }
    }

    /// Eliminates among the first `candidates` rows; of a definite matrix in their order. `forced`: whatever
    /// the threshold says, if there is nothing better.
    #[inline(always)]
    pub fn eliminate<const FUSED: bool>(&mut self, candidates: usize, definite: bool, forced: bool) {
        let (mut cursor, mut refused, mut best) = (0, 0, Best::default());
        let mut is_regular = true;
        while self.eliminated < candidates {
            let k = self.eliminated;
            if is_regular && !self.is_complete && k + PANEL <= candidates {
                is_regular = self.eliminate_panel::<FUSED>(definite, candidates);
                continue;
            }
            let choice = if refused == candidates - k {
                // No column has changed since it was refused.
                if !forced {
                    break;
                }
                best.choice
            } else {
                cursor = if cursor < candidates { cursor.max(k) } else { k };
                self.bring_up_to_date::<FUSED>(cursor, candidates);
                if definite {
                    Some(Choice::One(k))
                } else {
                    self.judge::<FUSED>(cursor, candidates, &mut best)
                }
            };
            match choice {
                Some(Choice::Zero(j)) => {
                    self.swap(k, j, candidates);
                    let column = k * self.stride..(k + 1) * self.stride;
                    self.entries[column.clone()].fill(0.0);
                    self.products[column].fill(0.0);
                    self.pivots.push(Pivot::Zero);
                    self.eliminated += 1;
                }
                Some(Choice::One(j)) => {
                    self.swap(k, j, candidates);
                    self.eliminate_one();
                }
                Some(Choice::Two(i, j)) => {
                    // i < j, so that the second exchange does not move what the first one placed.
                    self.swap(k, i, candidates);
                    self.swap(k + 1, j, candidates);
                    self.eliminate_two();
                }
                None if refused == candidates - k => break,
                None => {
                    refused += 1;
                    cursor += 1;
                    continue;
                }
            }
            (refused, best) = (0, Best::default());
            cursor += 1;
        }
        for j in self.eliminated..candidates {
            self.bring_up_to_date::<FUSED>(j, candidates);
        }
        self.update_rest::<FUSED>(candidates);
    }

    /// Updates column j, and those after it that have had the same updates.
    #[inline(always)]
    fn bring_up_to_date<const FUSED: bool>(&mut self, j: usize, candidates: usize) {
        let (stride, level) = (self.stride, self.levels[j]);
        let sources = level * stride..self.eliminated * stride;
        if sources.is_empty() {
            return;
        }
        let first = if self.is_complete { self.eliminated } else { j } / LANES;
        let same = self.levels[j..candidates].iter().take(4).take_while(|&&other| other == level).count();
        let (done, rest) = self.entries.split_at_mut(self.eliminated * stride);
        let from = (&done[sources.clone()], &self.products[sources]);
        let to = &mut rest[j * stride - done.len()..];
        let width = update::<FUSED, false>(from, to, stride, (j, same), first * LANES);
        self.levels[j..j + width].fill(self.eliminated);
    }

    /// Updates the columns that are no candidates.
    #[inline(always)]
    fn update_rest<const FUSED: bool>(&mut self, candidates: usize) {
        let (stride, mut j) = (self.stride, candidates);
        let (done, rest) = self.entries.split_at_mut(self.eliminated * stride);
        let from = (&*done, &self.products[..done.len()]);
        while j < self.size {
            let to = &mut rest[j * stride - done.len()..];
            j += update::<FUSED, false>(from, to, stride, (j, self.size - j), j / LANES * LANES);
        }
    }

    /// Updates all candidates, and copies what is below the diagonal to the other side of it.
    #[inline(always)]
    fn complete<const FUSED: bool>(&mut self, candidates: usize) {
        for j in self.eliminated..candidates {
            self.bring_up_to_date::<FUSED>(j, candidates);
        }
        for j in self.eliminated..candidates {
            for i in j + 1..candidates {
                self.entries[i * self.stride + j] = self.entries[j * self.stride + i];
            }
        }
        self.is_complete = true;
    }

    /// The largest entry of column j, which is up to date, beside the rows i < r.
    #[inline(always)]
    fn largest_beside(&self, j: usize, i: usize, r: usize) -> f64 {
        let column = &self.entries[j * self.stride..][..self.stride];
        let first = self.eliminated;
        largest_number(&column[first..i])
            .max(largest_number(&column[i + 1..r]))
            .max(largest_number(&column[r + 1..]))
    }

    /// A pivot of column j, which is up to date, by itself or with a partner, if one is acceptable.
    #[inline(always)]
    fn judge<const FUSED: bool>(&mut self, j: usize, candidates: usize, best: &mut Best) -> Option<Choice> {
        let column = &self.entries[j * self.stride..][..self.stride];
        let most = largest_number(&column[self.eliminated.min(j)..j]).max(largest_number(&column[j + 1..]));
        let diagonal = column[j].abs();
        if most.max(diagonal) <= ZERO * self.sizes[j] {
            return Some(Choice::Zero(j));
        }
        let quality = quality_of_one(diagonal, most);
        if quality >= THRESHOLD {
            return Some(Choice::One(j));
        }
        best.offer(quality, Choice::One(j));
        if !self.is_complete {
            self.complete::<FUSED>(candidates);
        }
        let (mut of_candidate, mut partner) = (0.0, j);
        let column = &self.entries[j * self.stride..][..candidates];
        for (i, entry) in column.iter().enumerate().skip(self.eliminated) {
            if entry.abs() > of_candidate && i != j {
                (of_candidate, partner) = (entry.abs(), i);
            }
        }
        if of_candidate <= ZERO * self.sizes[j] {
            return None;
        }
        self.bring_up_to_date::<FUSED>(partner, candidates);
        let (i, j) = (j.min(partner), j.max(partner));
        let quality = self.quality_of_two(i, j);
        best.offer(quality, Choice::Two(i, j));
        (quality >= THRESHOLD).then_some(Choice::Two(i, j))
    }

    /// Of the products of columns i < j together, as [`quality_of_one`].
    fn quality_of_two(&self, i: usize, j: usize) -> f64 {
        let entry = |row: usize, column: usize| self.entries[column * self.stride + row];
        let (a, b, c) = (entry(i, i), entry(j, i), entry(j, j));
        let determinant = a * c - b * b;
        let (first, second) = (self.largest_beside(i, i, j), self.largest_beside(j, i, j));
        let (of_first, of_second) = (c.abs() * first + b.abs() * second, b.abs() * first + a.abs() * second);
        let most = of_first.max(of_second);
        if most == 0.0 {
            return if determinant == 0.0 { 0.0 } else { f64::INFINITY };
        }
        let products = (of_first / most) * first + (of_second / most) * second;
        let quality = determinant.abs() / most;
        quality.max(quality / products)
    }

    /// Exchanges two rows and columns of candidates that are not eliminated, i <= j.
    #[inline(always)]
    fn swap(&mut self, i: usize, j: usize, candidates: usize) {
        if i == j {
            return;
        }
        let (stride, done) = (self.stride, self.eliminated * self.stride);
        let (head, tail) = self.entries.split_at_mut(j * stride);
        head[i * stride..][..stride].swap_with_slice(&mut tail[..stride]);
        let columns = self.entries[..candidates * stride].chunks_exact_mut(stride);
        let products = self.products[..done].chunks_exact_mut(stride);
        columns.chain(products).for_each(|column| column.swap(i, j));
        self.order.swap(i, j);
        self.sizes.swap(i, j);
        self.levels.swap(i, j);
    }

    /// Eliminates the first four rows that are left in their order, unless that breaks the threshold.
    #[inline(always)]
    fn eliminate_panel<const FUSED: bool>(&mut self, definite: bool, candidates: usize) -> bool {
        let (stride, k) = (self.stride, self.eliminated);
        for j in k..k + PANEL {
            self.bring_up_to_date::<FUSED>(j, candidates);
        }
        let columns = k * stride..(k + PANEL) * stride;
        // The square on the diagonal.
        let mut square = four(|j| four(|i| self.entries[(k + j) * stride + k + i]));
        let reciprocals = factor_square::<FUSED>(&mut square);
        let mut is_accepted = true;
        for (j, column) in square.iter().enumerate() {
            let (pivot, most) = (column[j].abs(), largest_number(&column[j + 1..]));
            is_accepted &= pivot > ZERO * self.sizes[k + j] && quality_of_one(pivot, most) >= THRESHOLD;
        }
        if !(definite || is_accepted) {
            return false;
        }
        let (first, products) = (k / LANES * LANES, &mut self.products[columns.clone()]);
        solve_panel::<FUSED>(&self.entries[columns.clone()], products, stride, (&square, reciprocals), first);
        if !definite {
            for (j, pivots) in square.iter().enumerate() {
                let column = &products[j * stride + k + PANEL..(j + 1) * stride];
                is_accepted &= quality_of_one(pivots[j].abs(), largest_number(column)) >= THRESHOLD;
            }
            if !is_accepted {
                return false;
            }
        }
        for (j, reciprocal) in reciprocals.into_iter().enumerate() {
            let column = j * stride + first..(j + 1) * stride;
            scale(&products[column.clone()], reciprocal, &mut self.entries[k * stride..][column]);
        }
        self.pivots.extend(four(|j| Pivot::One(square[j][j])));
        self.eliminated += PANEL;
        true
    }

    /// Eliminates the first row that is left.
    #[inline(always)]
    fn eliminate_one(&mut self) {
        let (k, first) = (self.eliminated, self.eliminated / LANES * LANES);
        let column = k * self.stride + first..(k + 1) * self.stride;
        let pivot = self.entries[k * self.stride + k];
        self.products[column.clone()].copy_from_slice(&self.entries[column.clone()]);
        scale(&self.products[column.clone()], pivot.recip(), &mut self.entries[column]);
        self.pivots.push(Pivot::One(pivot));
        self.eliminated += 1;
    }

    /// The same for the first two rows.
    #[inline(always)]
    fn eliminate_two(&mut self) {
        let (stride, k) = (self.stride, self.eliminated);
        let columns = k * stride..(k + 2) * stride;
        let (first, second) = self.entries[columns.clone()].split_at_mut(stride);
        let (x, y) = self.products[columns].split_at_mut(stride);
        let block = [first[k], first[k + 1], second[k + 1]];
        let inverse = inverse_of_two(block);
        let (first, second) = (&mut first[k + 1..], &mut second[k + 1..]);
        for ((l, m), (x, y)) in
            first.iter_mut().zip(second.iter_mut()).zip(x[k + 1..].iter_mut().zip(&mut y[k + 1..]))
        {
            (*x, *y) = (*l, *m);
            [*l, *m] = inverse(*x, *y);
        }
        first[0] = 0.0;
        self.pivots.push(Pivot::Two(block));
        self.eliminated += 2;
    }
}

/// The reciprocal of the largest entry of L, or of `L D L^T` if that is smaller, which a column with this
/// pivot gives that has no other entry larger than `most`.
#[inline(always)]
fn quality_of_one(pivot: f64, most: f64) -> f64 {
    let quality = pivot / most;
    quality.max(quality / most)
}

/// A choice of the next pivot: places of rows.
#[derive(Clone, Copy, Debug)]
enum Choice {
    Zero(usize),
    One(usize),
    Two(usize, usize),
}

/// The best of the pivots that were refused.
#[derive(Clone, Copy, Debug, Default)]
struct Best {
    quality: f64,
    choice: Option<Choice>,
}

impl Best {
    #[inline(always)]
    fn offer(&mut self, quality: f64, choice: Choice) {
        if quality > self.quality {
            *self = Self { quality, choice: Some(choice) };
        }
    }
}
