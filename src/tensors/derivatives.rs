//! Public access to the coefficients: by any indices, or the packed storage.

use super::first::First;
use super::global::GlobalTensors;
use super::paths::{gamma, gamma_by_last, gamma_of_last, mass_first, mass_second};
use super::second::Second;
use crate::error::EvalError;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// M, its Christoffel coefficients, and its first and second derivatives in q, one by one; no call allocates.
///
/// [`set_position`](Self::set_position) gives M and the global inertia tensors,
/// [`first_derivatives`](Self::first_derivatives) `Gamma^k_ij` and `M_ij,k`,
/// [`second_derivatives`](Self::second_derivatives) `Gamma^k_ij,l` and `M_ij,kl`; [`update`](Self::update)
/// all of them. Coefficients that have not been computed are NaN; those of an earlier position stay until
/// they are recomputed.
///
/// Storage and time grow with the fourth power of the depth: a chain of 12 joints has 5434 second derivatives
/// of both kinds, one of 100 joints 25 million (200 MB in `f64`).
///
/// They belong to all joints of the tree: where some mimic others, the coordinates set the positions of all,
/// and derivatives are those that independent joints would have.
///
/// Every independent number is stored once, in the order of [`IndexSets`](super::IndexSets). The accessors
/// take any indices 0 to n - 1, in any order, and panic if one is out of range; for joints on different
/// branches they return 0. Units follow from those of M (kg m^2, kg m, kg) and q (rad, m). Armature is
/// constant: it is not part of this M, and does not affect the derivatives.
///
/// ```
/// use costate::robot::{Robot, Tree};
/// use costate::tensors::MassMatrixDerivatives;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let tree = Tree::from(&Robot::from_file("robots/two_link.toml")?);
/// let mut m = MassMatrixDerivatives::<f64>::new(&tree);
/// m.update(&tree, &[0.3, -0.8])?;
/// // The Coriolis matrix of adaptive control: C_kj = sum_i c_ijk v_i
/// let v = [1.0, 0.5];
/// let coriolis = |k, j| (0..2).map(|i| m.christoffel_symbol(i, j, k) * v[i]).sum::<f64>();
/// let rate = |k, j| (0..2).map(|i| m.mass_first(k, j, i) * v[i]).sum::<f64>();
/// assert!((rate(0, 1) - coriolis(0, 1) - coriolis(1, 0)).abs() < 1e-15); // dM/dt = C + C'
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MassMatrixDerivatives<S> {
    pub(super) tensors: GlobalTensors<S>,
    pub(super) first: First<S>,
    pub(super) second: Second<S>,
}

impl<S: Scalar> MassMatrixDerivatives<S> {
    /// Buffers for a tree.
    pub fn new(tree: &Tree) -> Self {
        let tensors = GlobalTensors::new(tree);
        Self { first: First::new(&tensors), second: Second::new(&tensors), tensors }
    }

    /// First stage: global inertia tensors (66), (67) and M (62) at q (rad, m; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.tensors.set_position(tree, q)
    }

    /// Second stage: `Gamma^k_ij` (63) and `M_ij,k` (39) at the position set last.
    pub fn first_derivatives(&mut self) {
        self.first.compute(&mut self.tensors);
    }

    /// Third stage: `Gamma^k_ij,l` (59), (60) and `M_ij,kl` (41) at the position set last; needs the second
    /// stage.
    pub fn second_derivatives(&mut self, tree: &Tree) {
        self.second.compute(tree, &self.tensors, &self.first);
    }

    /// All stages at q (rad, m; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn update(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.set_position(tree, q)?;
        self.first_derivatives();
        self.second_derivatives(tree);
        Ok(())
    }

    /// The global inertia tensors.
    pub fn tensors(&self) -> &GlobalTensors<S> {
        &self.tensors
    }

    /// M_ij (62), without armature.
    pub fn mass(&self, i: usize, j: usize) -> S {
        self.tensors.mass(i, j)
    }

    /// `Gamma^k_ij = Gamma_{i,kj} = int OP,i . OP,kj dm` (38), for any indices: symmetric in k and j.
    ///
    /// Antisymmetric in i and j where k <= min(i, j) (28b).
    pub fn gamma(&self, k: usize, i: usize, j: usize) -> S {
        let Some((d, [k, i, j])) = self.tensors.paths.on_one_branch([k, i, j]) else { return S::zero() };
        let Some(Ordered { sign, k, i, j }) = Ordered::new(k, i, j) else { return S::zero() };
        let block = &self.first.gamma[self.tensors.paths.first_block(d)];
        sign.of(block[gamma(j, k, i)])
    }

    /// `c_ijk = [ij,k] = 1/2 (M_ik,j + M_jk,i - M_ij,k)`: the Christoffel symbol of the first kind, symmetric
    /// in i and j.
    ///
    /// The convention of adaptive control: `C_kj = sum_i c_ijk v_i` makes `dM/dt - 2 C` skew. It is
    /// [`gamma(i, k, j)`](Self::gamma).
    pub fn christoffel_symbol(&self, i: usize, j: usize, k: usize) -> S {
        self.gamma(i, k, j)
    }

    /// `M_ij,k = dM_ij/dq_k` (39), for any indices; 0 where k <= min(i, j), since M does not depend on a
    /// rotation of the whole.
    pub fn mass_first(&self, i: usize, j: usize, k: usize) -> S {
        let Some((d, [i, j, k])) = self.tensors.paths.on_one_branch([i, j, k]) else { return S::zero() };
        let (i, j) = (i.min(j), i.max(j));
        if k <= i {
            return S::zero();
        }
        self.first.mass[self.tensors.paths.first_block(d)][mass_first(j.max(k), [i, j, k])]
    }

    /// `Gamma^k_ij,l = d Gamma^k_ij / dq_l`, for any indices.
    ///
    /// Stored for the independent set (45); the others by (42), `1/2 (M_ik,jl + M_ij,kl - M_kj,il)`.
    pub fn gamma_derivative(&self, k: usize, i: usize, j: usize, l: usize) -> S {
        let joints = [k, i, j];
        let Some((d, [k, i, j, l_at])) = self.tensors.paths.on_one_branch([k, i, j, l]) else {
            return S::zero();
        };
        let Some(Ordered { sign, k, i, j }) = Ordered::new(k, i, j) else { return S::zero() };
        let block = &self.second.gamma[self.tensors.paths.second_block(d)];
        if l_at >= j {
            return sign.of(block[gamma_by_last(k, i, j)]);
        }
        if i < k && k <= l_at {
            return sign.of(block[gamma_of_last(j, k, i, l_at)]);
        }
        let [k, i, j] = joints;
        let terms =
            self.mass_second(i, k, j, l) + self.mass_second(i, j, k, l) - self.mass_second(k, j, i, l);
        terms.times(0.5)
    }

    /// `M_ij,kl = d2M_ij/dq_k dq_l` (41), for any indices; 0 where k or l <= min(i, j).
    pub fn mass_second(&self, i: usize, j: usize, k: usize, l: usize) -> S {
        let Some((d, [i, j, k, l])) = self.tensors.paths.on_one_branch([i, j, k, l]) else {
            return S::zero();
        };
        let (i, j) = (i.min(j), i.max(j));
        let (k, l) = (k.min(l), k.max(l));
        if k <= i {
            return S::zero();
        }
        self.second.mass[self.tensors.paths.second_block(d)][mass_second(j.max(l), [i, j, k, l])]
    }

    /// The independent `Gamma^k_ij`, in the order of [`IndexSets::gamma`](super::IndexSets::gamma).
    pub fn stored_gamma(&self) -> &[S] {
        &self.first.gamma
    }

    /// The independent `M_ij,k`, in the order of [`IndexSets::mass_first`](super::IndexSets::mass_first).
    pub fn stored_mass_first(&self) -> &[S] {
        &self.first.mass
    }

    /// The independent `Gamma^k_ij,l`, in the order of
    /// [`IndexSets::gamma_derivatives`](super::IndexSets::gamma_derivatives).
    pub fn stored_gamma_derivatives(&self) -> &[S] {
        &self.second.gamma
    }

    /// The independent `M_ij,kl`, in the order of [`IndexSets::mass_second`](super::IndexSets::mass_second).
    pub fn stored_mass_second(&self) -> &[S] {
        &self.second.mass
    }
}

/// A stored coefficient with its sign.
#[derive(Clone, Copy)]
enum Sign {
    Plus,
    Minus,
}

impl Sign {
    fn of<S: Scalar>(self, value: S) -> S {
        match self {
            Self::Plus => value,
            Self::Minus => -value,
        }
    }
}

/// Indices of a stored coefficient, as positions on one path: i < j, k <= j.
struct Ordered {
    sign: Sign,
    k: usize,
    i: usize,
    j: usize,
}

impl Ordered {
    /// By the symmetry in k and j, then for k <= j by (28b); `None` where the coefficient is 0, i = j.
    fn new(k: usize, i: usize, j: usize) -> Option<Self> {
        let (k, j) = (k.min(j), k.max(j));
        match i.cmp(&j) {
            std::cmp::Ordering::Less => Some(Self { sign: Sign::Plus, k, i, j }),
            std::cmp::Ordering::Equal => None,
            std::cmp::Ordering::Greater => Some(Self { sign: Sign::Minus, k, i: j, j: i }),
        }
    }
}
