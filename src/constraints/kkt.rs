//! Linear equations with M and the Jacobian of the constraints.

use crate::kernels::Factor;
use crate::matrix::{Matrix, Panel, add_rows, add_scaled, dot, dot_packs, filled};
use crate::scalar::{Pack, Scalar};

/// A pivot below this part of its diagonal entry belongs to a redundant row.
pub(super) const REDUNDANT: f64 = 1e-10;
/// A pivot below this part of the square of its row's natural size belongs to a row that is nothing but
/// rounding: no motion changes it.
const STILL: f64 = 1e-24;

/// `(M, -J'; -J, 0)` by its Schur complement `C = J M^-1 J' = L D L'`.
///
/// Where a row of J depends on those before it, its pivot vanishes: it is left out, and its multiplier is
/// zero. What remains is the matrix of a robot without that row, with all its derivatives. (A small number in
/// place of the zero block would change v by as much in proportion, and its derivatives would have to be
/// those of a constant.) No branch depends on a value.
#[derive(Clone, Debug)]
pub(super) struct Kkt<S: Scalar> {
    /// `A' = J M^-1`, k x n.
    pub response: Matrix<S>,
    /// L below the diagonal, C on and above it, k x k.
    lower: Matrix<S>,
    /// D^-1, zero for redundant rows.
    inverse_pivots: Vec<S>,
    pivots: Vec<S>,
    /// What pivots of rows that count exceed.
    least: Vec<S>,
    /// `1 / M_jj`, n.
    inverse_diagonal: Vec<S>,
    /// 1 for rows that are kept, 0 for redundant ones.
    pub kept: Vec<S>,
}

impl<S: Scalar> Kkt<S> {
    pub fn new(n: usize, k: usize) -> Self {
        Self {
            response: Matrix::zeros(k, n),
            lower: Matrix::zeros(k, k),
            inverse_pivots: filled(S::zero(), k),
            pivots: filled(S::zero(), k),
            least: filled(S::zero(), k),
            inverse_diagonal: filled(S::zero(), n),
            kept: filled(S::zero(), k),
        }
    }

    /// Takes the squares of the sizes of the entries of J, and M.
    pub fn set_sizes(&mut self, sizes: &Matrix<S>, mass_matrix: &Matrix<S>) {
        for (j, inverse) in self.inverse_diagonal.iter_mut().enumerate() {
            *inverse = mass_matrix[(j, j)].recip();
        }
        for (i, least) in self.least.iter_mut().enumerate() {
            *least = dot_packs(sizes.row(i), &self.inverse_diagonal).times(STILL);
        }
    }

    /// Takes J, with M factored, after the sizes.
    pub fn factor(&mut self, factor: &Factor<S>, jacobian: &Matrix<S>) {
        for i in 0..self.pivots.len() {
            let row = self.response.row_mut(i);
            row.copy_from_slice(jacobian.row(i));
            factor.solve(row);
        }
        self.decompose(jacobian);
    }

    /// The same for a diagonal matrix, given by its inverse, in the place of M.
    pub fn factor_diagonal(&mut self, inverse: &[S], jacobian: &Matrix<S>) {
        for i in 0..self.pivots.len() {
            let entries = jacobian.row(i).iter().zip(inverse);
            self.response.row_mut(i).iter_mut().zip(entries).for_each(|(to, (&j, &w))| *to = j * w);
        }
        self.decompose(jacobian);
    }

    /// Takes C and A', computed block by block.
    pub fn take(&mut self, schur: &Panel<S>, response: &Panel<S>) {
        for i in 0..self.pivots.len() {
            response.write_row::<0>(i, self.response.row_mut(i), |pack| pack);
            for j in i..self.pivots.len() {
                self.lower[(i, j)] = schur.get(i, j);
            }
        }
        self.eliminate();
    }

    /// C and its factors.
    #[inline(never)]
    fn decompose(&mut self, jacobian: &Matrix<S>) {
        let k = self.pivots.len();
        for i in 0..k {
            for j in i..k {
                self.lower[(i, j)] = dot(jacobian.row(i), self.response.row(j));
            }
        }
        self.eliminate();
    }

    /// The factors of C.
    #[inline(never)]
    fn eliminate(&mut self) {
        for i in 0..self.pivots.len() {
            let mut pivot = self.lower[(i, i)];
            for j in 0..i {
                let mut entry = self.lower[(j, i)];
                for l in 0..j {
                    entry -= self.lower[(i, l)] * self.pivots[l] * self.lower[(j, l)];
                }
                let entry = entry * self.inverse_pivots[j];
                self.lower[(i, j)] = entry;
                pivot -= entry * entry * self.pivots[j];
            }
            let least = self.lower[(i, i)].times(REDUNDANT) + self.least[i];
            let keeps = least.less(pivot);
            let safe = S::select(keeps, pivot, S::one());
            self.pivots[i] = S::select(keeps, pivot, S::zero());
            self.inverse_pivots[i] = S::select(keeps, safe.recip(), S::zero());
            self.kept[i] = S::select(keeps, S::one(), S::zero());
        }
    }

    /// `x <- C^-1 x`, k, zero for redundant rows.
    pub fn solve_schur(&self, x: &mut [S]) {
        for i in 0..x.len() {
            let row = self.lower.row(i)[..i].iter().zip(&*x);
            let sum = row.fold(x[i], |sum, (&entry, &x)| sum - entry * x);
            x[i] = sum * self.kept[i];
        }
        for i in (0..x.len()).rev() {
            let after = x.iter().enumerate().skip(i + 1);
            let start = x[i] * self.inverse_pivots[i];
            x[i] = after.fold(start, |sum, (j, &x)| sum - self.lower[(j, i)] * x) * self.kept[i];
        }
    }

    /// `R <- D^-1/2 L^-1 R`, k rows, zero for redundant ones.
    pub fn first_half(&self, rows: &mut Panel<S>) {
        let width = rows.width::<0>();
        for (i, &kept) in self.kept.iter().enumerate() {
            let (before, row, _) = rows.split_at_row::<0>(i);
            let terms = (0..i).map(|l| (l, S::Pack::splat(-self.lower[(i, l)])));
            add_rows(row, before, width, terms);
            row.iter_mut().for_each(|pack| *pack *= S::Pack::splat(kept));
        }
        self.divide_by_roots(rows);
    }

    /// `R <- D^-1/2 R`, k rows.
    fn divide_by_roots(&self, rows: &mut Panel<S>) {
        for (i, &inverse) in self.inverse_pivots.iter().enumerate() {
            let root = S::Pack::splat(inverse.sqrt());
            rows.row_mut(i).iter_mut().for_each(|pack| *pack *= root);
        }
    }

    /// `R <- L'^-1 D^-1/2 R`, k rows, zero for redundant ones.
    pub fn second_half(&self, rows: &mut Panel<S>) {
        self.divide_by_roots(rows);
        let (k, width) = (self.kept.len(), rows.width::<0>());
        for (i, &kept) in self.kept.iter().enumerate().rev() {
            let (_, row, after) = rows.split_at_row::<0>(i);
            let terms = (i + 1..k).map(|j| (j - i - 1, S::Pack::splat(-self.lower[(j, i)])));
            add_rows(row, after, width, terms);
            row.iter_mut().for_each(|pack| *pack *= S::Pack::splat(kept));
        }
    }

    /// `(x; m) <- (M, -J'; -J, 0)^-1 (x; m)`, n and k entries:
    /// `m = -C^-1 (m + J M^-1 x)`, `x = M^-1 x + M^-1 J' m`.
    #[inline(never)]
    pub fn solve(&mut self, factor: &Factor<S>, x: &mut [S], m: &mut [S]) {
        for (i, m) in m.iter_mut().enumerate() {
            *m = -(*m + dot_packs(self.response.row(i), x));
        }
        self.solve_schur(m);
        factor.solve(x);
        for (i, &m) in m.iter().enumerate() {
            add_scaled(x, m, self.response.row(i));
        }
    }

    /// `m' C m`, never negative: `sum D_i (L'm)_i^2`.
    pub fn square(&self, m: &[S]) -> S {
        (0..m.len()).fold(S::zero(), |sum, i| {
            let after = m.iter().enumerate().skip(i + 1);
            let entry = after.fold(m[i], |sum, (j, &m)| sum + self.lower[(j, i)] * m);
            sum + self.pivots[i] * entry * entry
        })
    }

    /// Velocity and multipliers at p: `v <- M^-1 (v + J'mu)` with `J v = 0`, from p in the place of v.
    pub fn velocity(&mut self, factor: &Factor<S>, v: &mut [S], mu: &mut [S]) {
        mu.fill(S::zero());
        self.solve(factor, v, mu);
    }

    /// The smallest change of q, measured by M, that changes the rows by -g to first order; g is overwritten.
    pub fn correct(&self, g: &mut [S], change: &mut [S]) {
        self.solve_schur(g);
        change.fill(S::zero());
        for (i, &m) in g.iter().enumerate() {
            add_scaled(change, -m, self.response.row(i));
        }
    }
}

impl Kkt<f64> {
    /// What row `i` has beyond those before it, in parts of the square of its natural size; zero if it is
    /// redundant.
    pub fn strength(&self, i: usize) -> f64 {
        if self.pivots[i] == 0.0 { 0.0 } else { self.pivots[i] / self.least[i] * STILL }
    }

    /// Whether no motion changes row `i`.
    pub fn is_still(&self, i: usize) -> bool {
        self.lower[(i, i)] <= self.least[i]
    }

    /// The rows that the redundant row `i` is a sum of, `row_i = sum c_j row_j`: `L'c = l_i`.
    pub fn sum_of(&self, i: usize) -> Vec<usize> {
        let mut c: Vec<f64> = (0..i).map(|j| self.lower[(i, j)]).collect();
        for j in (0..i).rev() {
            let after = c.iter().enumerate().skip(j + 1);
            c[j] -= after.map(|(l, c)| self.lower[(l, j)] * c).sum::<f64>();
        }
        let counts = |j: &usize| c[*j] * c[*j] * self.lower[(*j, *j)] > REDUNDANT * self.lower[(i, i)];
        (0..i).filter(counts).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::KernelOne;
    use crate::robot::{JointSpec, LinkInertia, Robot, Tree};
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn solutions_are_those_of_the_dense_matrix_without_redundant_rows() {
        let body = LinkInertia::about_com(1.0, [0.2, 0.1, 0.0], nalgebra::Matrix3::identity());
        let joint = |name: &str| JointSpec::revolute(name).carrying(body);
        let robot = Robot::builder("arm").joint(joint("a")).joint(joint("b").on("a").axis([0.0, 1.0, 0.0]));
        let robot =
            robot.joint(joint("c").on("b")).joint(joint("d").on("c").axis([1.0, 0.0, 0.0])).build().unwrap();
        let tree = Tree::from(&robot);
        let mut kernel = KernelOne::<f64>::new(&tree);
        kernel.set_position(&tree, &[0.3, -0.8, 0.5, 1.0]).unwrap();
        let mut factor = Factor::new(&tree);
        factor.factor(kernel.mass_matrix(), |k| kernel.size_of_entry(&tree, k)).unwrap();
        // Row 1 is still, row 3 is twice the difference of rows 0 and 2.
        let rows =
            [[1.0, -0.5, 0.2, 0.7], [0.0, 1e-17, 0.0, 0.0], [0.3, 1.0, 0.0, -1.0], [1.4, -3.0, 0.4, 3.4]];
        let mut jacobian = Matrix::zeros(4, 4);
        rows.iter().enumerate().for_each(|(i, row)| jacobian.row_mut(i).copy_from_slice(row));
        let mut kkt = Kkt::new(4, 4);
        let mut sizes = Matrix::zeros(4, 4);
        (0..16).for_each(|at| sizes[(at / 4, at % 4)] = 1.0);
        kkt.set_sizes(&sizes, kernel.mass_matrix());
        kkt.factor(&factor, &jacobian);
        assert_eq!(kkt.kept, [1.0, 0.0, 1.0, 0.0]);
        let m = kernel.mass_matrix().view().to_nalgebra();
        let mut dense = DMatrix::zeros(6, 6);
        dense.view_mut((0, 0), (4, 4)).copy_from(&m);
        for (at, row) in [(4, 0), (5, 2)] {
            for j in 0..4 {
                (dense[(at, j)], dense[(j, at)]) = (-rows[row][j], -rows[row][j]);
            }
        }
        let (mut x, mut mu) = ([0.4, 1.0, -0.3, 2.0], [0.5, 9.0, -0.2, 9.0]);
        let given = DVector::from_vec(vec![0.4, 1.0, -0.3, 2.0, 0.5, -0.2]);
        let expected = dense.lu().solve(&given).unwrap();
        kkt.solve(&factor, &mut x, &mut mu);
        let found = DVector::from_vec(vec![x[0], x[1], x[2], x[3], mu[0], mu[2]]);
        assert!((found - expected).amax() < 1e-13 && mu[1] == 0.0 && mu[3] == 0.0);
    }
}
