//! Bounds of the rounding errors in the derivatives of one robot.

use super::report::{Figure, worse};
use super::rounded::Rounded;
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::kernels::{FrictionDerivatives, KernelOne, KernelTwo, LagrangianHessian, Route, friction};
use crate::lagrangian::{self, Lagrangian};
use crate::matrix::Matrix;
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};
use crate::tensors::Christoffel;
use nalgebra::{DMatrix, DVector};

/// Sizes and rounding errors of the entries of a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct EntryBounds {
    /// Sums of the absolute values of the terms of each entry.
    pub size: DMatrix<f64>,
    /// Standard deviation of the rounding error of each entry, in units of u = 2^-53.
    pub error: DMatrix<f64>,
}

/// The same for a vector.
#[derive(Clone, Debug)]
struct Vector {
    size: DVector<f64>,
    error: DVector<f64>,
}

impl EntryBounds {
    /// Compares two results entry by entry, given their difference, and keeps the entry closest to its bound,
    /// [`SAFETY`](super::SAFETY) u times the error.
    pub fn judge(
        &self,
        quantity: &'static str,
        route: &'static str,
        difference: impl Fn(usize, usize) -> f64,
    ) -> Figure {
        Figure::judge(quantity, route, difference, self)
    }

    fn new(size: DMatrix<f64>, error: DMatrix<f64>) -> Self {
        Self { size, error }
    }

    fn zeros(rows: usize, columns: usize) -> Self {
        Self::new(DMatrix::zeros(rows, columns), DMatrix::zeros(rows, columns))
    }

    fn of(matrix: &Matrix<Rounded>) -> Self {
        Self::of_part(matrix, |entry| entry)
    }

    fn of_part<S: Scalar>(matrix: &Matrix<S>, take: impl Fn(S) -> Rounded) -> Self {
        let part = |part: fn(Rounded) -> f64| {
            DMatrix::from_fn(matrix.rows(), matrix.columns(), |i, j| part(take(matrix[(i, j)])))
        };
        Self::new(part(|entry| entry.value.abs()), part(Rounded::error))
    }

    /// Of what two methods compute: the sum of the errors of both.
    fn or(&self, other: Option<Self>) -> Self {
        match other {
            Some(other) => Self::new(self.size.sup(&other.size), &self.error + &other.error),
            None => self.clone(),
        }
    }

    /// A sum: sizes and errors add up.
    fn plus(&self, other: &Self) -> Self {
        Self::new(&self.size + &other.size, &self.error + &other.error)
    }

    /// `|A| |B|`; the error is `E_A |B| + |A| E_B + sqrt(k) |A| |B|` for sums of k products.
    fn times(&self, other: &Self) -> Self {
        let size = &self.size * &other.size;
        let own = (self.size.ncols() as f64).sqrt();
        let error = &self.error * &other.size + &self.size * &other.error + &size * own;
        Self::new(size, error)
    }

    fn identity(n: usize) -> Self {
        Self::new(DMatrix::identity(n, n), DMatrix::zeros(n, n))
    }

    /// With the error of one more rounding.
    fn rounded(self) -> Self {
        Self { error: self.error + &self.size, size: self.size }
    }

    fn larger(&self, other: &Self) -> Self {
        let larger = |a: &DMatrix<f64>, b: &DMatrix<f64>| a.zip_map(b, worse);
        Self::new(larger(&self.size, &other.size), larger(&self.error, &other.error))
    }

    fn transpose(&self) -> Self {
        Self::new(self.size.transpose(), self.error.transpose())
    }

    /// `A + A'`.
    fn with_transpose(&self) -> Self {
        self.plus(&self.transpose())
    }

    fn scaled_rows(&self, by: &Vector) -> Self {
        let scaled = |a: &DMatrix<f64>, by: &DVector<f64>| DMatrix::from_diagonal(by) * a;
        let size = scaled(&self.size, &by.size);
        let error = scaled(&self.error, &by.size) + scaled(&self.size, &by.error) + &size;
        Self::new(size, error)
    }

    fn block(&mut self, (row, column): (usize, usize), block: &Self) {
        let shape = block.size.shape();
        self.size.view_mut((row, column), shape).copy_from(&block.size);
        self.error.view_mut((row, column), shape).copy_from(&block.error);
    }

    fn top_left(&self, rows: usize, columns: usize, at: (usize, usize)) -> Self {
        let part = |of: &DMatrix<f64>| of.view(at, (rows, columns)).into_owned();
        Self::new(part(&self.size), part(&self.error))
    }

    /// Of `y'A`, as a row.
    #[must_use]
    pub fn row_product(&self, y: &[f64]) -> Self {
        Self::exact_row(y).times(self)
    }

    /// Of `A d`, as a column.
    #[must_use]
    pub fn column_product(&self, d: &[f64]) -> Self {
        self.times(&Self::exact_row(d).transpose())
    }

    fn exact_row(y: &[f64]) -> Self {
        Self::new(DMatrix::from_fn(1, y.len(), |_, j| y[j].abs()), DMatrix::zeros(1, y.len()))
    }

    /// Of `A - A'` for what should be symmetric.
    #[must_use]
    pub fn asymmetry(&self) -> Self {
        self.with_transpose()
    }
}

impl Vector {
    fn exact(values: &[f64]) -> Self {
        Self {
            size: DVector::from_iterator(values.len(), values.iter().map(|x| x.abs())),
            error: DVector::zeros(values.len()),
        }
    }

    fn of<'a>(values: impl ExactSizeIterator<Item = &'a Rounded> + Clone) -> Self {
        let n = values.len();
        Self {
            size: DVector::from_iterator(n, values.clone().map(|x| x.value.abs())),
            error: DVector::from_iterator(n, values.map(|x| x.error())),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self { size: &self.size + &other.size, error: &self.error + &other.error }
    }

    fn as_column(&self) -> EntryBounds {
        let column = |x: &DVector<f64>| DMatrix::from_column_slice(x.len(), 1, x.as_slice());
        EntryBounds::new(column(&self.size), column(&self.error))
    }

    fn from_column(column: &EntryBounds) -> Self {
        Self { size: column.size.column(0).into_owned(), error: column.error.column(0).into_owned() }
    }

    /// With the error of one more rounding.
    fn rounded(self) -> Self {
        Self { error: self.error + &self.size, size: self.size }
    }

    /// These values, with these errors.
    fn around(&self, values: &[f64]) -> Vec<Rounded> {
        values.iter().zip(self.error.iter()).map(|(&value, &error)| Rounded::new(value, error)).collect()
    }
}

type TensorKernel = <Christoffel as Route>::Hessian<Tangent<Rounded>>;

/// Workspace for bounds of rounding errors, to first order: see [`Routes`](super::Routes) for their derivation.
#[derive(Clone, Debug)]
pub struct RoundingBounds {
    hamiltonian: Hamiltonian<f64>,
    forward_dynamics: Lagrangian<f64>,
    tree: Tree,
    kernel: KernelOne<Rounded>,
    along: KernelTwo<Rounded>,
    lagrangian: lagrangian::SecondOrder<Rounded>,
    /// M, P, L_qq and their derivatives by the other kernel, which starts from other constants.
    tensors: Option<TensorKernel>,
    /// Second derivatives of the forces by the Newton-Euler recursion, which starts from other constants too.
    newton_euler: Lagrangian<Tangent<Tangent<Rounded>>>,
}

/// RoundingBounds at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct DerivativeBounds {
    /// Of F, a column.
    pub f: EntryBounds,
    /// Of F_x, 2n x 2n.
    pub f_x: EntryBounds,
    /// Of y'F_xx, 2n x 2n.
    pub y_f_xx: EntryBounds,
    /// Of a, a column.
    pub acceleration: EntryBounds,
    /// Of a_z, z = (q, v, u), n x 3n.
    pub a_z: EntryBounds,
    /// Of y'a_zz, 3n x 3n, for the second half of y.
    pub y_a_zz: EntryBounds,
    /// Of dH/dt, one entry.
    pub drift: EntryBounds,
}

impl DerivativeBounds {
    /// The larger of each entry of two states.
    pub(crate) fn larger(self, other: &Self) -> Self {
        Self {
            f: self.f.larger(&other.f),
            f_x: self.f_x.larger(&other.f_x),
            y_f_xx: self.y_f_xx.larger(&other.y_f_xx),
            acceleration: self.acceleration.larger(&other.acceleration),
            a_z: self.a_z.larger(&other.a_z),
            y_a_zz: self.y_a_zz.larger(&other.y_a_zz),
            drift: self.drift.larger(&other.drift),
        }
    }

    /// Of a step of duration h in (q, p) with the weights and the direction that y'F_xx was bounded for.
    pub(crate) fn hamiltonian_step(&self, h: f64, [y, d_u]: [&[f64]; 2]) -> [EntryBounds; 2] {
        let n = d_u.len();
        let mut f_z = EntryBounds::zeros(2 * n, 3 * n);
        f_z.block((0, 0), &self.f_x);
        f_z.block((n, 2 * n), &EntryBounds::identity(n));
        let mut y_f_zz = EntryBounds::zeros(3 * n, 3 * n);
        y_f_zz.block((0, 0), &self.y_f_xx);
        step(h, [y, d_u], &self.f, &f_z, &y_f_zz)
    }

    /// Of a step of duration h in (q, v), likewise.
    pub(crate) fn lagrangian_step(&self, h: f64, [y, d_u]: [&[f64]; 2], v: &[f64]) -> [EntryBounds; 2] {
        let n = d_u.len();
        let (mut f, mut f_z) = (EntryBounds::zeros(2 * n, 1), EntryBounds::zeros(2 * n, 3 * n));
        f.block((0, 0), &Vector::exact(v).as_column());
        f.block((n, 0), &self.acceleration);
        f_z.block((0, n), &EntryBounds::identity(n));
        f_z.block((n, 0), &self.a_z);
        step(h, [y, d_u], &f, &f_z, &self.y_a_zz)
    }
}

/// Phi_z, z = (x, u, h), and `y'Phi_zz d`, a row, of one step of four stages.
///
/// With `G = 1 + h f_x` and `Z = [G^3, h G^2 f_u; 0, 1]`, `Phi_z = 1 + G^3 h f_z Z` and `y'Phi_zz = Z' h y'f_zz Z` in sizes.
fn step(
    h: f64,
    [y, d_u]: [&[f64]; 2],
    f: &EntryBounds,
    f_z: &EntryBounds,
    y_f_zz: &EntryBounds,
) -> [EntryBounds; 2] {
    let n = d_u.len();
    let scaled = |bound: &EntryBounds| EntryBounds::new(&bound.size * h, (&bound.error + &bound.size) * h);
    let (a, s) = (scaled(f_z), scaled(y_f_zz));
    let growth = EntryBounds::identity(2 * n).plus(&a.top_left(2 * n, 2 * n, (0, 0))).rounded();
    let square = growth.times(&growth);
    let cube = square.times(&growth);
    let mut lift = EntryBounds::zeros(3 * n, 3 * n);
    lift.block((0, 0), &cube);
    lift.block((0, 2 * n), &square.times(&a.top_left(2 * n, n, (0, 2 * n))));
    lift.block((2 * n, 2 * n), &EntryBounds::identity(n));
    let mut phi_z = EntryBounds::zeros(2 * n, 3 * n + 1);
    let mut first = cube.times(&a).times(&lift);
    first.block((0, 0), &first.top_left(2 * n, 2 * n, (0, 0)).plus(&EntryBounds::identity(2 * n)).rounded());
    phi_z.block((0, 0), &first);
    phi_z.block((0, 3 * n), &cube.times(&growth).times(f));
    let second = lift.transpose().times(&s).times(&lift);
    let product = second.column_product(&[y, d_u].concat()).transpose();
    [phi_z, product]
}

impl RoundingBounds {
    /// Builds the workspace.
    pub fn new(robot: &Robot) -> Self {
        let mut bounds = Self::without_tensors(robot);
        bounds.tensors = Some(LagrangianHessian::new(&bounds.tree));
        bounds
    }

    /// Bounds for methods that do not use Christoffel coefficients.
    pub(crate) fn without_tensors(robot: &Robot) -> Self {
        let tree = Tree::from(robot);
        Self {
            hamiltonian: Hamiltonian::from_tree(tree.clone()),
            forward_dynamics: Lagrangian::from_tree(tree.clone()),
            kernel: KernelOne::new(&tree),
            along: KernelTwo::new(&tree),
            lagrangian: lagrangian::SecondOrder::from_tree(tree.clone()),
            tensors: None,
            newton_euler: Lagrangian::from_tree(tree.clone()),
            tree,
        }
    }

    /// Bounds at x = (q, p) under u for the costate y (2n).
    ///
    /// # Errors
    /// Those of [`Hamiltonian`].
    pub fn at(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<DerivativeBounds, EvalError> {
        self.around(x, u, y, 0.0)
    }

    /// The same where q, p and v have errors of `input` units of u relative to themselves.
    pub(crate) fn around(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
        input: f64,
    ) -> Result<DerivativeBounds, EvalError> {
        let (q, p) = x.split_at(x.len() / 2);
        let v = &self.hamiltonian.velocity(q, p)?.to_vec()[..];
        let a = &self.forward_dynamics.forward_dynamics(q, v, u)?.to_vec()[..];
        let n = self.tree.len();
        let q: Vec<Rounded> = q.iter().map(|&q| Rounded::new(q, input * q)).collect();
        self.kernel.set_position(&self.tree, &q)?;
        let (y_q, y_p) = y.split_at(n);
        let by_tensors = match &mut self.tensors {
            Some(tensors) => {
                let moving: Vec<_> =
                    q.iter().zip(y_p).map(|(&q, &y)| Tangent::new(q, Rounded::exact(-y))).collect();
                tensors.set_position(&self.tree, &moving)?;
                Some(EntryBounds::of_part(tensors.mass_matrix(), |entry| entry.re))
            }
            None => None,
        };
        let mut m = EntryBounds::of(self.kernel.mass_matrix()).or(by_tensors);
        let values = DMatrix::from_fn(n, n, |i, j| self.kernel.mass_matrix()[(i, j)].value);
        let (factors, inverse) = factor_sizes(values);
        m.error += factors * ((3 * n + 1) as f64).sqrt();
        // M^-1: the error of M on both sides, and that of the product of the factors.
        let inverse =
            EntryBounds::new(inverse.clone(), &inverse * &m.error * &inverse + &inverse * (n as f64).sqrt());
        let solved = |right: &EntryBounds| inverse.times(right);
        let solve = |right: &Vector| Vector::from_column(&solved(&right.as_column()));
        // v = M^-1 p, P, L_qq.
        let mut momentum = Vector::exact(p);
        momentum.error = &momentum.size * input;
        let velocity = solve(&momentum);
        let rounded_v = velocity.around(v);
        self.kernel.set_velocity(&self.tree, &rounded_v)?;
        self.kernel.second_order(&self.tree);
        let coupling = EntryBounds::of(self.kernel.l_vq());
        let l_q = Vector::of(self.kernel.l_q().iter());
        let mut f = EntryBounds::zeros(2 * n, 1);
        let rubs: Vec<FrictionDerivatives<Rounded>> = self
            .tree
            .joints()
            .iter()
            .zip(&rounded_v)
            .map(|(joint, &v)| friction(&joint.friction, v))
            .collect();
        let slope = Vector::of(rubs.iter().map(|rub| &rub.first).collect::<Vec<_>>().into_iter());
        let curvature = Vector::of(rubs.iter().map(|rub| &rub.second).collect::<Vec<_>>().into_iter());
        let drag = Vector::of(rubs.iter().map(|rub| &rub.value).collect::<Vec<_>>().into_iter());
        f.block((0, 0), &velocity.as_column());
        f.block((n, 0), &l_q.plus(&drag).plus(&Vector::exact(u)).rounded().as_column());
        // Kernel two along w, which the costate defines.
        let shift: Vec<Rounded> = rubs.iter().zip(y_p).map(|(rub, &y)| rub.first.times(y)).collect();
        let along_q = Vector::exact(y_p);
        let along_p = Vector::exact(y_q).plus(&Vector::of(shift.iter()));
        let pull = coupling.times(&along_q.as_column()).plus(&along_p.as_column());
        let along_v = Vector::from_column(&solved(&pull));
        let (v_values, direction_q): (Vec<f64>, Vec<Rounded>) =
            (self.change(y_q, y_p, &rubs), y_p.iter().map(|&y| Rounded::exact(-y)).collect());
        let rounded_change = along_v.around(&v_values);
        self.along.differentiate(&self.tree, &self.kernel, &direction_q, &rounded_change)?;
        // Both kernels: P, L_qq and the derivatives of M, P and L_qq.
        let rate = |&(v, change): &(Rounded, Rounded)| Tangent::new(v, change);
        let moving: Vec<_> = rounded_v.iter().copied().zip(rounded_change).collect();
        if let Some(tensors) = &mut self.tensors {
            tensors.set_velocity(&self.tree, &moving.iter().map(rate).collect::<Vec<_>>())?;
            tensors.second_order(&self.tree);
        }
        let part = |of: fn(&TensorKernel) -> &Matrix<Tangent<Rounded>>,
                    take: fn(Tangent<Rounded>) -> Rounded| {
            self.tensors.as_ref().map(|tensors| EntryBounds::of_part(of(tensors), take))
        };
        let coupling = coupling.or(part(LagrangianHessian::l_vq, |entry| entry.re));
        let l_qq = EntryBounds::of(self.kernel.l_qq()).or(part(LagrangianHessian::l_qq, |entry| entry.re));
        let c = EntryBounds::of(self.along.mass_matrix())
            .or(part(LagrangianHessian::mass_matrix, |entry| entry.eps));
        let b = EntryBounds::of(self.along.l_vq()).or(part(LagrangianHessian::l_vq, |entry| entry.eps));
        let a_block = EntryBounds::of(self.along.l_qq()).or(part(LagrangianHessian::l_qq, |entry| entry.eps));
        let w = solved(&coupling);
        let reduced = l_qq.plus(&coupling.transpose().times(&w));
        let mut f_x = EntryBounds::zeros(2 * n, 2 * n);
        f_x.block((0, 0), &w);
        f_x.block((0, n), &inverse);
        f_x.block((n, 0), &reduced.plus(&w.scaled_rows(&slope)));
        f_x.block((n, n), &w.transpose().plus(&inverse.scaled_rows(&slope)));
        let mut v_x = EntryBounds::zeros(n, 2 * n);
        v_x.block((0, 0), &w);
        v_x.block((0, n), &inverse);
        let mut inner = EntryBounds::zeros(n, 2 * n);
        inner.block((0, 0), &b);
        // V' C V + B' V + V' B + A, and the curvature of friction.
        let mut y_f_xx =
            v_x.transpose().times(&c.times(&v_x)).plus(&v_x.transpose().times(&inner).with_transpose());
        let mut corner = EntryBounds::zeros(2 * n, 2 * n);
        corner.block((0, 0), &a_block);
        y_f_xx = y_f_xx.plus(&corner);
        let bent = v_x.scaled_rows(&Vector {
            size: curvature.size.component_mul(&along_q.size),
            error: curvature.error.component_mul(&along_q.size),
        });
        y_f_xx = y_f_xx.plus(&v_x.transpose().times(&bent));
        // dH/dt: gradient (by half of p' dv/dx) times rate.
        let half_p: Vec<f64> = p.iter().map(|p| 0.5 * p).collect();
        let mut gradient = v_x.row_product(&half_p);
        gradient.block((0, 0), &gradient.top_left(1, n, (0, 0)).plus(&l_q.as_column().transpose()));
        gradient.block((0, n), &gradient.top_left(1, n, (0, n)).plus(&velocity.as_column().transpose()));
        let mut rate = EntryBounds::zeros(2 * n, 1);
        rate.block((0, 0), &velocity.as_column());
        rate.block((n, 0), &l_q.as_column());
        let drift = gradient.times(&rate);
        let rounded_v: Vec<Rounded> = v.iter().map(|&v| Rounded::new(v, input * v)).collect();
        let (acceleration, a_z, y_a_zz) = self.forward(&q, &rounded_v, a, u, y_p, &inverse)?;
        Ok(DerivativeBounds { f, f_x, y_f_xx, acceleration, a_z, y_a_zz, drift })
    }

    /// `V w` in values.
    fn change(&self, y_q: &[f64], y_p: &[f64], rubs: &[FrictionDerivatives<Rounded>]) -> Vec<f64> {
        let n = y_q.len();
        let value = |m: &Matrix<Rounded>| DMatrix::from_fn(n, n, |i, j| m[(i, j)].value);
        let (m, p) = (value(self.kernel.mass_matrix()), value(self.kernel.l_vq()));
        let w_p = DVector::from_fn(n, |i, _| y_q[i] + rubs[i].first.value * y_p[i]);
        let right = w_p + p * DVector::from_column_slice(y_p);
        m.cholesky().map_or_else(|| vec![f64::NAN; n], |factor| factor.solve(&right).as_slice().to_vec())
    }

    /// a_z and y'a_zz, z = (q, v, u).
    fn forward(
        &mut self,
        q: &[Rounded],
        v: &[Rounded],
        a: &[f64],
        u: &[f64],
        y: &[f64],
        inverse: &EntryBounds,
    ) -> Result<(EntryBounds, EntryBounds, EntryBounds), EvalError> {
        let n = v.len();
        let exact = |x: &[f64]| x.iter().map(|&x| Rounded::exact(x)).collect::<Vec<_>>();
        let bias = Vector::of(self.lagrangian.first().inverse_dynamics(q, v, &exact(&vec![0.0; n]))?.iter());
        let tau = Vector::of(self.lagrangian.first().inverse_dynamics(q, v, &exact(a))?.iter());
        let bias = Vector { error: tau.error, ..bias };
        let solve = |right: &Vector| Vector::from_column(&inverse.times(&right.as_column()));
        let acceleration = solve(&bias.plus(&Vector::exact(u)));
        let rounded_a = acceleration.around(a);
        let tau = self.lagrangian.first().inverse_dynamics_jacobian(q, v, &rounded_a)?;
        let mut a_z = EntryBounds::zeros(n, 3 * n);
        a_z.block((0, 0), &inverse.times(&EntryBounds::of(tau.tau_q)));
        a_z.block((0, n), &inverse.times(&EntryBounds::of(tau.tau_v)));
        a_z.block((0, 2 * n), inverse);
        let values = DMatrix::from_fn(n, n, |i, j| tau.tau_a[(i, j)].value);
        let weights = solve(&Vector::exact(y));
        let w = values.cholesky().map_or_else(
            || vec![f64::NAN; n],
            |factor| factor.solve(&DVector::from_column_slice(y)).as_slice().to_vec(),
        );
        let mut hessian = EntryBounds::of(self.lagrangian.inverse_dynamics_hessian(
            q,
            v,
            &rounded_a,
            &weights.around(&w),
        )?);
        let reference = self.force_hessian(q, v, &rounded_a, &weights.size)?;
        hessian.error.view_mut((0, 0), (2 * n, 2 * n)).zip_apply(&reference, |sum, error| *sum += error);
        let mut y_a_zz = EntryBounds::zeros(3 * n, 3 * n);
        y_a_zz.block((0, 0), &hessian.top_left(2 * n, 2 * n, (0, 0)));
        let mut mixed = EntryBounds::zeros(3 * n, 3 * n);
        mixed.block((0, 0), &a_z.transpose().times(&hessian.top_left(n, n, (2 * n, 0))));
        y_a_zz = y_a_zz.plus(&mixed.with_transpose());
        Ok((acceleration.as_column(), a_z, y_a_zz))
    }

    /// Errors of `sum_k w_k d2 tau_k / dz dz`, z = (q, v), by the Newton-Euler recursion, for the sizes of w.
    fn force_hessian(
        &mut self,
        q: &[Rounded],
        v: &[Rounded],
        a: &[Rounded],
        w: &DVector<f64>,
    ) -> Result<DMatrix<f64>, EvalError> {
        let n = q.len();
        let (zero, one) = (Rounded::exact(0.0), Rounded::exact(1.0));
        let constant = |value: Rounded| Tangent::new(Tangent::new(value, zero), Tangent::new(zero, zero));
        let mut z: Vec<_> = q.iter().chain(v).map(|&value| constant(value)).collect();
        let a: Vec<_> = a.iter().map(|&value| constant(value)).collect();
        let mut errors = DMatrix::zeros(2 * n, 2 * n);
        for j in 0..2 * n {
            z[j].eps.re = one;
            for i in 0..=j {
                z[i].re.eps = one;
                let (q, v) = z.split_at(n);
                let tau = self.newton_euler.inverse_dynamics(q, v, &a)?;
                let error = tau.iter().zip(w.iter()).map(|(tau, w)| w * tau.eps.eps.error()).sum();
                z[i].re.eps = zero;
                errors[(i, j)] = error;
                errors[(j, i)] = error;
            }
            z[j].eps.re = zero;
        }
        Ok(errors)
    }
}

/// `|L'| D |L|` and `|U| D^-1 |U'|`, U = L^-1, for `M = L' D L`: what the rounding of a factorisation and of the inverse are in
/// proportion to. Both are at least |M| and |M^-1|, and their entries at most `sqrt(M_ii M_jj)`, `sqrt(M^-1_ii M^-1_jj)`.
fn factor_sizes(mut m: DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = m.nrows();
    let mut l = DMatrix::identity(n, n);
    let mut pivots = DVector::zeros(n);
    for k in (0..n).rev() {
        pivots[k] = m[(k, k)];
        for i in 0..k {
            l[(k, i)] = m[(k, i)] / pivots[k];
        }
        for i in 0..k {
            for j in 0..k {
                m[(i, j)] -= l[(k, i)] * m[(k, j)];
            }
        }
    }
    let mut u: DMatrix<f64> = DMatrix::identity(n, n);
    for i in 0..n {
        for j in 0..i {
            u[(i, j)] = -(j..i).map(|k| l[(i, k)] * u[(k, j)]).sum::<f64>();
        }
    }
    let d = DMatrix::from_diagonal(&pivots.abs());
    let inverse = DMatrix::from_diagonal(&pivots.map(|pivot| pivot.abs().recip()));
    (l.abs().transpose() * d * l.abs(), u.abs() * inverse * u.abs().transpose())
}
