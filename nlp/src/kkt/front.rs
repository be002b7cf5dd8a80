//! Partial LDL' factorisation of a dense symmetric matrix, with pivots of order 1 and 2.
//!
//! $$ P A P^T = \begin{pmatrix} L & 0 \\\\ M & 1 \end{pmatrix} \begin{pmatrix} D & 0 \\\\ 0 & S \end{pmatrix}
//! \begin{pmatrix} L^T & M^T \\\\ 0 & 1 \end{pmatrix} $$
//!
//! Pivots are taken among the first rows alone, but are compared with their whole columns (Duff and Reid,
//! "The multifrontal solution of indefinite sparse symmetric linear equations", ACM TOMS 9 (1983), 302-325):
//! a pivot of order 1 is accepted if `|a_jj| >= u |a_ij|` for all i, one of order 2 if no entry of
//! `|E^-1| (max_i |a_ij|, max_i |a_ir|)` exceeds 1/u. What finds no pivot is left in S.

use costate_numerics::in_widest;

/// Threshold u of pivots.
///
/// Duff and Reid, section 2; MA57 has 0.01 as well.
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
    /// Columns, the lower triangle of which is used; first those of L and M, then S.
    entries: Vec<f64>,
    /// The row of the matrix as assembled that stands in each place.
    pub order: Vec<usize>,
    pub pivots: Vec<Pivot>,
    /// Rows that have been eliminated.
    pub eliminated: usize,
    /// Largest entry of each column as assembled.
    pub sizes: Vec<f64>,
    /// Columns of a pivot before the division.
    products: [Vec<f64>; 2],
}

impl Front {
    /// Zeros of this size.
    pub fn reset(&mut self, size: usize) {
        self.size = size;
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        self.order.clear();
        self.order.extend(0..size);
        self.sizes.clear();
        self.sizes.resize(size, 0.0);
        self.pivots.clear();
        self.eliminated = 0;
        for product in &mut self.products {
            product.clear();
            product.resize(size, 0.0);
        }
    }

    /// Room for matrices of this size.
    pub fn reserve(&mut self, size: usize) {
        self.reset(size);
        self.pivots.reserve(size);
    }

    /// Column j from the diagonal on, as it stands in place j.
    #[inline(always)]
    pub fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.size + j..(j + 1) * self.size]
    }

    /// Adds to the entry (i, j) of either triangle.
    #[inline(always)]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.entries[column * self.size + row] += value;
    }

    /// Adds to the entries (row, first), (row, first + 1), .. of either triangle; the columns are all before
    /// the row, or none is.
    #[inline(always)]
    pub fn add_run(&mut self, row: usize, first: usize, values: &[f64]) {
        if first >= row {
            let start = row * self.size + first;
            let to = &mut self.entries[start..start + values.len()];
            to.iter_mut().zip(values).for_each(|(to, value)| *to += value);
        } else {
            for (k, value) in values.iter().enumerate() {
                self.entries[(first + k) * self.size + row] += value;
            }
        }
    }

    /// Notes the sizes of columns that were not set before.
    pub fn take_sizes(&mut self) {
        for j in 0..self.size {
            for i in j..self.size {
                let entry = self.entries[j * self.size + i].abs();
                self.sizes[i] = self.sizes[i].max(entry);
                self.sizes[j] = self.sizes[j].max(entry);
            }
        }
    }

    /// Eliminates among the first `candidates` rows; of a definite matrix in their order. `forced`: whatever
    /// the threshold says, if there is nothing better.
    pub fn factorise(&mut self, candidates: usize, definite: bool, forced: bool) {
        in_widest!(self.eliminate(candidates, definite, forced));
    }

    #[inline(always)]
    fn eliminate<const FUSED: bool>(&mut self, candidates: usize, definite: bool, forced: bool) {
        if self.size == 0 {
            return;
        }
        while self.eliminated < candidates {
            let k = self.eliminated;
            let choice = if definite { Some(Choice::One(k)) } else { self.choose(candidates, forced) };
            match choice {
                Some(Choice::Zero(j)) => {
                    self.swap(k, j);
                    self.entries[k * self.size + k..(k + 1) * self.size].fill(0.0);
                    self.pivots.push(Pivot::Zero);
                    self.eliminated += 1;
                }
                Some(Choice::One(j)) => {
                    self.swap(k, j);
                    self.eliminate_one::<FUSED>(candidates);
                }
                Some(Choice::Two(i, j)) => {
                    // i < j, so that the second exchange does not move what the first one placed.
                    self.swap(k, i);
                    self.swap(k + 1, j);
                    self.eliminate_two::<FUSED>(candidates);
                }
                None => break,
            }
        }
        self.update_rest::<FUSED>(candidates);
    }

    /// The largest entry of column j beside the diagonal, and the candidate with the largest one.
    #[inline(always)]
    fn largest_of(&self, j: usize, candidates: usize) -> (f64, f64, usize) {
        let (n, k) = (self.size, self.eliminated);
        let (mut most, mut of_candidate, mut partner) = (0.0, 0.0, j);
        for i in k..candidates {
            if i == j {
                continue;
            }
            let entry = self.entry(i, j).abs();
            if entry > of_candidate {
                (of_candidate, partner) = (entry, i);
            }
        }
        for i in candidates..n {
            most = f64::max(most, self.entries[j * n + i].abs());
        }
        (f64::max(most, of_candidate), of_candidate, partner)
    }

    #[inline(always)]
    fn entry(&self, i: usize, j: usize) -> f64 {
        let (row, column) = if i >= j { (i, j) } else { (j, i) };
        self.entries[column * self.size + row]
    }

    /// The next pivot: the first candidate that is acceptable by itself or with a partner; of those that are
    /// not, the best one if that is `forced`.
    fn choose(&self, candidates: usize, forced: bool) -> Option<Choice> {
        let mut best = (0.0, None);
        for j in self.eliminated..candidates {
            let (most, of_candidate, partner) = self.largest_of(j, candidates);
            let diagonal = self.entry(j, j).abs();
            if most.max(diagonal) <= ZERO * self.sizes[j] {
                return Some(Choice::Zero(j));
            }
            if diagonal >= THRESHOLD * most {
                return Some(Choice::One(j));
            }
            if forced && diagonal > best.0 * most {
                best = (diagonal / most, Some(Choice::One(j)));
            }
            if of_candidate <= ZERO * self.sizes[j] {
                continue;
            }
            let quality = self.quality_of_two(j, partner, candidates);
            let pair = Choice::Two(j.min(partner), j.max(partner));
            if quality >= THRESHOLD {
                return Some(pair);
            }
            if forced && quality > best.0 {
                best = (quality, Some(pair));
            }
        }
        best.1
    }

    /// The reciprocal of the largest entry of L that columns i and j give together.
    fn quality_of_two(&self, i: usize, j: usize, candidates: usize) -> f64 {
        let beside = |column: usize| {
            let of_candidates = (self.eliminated..candidates).filter(|&row| row != i && row != j);
            let largest = of_candidates.fold(0.0, |most: f64, row| most.max(self.entry(row, column).abs()));
            let rest = &self.entries[column * self.size + candidates..(column + 1) * self.size];
            rest.iter().fold(largest, |most, entry| most.max(entry.abs()))
        };
        let (a, b, c) = (self.entry(i, i), self.entry(i, j), self.entry(j, j));
        let determinant = a * c - b * b;
        let (first, second) = (beside(i), beside(j));
        let growth = f64::max(c.abs() * first + b.abs() * second, b.abs() * first + a.abs() * second);
        if growth == 0.0 {
            if determinant == 0.0 { 0.0 } else { f64::INFINITY }
        } else {
            determinant.abs() / growth
        }
    }

    /// Exchanges two rows and columns that are not eliminated.
    fn swap(&mut self, i: usize, j: usize) {
        if i == j {
            return;
        }
        let (n, (i, j)) = (self.size, (i.min(j), i.max(j)));
        for column in 0..i {
            self.entries.swap(column * n + i, column * n + j);
        }
        for between in i + 1..j {
            self.entries.swap(i * n + between, between * n + j);
        }
        self.entries.swap(i * n + i, j * n + j);
        for row in j + 1..n {
            self.entries.swap(i * n + row, j * n + row);
        }
        self.order.swap(i, j);
        self.sizes.swap(i, j);
    }

    /// Eliminates the first row that is left, and updates the columns of the other candidates.
    #[inline(always)]
    fn eliminate_one<const FUSED: bool>(&mut self, candidates: usize) {
        let (n, k) = (self.size, self.eliminated);
        let (done, rest) = self.entries.split_at_mut((k + 1) * n);
        let column = &mut done[k * n..];
        let pivot = column[k];
        let [product, _] = &mut self.products;
        product[k + 1..].copy_from_slice(&column[k + 1..]);
        let reciprocal = pivot.recip();
        column[k + 1..].iter_mut().for_each(|entry| *entry *= reciprocal);
        for (c, to) in rest.chunks_exact_mut(n).take(candidates - k - 1).enumerate() {
            let c = k + 1 + c;
            let factor = -product[c];
            add::<FUSED>(&mut to[c..], factor, &column[c..]);
        }
        self.pivots.push(Pivot::One(pivot));
        self.eliminated += 1;
    }

    /// The same for the first two rows.
    #[inline(always)]
    fn eliminate_two<const FUSED: bool>(&mut self, candidates: usize) {
        let (n, k) = (self.size, self.eliminated);
        let (done, rest) = self.entries.split_at_mut((k + 2) * n);
        let (first, second) = done[k * n..].split_at_mut(n);
        let block = [first[k], first[k + 1], second[k + 1]];
        let inverse = inverse_of_two(block);
        let [x, y] = &mut self.products;
        for i in k + 2..n {
            (x[i], y[i]) = (first[i], second[i]);
            [first[i], second[i]] = inverse(x[i], y[i]);
        }
        first[k + 1] = 0.0;
        for (column, to) in rest.chunks_exact_mut(n).take(candidates - k - 2).enumerate() {
            let column = k + 2 + column;
            add::<FUSED>(&mut to[column..], -x[column], &first[column..]);
            add::<FUSED>(&mut to[column..], -y[column], &second[column..]);
        }
        self.pivots.push(Pivot::Two(block));
        self.eliminated += 2;
    }

    /// Updates the columns that are no candidates, by four eliminated ones at a time.
    #[inline(always)]
    fn update_rest<const FUSED: bool>(&mut self, candidates: usize) {
        let (n, eliminated) = (self.size, self.eliminated);
        let (done, rest) = self.entries.split_at_mut(candidates * n);
        let mut weights = std::mem::take(&mut self.products[0]);
        for (c, to) in rest.chunks_exact_mut(n).enumerate() {
            let c = candidates + c;
            // D times row c of L.
            let mut k = 0;
            for pivot in &self.pivots {
                match *pivot {
                    Pivot::Zero => weights[k] = 0.0,
                    Pivot::One(d) => weights[k] = d * done[k * n + c],
                    Pivot::Two([a, b, d]) => {
                        let (x, y) = (done[k * n + c], done[(k + 1) * n + c]);
                        (weights[k], weights[k + 1]) = (a * x + b * y, b * x + d * y);
                    }
                }
                k += pivot.order();
            }
            let to = &mut to[c..];
            let column = |k: usize| &done[k * n + c..(k + 1) * n];
            let mut k = 0;
            while k + 4 <= eliminated {
                let factors = [0, 1, 2, 3].map(|i| -weights[k + i]);
                add_four::<FUSED>(to, factors, [0, 1, 2, 3].map(|i| column(k + i)));
                k += 4;
            }
            (k..eliminated).for_each(|k| add::<FUSED>(to, -weights[k], column(k)));
        }
        self.products[0] = weights;
    }
}

/// A choice of the next pivot: places of rows.
#[derive(Clone, Copy, Debug)]
enum Choice {
    Zero(usize),
    One(usize),
    Two(usize, usize),
}

/// `to += factor from`.
#[inline(always)]
pub(super) fn add<const FUSED: bool>(to: &mut [f64], factor: f64, from: &[f64]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = fused::<FUSED>(factor, *from, *to);
    }
}

#[inline(always)]
fn add_four<const FUSED: bool>(to: &mut [f64], [a, b, c, d]: [f64; 4], from: [&[f64]; 4]) {
    let n = to.len();
    let [p, q, r, s] = from.map(|from| &from[..n]);
    for i in 0..n {
        let first = fused::<FUSED>(b, q[i], fused::<FUSED>(a, p[i], to[i]));
        to[i] = fused::<FUSED>(d, s[i], fused::<FUSED>(c, r[i], first));
    }
}

#[inline(always)]
fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}
