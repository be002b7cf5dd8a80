//! Second derivatives of the state equation in packed storage.

use super::Hamiltonian;
use crate::error::{EvalError, LengthError, check_length};
use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// The tensor `d2 F_k / dx_i dx_j`, indices in the order x = (q, p), F = (F^q, F^p).
///
/// F without friction is J grad H: its second derivatives are the third derivatives H,abc, which are
/// symmetric in all three indices, and zero where all three are momenta. The tensor stores the triples a <= b
/// <= c that begin with a joint position: 308 numbers for six joints instead of 12 x 12 x 12. The friction
/// term `D'_k v_k,ij + D''_k v_k,i v_k,j` in the row of p_k does not have this symmetry; D', D'' and V are
/// stored separately, and only for a robot with friction.
#[derive(Clone, Debug)]
pub struct HessianTensor<S> {
    n: usize,
    packed: Vec<S>,
    friction: Option<Friction<S>>,
    /// `d2 tau_k / dq dq` of wrenches from outside, for each joint k; none without wrenches.
    wrenches: Vec<Matrix<S>>,
    unit: Vec<S>,
}

/// Slopes and curvatures of friction, for its second derivatives.
#[derive(Clone, Debug)]
struct Friction<S> {
    /// D', n.
    slope: Vec<S>,
    /// D'', n.
    curvature: Vec<S>,
    /// `V = dv/dx = [-M^-1 P, M^-1]`, n x 2n.
    velocity: Matrix<S>,
}

impl<S: Scalar> HessianTensor<S> {
    /// Storage, filled with zeros.
    pub(super) fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let zeros = vec![S::zero(); n];
        let friction =
            || Friction { slope: zeros.clone(), curvature: zeros.clone(), velocity: Matrix::zeros(n, 2 * n) };
        Self {
            n,
            packed: vec![S::zero(); start(2 * n, n)],
            friction: (!tree.is_conservative()).then(friction),
            wrenches: if tree.wrenches().is_empty() { Vec::new() } else { vec![Matrix::zeros(n, n); n] },
            unit: vec![S::zero(); n],
        }
    }

    /// Stores the third derivative of H along q_l, 2n x 2n: all triples whose first index is l.
    pub(super) fn fill_slice(&mut self, l: usize, slice: &Matrix<S>) {
        let first = start(2 * self.n, l);
        let mut slots = self.packed[first..].iter_mut();
        for i in l..2 * self.n {
            // `entries` must come first in the zip: a zip consumes an item of its first iterator before it
            // sees that the second one has ended.
            for (&entry, slot) in slice.row(i)[l..=i].iter().zip(slots.by_ref()) {
                *slot = entry;
            }
        }
    }

    /// Stores slopes and curvatures of friction at the state of the last Jacobian.
    pub(super) fn fill_friction(&mut self, first: &Hamiltonian<S>) {
        if let Some(Friction { slope, curvature, velocity }) = &mut self.friction {
            for (i, friction) in first.state.friction.iter().enumerate() {
                slope[i] = friction.first;
                curvature[i] = friction.second;
                velocity.row_mut(i).copy_from_slice(first.state.f_x.row(i));
            }
        }
    }

    /// Stores the second derivatives of the generalised forces of wrenches at q.
    pub(super) fn fill_wrenches(&mut self, first: &mut Hamiltonian<S>, q: &[S]) {
        if let Some(external) = &mut first.state.external {
            for (k, curvature) in self.wrenches.iter_mut().enumerate() {
                self.unit[k] = S::one();
                curvature.copy_from(external.curvature(q, &self.unit));
                self.unit[k] = S::zero();
            }
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.n
    }

    /// The third derivatives of H that are stored: for each joint l the lower triangle, row by row, of H,l
    /// over the indices from l on.
    pub fn packed(&self) -> &[S] {
        &self.packed
    }

    /// `H,abc`, the indices below 2n in any order.
    ///
    /// # Panics
    /// If an index is not below 2n.
    pub fn third(&self, a: usize, b: usize, c: usize) -> S {
        let size = 2 * self.n;
        assert!(a.max(b).max(c) < size, "({a}, {b}, {c}) is outside a tensor of {size} indices");
        let (low, high) = (a.min(b), a.max(b));
        let (first, middle, last) = (low.min(c), high.min(low.max(c)), high.max(c));
        if first >= self.n {
            return S::zero();
        }
        let (row, column) = (last - first, middle - first);
        self.packed[start(size, first) + row * (row + 1) / 2 + column]
    }

    /// `d2 F_k / dx_i dx_j`, the indices below 2n; i and j in any order.
    ///
    /// # Panics
    /// If an index is not below 2n.
    pub fn entry(&self, k: usize, i: usize, j: usize) -> S {
        assert!(k < 2 * self.n, "({k}, {i}, {j}) is outside a tensor of {} indices", 2 * self.n);
        if k < self.n {
            return self.third(self.n + k, i, j);
        }
        let (joint, mut entry) = (k - self.n, -self.third(k - self.n, i, j));
        if let (Some(curvature), true) = (self.wrenches.get(joint), i.max(j) < self.n) {
            entry += curvature[(i, j)];
        }
        match &self.friction {
            None => entry,
            Some(Friction { slope, curvature, velocity }) => {
                let square = velocity[(joint, i)] * velocity[(joint, j)];
                entry + slope[joint] * self.third(k, i, j) + curvature[joint] * square
            }
        }
    }

    /// `sum_k y_k d2 F_k / dx dx` into a 2n x 2n matrix, y of length 2n.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`] if y or the rows or columns of the matrix are not 2n.
    pub fn contract(&self, y: &[S], contracted: &mut Matrix<S>) -> Result<(), EvalError> {
        let size = 2 * self.n;
        check_length("y", y, size)?;
        for (what, found) in
            [("a column of contracted", contracted.rows()), ("a row of contracted", contracted.columns())]
        {
            LengthError::check(what, size, found)?;
        }
        for i in 0..size {
            for j in 0..=i {
                let sum = y.iter().enumerate().fold(S::zero(), |sum, (k, &y)| sum + y * self.entry(k, i, j));
                contracted[(i, j)] = sum;
                contracted[(j, i)] = sum;
            }
        }
        Ok(())
    }
}

/// Number of triples a <= b <= c < size with a < first: all of them but those of the indices from `first` on.
fn start(size: usize, first: usize) -> usize {
    let triples = |indices: usize| indices * (indices + 1) * (indices + 2) / 6;
    triples(size) - triples(size - first)
}
