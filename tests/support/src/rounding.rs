//! Tolerances of properties: how far rounding may take two results apart.
//!
//! A tolerance comes from the terms that are added, not from what is left of their sum: terms of 1 whose sum
//! is 1e-9 leave 1e-16, which is 1e-7 of the result. Three ways, in this order:
//!
//! 1. [`rounding!`](crate::rounding!): the formula of the property, written once for any number, is evaluated
//!    with `f64` and with [`Count`], which carries the variance of its rounding error through every
//!    operation. Each block of differences may be as large as [`bound`] says: the bound of `costate check`
//!    (docs/check.md).
//! 2. [`Bounds`] and [`InverseBounds`]: the same of the usual quantities of a robot, for methods that have no
//!    generic code (programs, machine code, lanes) or that round as the generic code does (dual numbers).
//! 3. [`terms`]: the sum of the magnitudes of what is added, times u and the number of operations.

use crate::random_robot::condition;
use costate::derivative::{SAFETY, largest};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::{Count, Scalar, Tangent};
use proptest::prelude::TestCaseError;
use std::cell::Cell;

/// u = 2^-53, the largest relative error of one operation.
pub const UNIT: f64 = 0.5 * f64::EPSILON;

/// Operations on the way of a term past one joint: a rotation by an angle and one by a constant matrix (45
/// each), a displacement (18) and what is added to it.
pub const OPERATIONS: usize = 120;

/// A number type in which a formula is evaluated and which says how its difference may round.
pub type Differences<S> = Vec<(&'static str, Vec<S>)>;

/// Evaluates blocks of differences, which vanish but for rounding, with `f64` and with [`Count`]: an error
/// for the first block that is larger than its [`bound`].
///
/// ```text
/// rounding!(|S| {
///     let q: Vec<S> = lift(&case.q);
///     vec![("M - M'", apart(&m(&q), &transposed(&m(&q))))]
/// })?;
/// ```
#[macro_export]
macro_rules! rounding {
    (|$number:ident| $body:expr) => {{
        let found: $crate::rounding::Differences<f64> = {
            type $number = f64;
            $body
        };
        $crate::rounding::vanish(&found, || {
            type $number = costate::scalar::Count;
            $body
        })
    }};
}

/// What constants that `f64` prepares before anything is counted may leave: [`Count`] takes what they make
/// zero as exact. Those of random robots (masses, lengths, cosines) are of size one, and are put together as
/// the terms past one joint are.
const CONSTANTS: f64 = 2.0 * UNIT * OPERATIONS as f64;

/// Whether every block of differences is at most its bound.
pub fn vanish(
    found: &Differences<f64>,
    rounded: impl FnOnce() -> Differences<Count>,
) -> Result<(), TestCaseError> {
    if found.iter().all(|(_, block)| largest(block) == 0.0) {
        return Ok(());
    }
    let rounded = rounded();
    assert_eq!(found.len(), rounded.len());
    for ((name, block), (_, of_rounding)) in found.iter().zip(&rounded) {
        within(name, block, bound(of_rounding).max(CONSTANTS))?;
    }
    Ok(())
}

/// The same of blocks by two methods, whose rounding errors are counted one by one: those of the second, most
/// of the work, where those of the first do not explain the differences, as in `costate check`.
pub fn explained<const N: usize>(
    names: [&str; N],
    [found, expected]: [&[Vec<f64>; N]; 2],
    of_found: &[Vec<Count>; N],
    of_expected: impl FnOnce() -> Result<[Vec<Count>; N], TestCaseError>,
) -> Result<(), TestCaseError> {
    let differences: [_; N] = std::array::from_fn(|k| apart(&found[k], &expected[k]));
    let mut bounds = of_found.each_ref().map(bound);
    if differences
        .iter()
        .zip(&bounds)
        .any(|(block, bound)| largest(block).is_nan() || largest(block) > *bound)
    {
        let more = of_expected()?;
        bounds.iter_mut().zip(&more).for_each(|(sum, block)| *sum += bound(block));
    }
    names
        .iter()
        .zip(&differences)
        .zip(bounds)
        .try_for_each(|((name, block), bound)| within(name, block, bound))
}

/// 32 standard deviations of the rounding error, the largest of a block; not-a-number if one is.
pub fn bound<'a>(block: impl IntoIterator<Item = &'a Count>) -> f64 {
    let deviations: Vec<f64> = block.into_iter().map(|entry| entry.rounding()).collect();
    SAFETY * UNIT * largest(&deviations)
}

thread_local! {
    /// How many comparisons used more than 1/2, 1/4, .. of their bounds; the last one counts all.
    static USED: Cell<[u64; PARTS]> = const { Cell::new([0; PARTS]) };
}

const PARTS: usize = 12;

/// What [`within`] has counted on this thread since it was asked last: comparisons that used more than 2^-1,
/// 2^-2, .. of their bounds, and all of them.
pub fn take_used() -> [u64; PARTS] {
    USED.replace([0; PARTS])
}

fn count(worst: f64, bound: f64) {
    let mut used = USED.get();
    for (k, used) in used.iter_mut().enumerate() {
        let part = if k + 1 == PARTS { -1.0 } else { 0.5_f64.powi(k as i32 + 1) };
        *used += u64::from(worst > part * bound);
    }
    USED.set(used);
}

/// An error if an entry exceeds the bound, or one of both is not a number.
pub fn within(name: &str, differences: &[f64], bound: f64) -> Result<(), TestCaseError> {
    let worst = largest(differences);
    count(worst, bound);
    if worst <= bound {
        return Ok(());
    }
    Err(TestCaseError::fail(format!("{name} is off by {worst:.2e}, and rounding explains {bound:.2e}")))
}

/// As [`within`], of two results.
pub fn close(name: &str, found: &[f64], expected: &[f64], bound: f64) -> Result<(), TestCaseError> {
    if found.len() != expected.len() {
        return Err(TestCaseError::fail(format!("{name} has {} entries of {}", found.len(), expected.len())));
    }
    within(name, &apart(found, expected), bound)
}

/// `2 u operations sum |terms|`: bound of a sum whose terms come from so many operations each, twice.
pub fn terms<'a>(operations: usize, terms: impl IntoIterator<Item = &'a f64>) -> f64 {
    2.0 * UNIT * operations as f64 * terms.into_iter().map(|term| term.abs()).sum::<f64>()
}

/// The same numbers as another type, without error.
pub fn lift<S: Scalar>(values: &[f64]) -> Vec<S> {
    values.iter().map(|&value| S::from_f64(value)).collect()
}

/// Numbers that were rounded once: [`Count`] gives each the error u. Unit quaternions have the length 1 up to
/// that.
pub fn lift_rounded<S: Scalar>(values: &[f64]) -> Vec<S> {
    values.iter().map(|&value| S::zero().plus(value)).collect()
}

/// Values that move at these rates.
pub fn moving<S: Scalar>(values: &[S], rates: &[S]) -> Vec<Tangent<S>> {
    values.iter().zip(rates).map(|(&value, &rate)| Tangent::new(value, rate)).collect()
}

/// `a - b`, entry by entry.
pub fn apart<S: Scalar>(a: &[S], b: &[S]) -> Vec<S> {
    assert_eq!(a.len(), b.len(), "entries");
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// Row by row.
pub fn rows<S: Scalar>(block: Block<'_, S>) -> Vec<S> {
    block.iter_rows().flatten().copied().collect()
}

/// A x of a matrix row by row.
pub fn times<S: Scalar>(a: &[S], x: &[S]) -> Vec<S> {
    a.chunks(x.len()).map(|row| row.iter().zip(x).fold(S::zero(), |sum, (&a, &x)| sum + a * x)).collect()
}

/// A B of matrices row by row, B with so many rows.
pub fn product<S: Scalar>(a: &[S], b: &[S], rows: usize) -> Vec<S> {
    let columns = b.len() / rows;
    let entry = |row: &[S], j: usize| (0..rows).fold(S::zero(), |sum, k| sum + row[k] * b[k * columns + j]);
    a.chunks(rows).flat_map(|row| (0..columns).map(move |j| entry(row, j))).collect()
}

/// A' x of a matrix row by row.
pub fn transposed_times<S: Scalar>(a: &[S], x: &[S]) -> Vec<S> {
    let columns = a.len() / x.len();
    let entry = |j: usize| x.iter().enumerate().fold(S::zero(), |sum, (i, &x)| sum + a[i * columns + j] * x);
    (0..columns).map(entry).collect()
}

/// Where bounds are asked for.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    pub q: &'a [f64],
    pub v: &'a [f64],
    pub u: &'a [f64],
    /// 2n.
    pub y: &'a [f64],
    /// 2n.
    pub d: &'a [f64],
}

/// Bound of the rounding of what is added up past all joints of a robot, the sum of whose terms is `size`.
///
/// [`Count`] takes the constants of a robot as exact, and what they make zero, too. A method that rounds them
/// once more, or differentiates M number by number, leaves terms that cancel: they are bounded by their size.
pub fn of_joints(robot: &Robot, size: f64) -> f64 {
    terms(OPERATIONS * robot.joints().len(), &[size])
}

/// The same relative to products with M^-1. Factors and solutions of n equations lose (3n + 1) u of the
/// condition of M (Higham, Accuracy and Stability of Numerical Algorithms, 2002, theorem 10.4).
pub fn of_inverse(robot: &Robot, q: &[f64]) -> f64 {
    of_joints(robot, 1.0) + terms(3 * robot.dof() + 1, &[condition(robot, q)])
}

/// The same of M: entries are sums over bodies, whose terms are at most the largest entry of the diagonal
/// (Cauchy and Schwarz, body by body), and those of the constants: inertias of links about their joints.
fn of_mass_matrix(robot: &Robot, m: &[Count], n: usize) -> f64 {
    let diagonal = (0..n).map(|i| m[i * (n + 1)].value()).fold(0.0, f64::max);
    let own = robot.joints().iter().map(|joint| {
        let link = &joint.inertia;
        link.inertia.trace().abs() + link.mass * link.com.norm_squared()
    });
    of_joints(robot, own.fold(diagonal, f64::max))
}

/// The largest magnitude of these numbers.
pub fn size(block: &[Count]) -> f64 {
    block.iter().map(|entry| entry.value().abs()).fold(0.0, f64::max)
}

fn sum(block: &[Count]) -> f64 {
    block.iter().map(|entry| entry.value().abs()).sum()
}

/// Absolute bounds of the difference of two methods for quantities that need no M^-1: twice those of the
/// methods by hand, and the rounding of terms that cancel ([`of_joints`]).
#[derive(Clone, Copy, Debug)]
pub struct InverseBounds {
    pub m: f64,
    /// p = M v.
    pub p: f64,
    pub kinetic: f64,
    pub potential: f64,
    /// Inverse dynamics, its derivatives, and w' times the second ones.
    pub tau: f64,
    pub tau_z: f64,
    pub w_tau_zz: f64,
}

impl InverseBounds {
    pub fn new(robot: &Robot, [q, v, a, w]: [&[f64]; 4]) -> Self {
        let [q, v, a, w] = [q, v, a, w].map(lift::<Count>);
        let mut second = LagrangianSecondOrder::<Count>::new(robot);
        let energy = second.first().energy(&q, &v).unwrap();
        let m = second.first().mass_matrix(&q).unwrap().as_slice().to_vec();
        let all = second.contract_inverse_dynamics(&q, &v, &a, &w).unwrap();
        let linear = all.inverse_dynamics();
        let blocks = [linear.tau_q, linear.tau_v, linear.tau_a];
        let tau_z = largest(&blocks.map(|block| twice(block.as_slice())));
        // Terms of tau: M a, products of two velocities, and weights and springs, which change by as much as
        // they are where q changes by 1. Each derivative takes one of two factors of a term; w' adds n terms.
        let slopes = largest(&blocks.map(|block| size(block.as_slice()))).max(size(linear.tau)).max(1.0);
        let force = slopes + size(&m) * (sum(&a) + sum(&v).powi(2));
        let bends = all.zz();
        let of_w = (4.0 * force * sum(&w)).max(size(bends.as_slice()));
        let (of_m, speed) = (of_mass_matrix(robot, &m, v.len()), sum(&v));
        Self {
            p: twice(&times(&m, &v)) + of_m * speed,
            m: twice(&m) + of_m,
            kinetic: twice(&[energy.kinetic]) + of_m * speed * speed,
            potential: twice(&[energy.potential]) + of_joints(robot, slopes.max(size(&[energy.potential]))),
            tau: twice(linear.tau) + of_joints(robot, force),
            tau_z: tau_z + of_joints(robot, 2.0 * force),
            w_tau_zz: twice(bends.as_slice()) + of_joints(robot, of_w),
        }
    }
}

/// The same of quantities with M^-1, at (q, v) where M is regular; p = M v with its rounding error. The terms
/// that cancel are of the size of the results, and round as [`of_inverse`] says.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub m: f64,
    pub inverse: f64,
    /// In (q, p).
    pub f: f64,
    pub f_x: f64,
    pub y_f_x: f64,
    pub y_f_xx: f64,
    /// y'F_xx d.
    pub product: f64,
    pub kinetic: f64,
    pub potential: f64,
    /// In (q, v), with the second half of y.
    pub a: f64,
    pub a_z: f64,
    pub y_a_z: f64,
    pub y_a_zz: f64,
}

impl Bounds {
    /// With d = y.
    pub fn new(robot: &Robot, [q, v, u, y]: [&[f64]; 4]) -> Self {
        Self::at(robot, At { q, v, u, y, d: y })
    }

    pub fn at(robot: &Robot, At { q, v, u, y, d }: At<'_>) -> Self {
        let [q, v, u, y, d] = [q, v, u, y, d].map(lift::<Count>);
        let mut second = HamiltonianSecondOrder::<Count>::new(robot);
        let p = second.first().momentum(&q, &v).unwrap().to_vec();
        let m = second.first().mass_matrix(&q).unwrap().as_slice().to_vec();
        let inverse = second.first().inverse_mass_matrix(&q).unwrap().as_slice().to_vec();
        let product = twice(second.hessian_product(&q, &p, &y, &d).unwrap());
        let y_f_x = twice(second.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x);
        let energy = second.first().energy(&q, &p).unwrap();
        let all = second.contract(&q, &p, &u, &y).unwrap();
        let (f, f_x) = (all.linearisation().f().to_vec(), rows(all.linearisation().matrix()));
        let y_f_xx = rows(all.matrix());
        let (mut second, w) = (LagrangianSecondOrder::<Count>::new(robot), &y[u.len()..]);
        let all = second.contract_forward_dynamics(&q, &v, &u, w).unwrap();
        let linear = all.forward_dynamics();
        let (a, a_z, y_a_zz) = (linear.acceleration().to_vec(), rows(linear.matrix()), all.to_matrix());
        // Terms that cancel: what is zero by hand is a difference of products with M^-1 elsewhere. They are
        // of the size of f and its derivatives.
        let of_m = of_mass_matrix(robot, &m, v.len());
        let relative = of_inverse(robot, &q.iter().map(|q| q.value()).collect::<Vec<_>>());
        let of_f = relative * size(&f_x).max(size(&f)).max(1.0);
        let of_second = (of_f * size(&y)).max(relative * size(&y_f_xx));
        let of_a = relative * size(&a_z).max(size(&a)).max(1.0);
        Self {
            m: twice(&m) + of_m,
            inverse: twice(&inverse) + relative * size(&inverse),
            f: twice(&f) + of_f,
            f_x: twice(&f_x) + of_f,
            y_f_x: y_f_x + of_f * size(&y),
            y_f_xx: twice(&y_f_xx) + of_second,
            product: product + of_second * size(&d).max(1.0),
            kinetic: twice(&[energy.kinetic]) + relative * size(&[energy.kinetic]),
            potential: twice(&[energy.potential]) + of_f.max(relative * size(&[energy.potential])),
            a: twice(&a) + of_a,
            y_a_z: twice(&transposed_times(&a_z, w)) + of_a * size(w),
            a_z: twice(&a_z) + of_a,
            y_a_zz: twice(y_a_zz.as_slice()) + (of_a * size(w)).max(relative * size(y_a_zz.as_slice())),
        }
    }
}

impl Bounds {
    /// The larger of both, one by one.
    #[must_use]
    pub fn largest(self, other: Self) -> Self {
        let max = f64::max;
        Self {
            m: max(self.m, other.m),
            inverse: max(self.inverse, other.inverse),
            f: max(self.f, other.f),
            f_x: max(self.f_x, other.f_x),
            y_f_x: max(self.y_f_x, other.y_f_x),
            y_f_xx: max(self.y_f_xx, other.y_f_xx),
            product: max(self.product, other.product),
            kinetic: max(self.kinetic, other.kinetic),
            potential: max(self.potential, other.potential),
            a: max(self.a, other.a),
            a_z: max(self.a_z, other.a_z),
            y_a_z: max(self.y_a_z, other.y_a_z),
            y_a_zz: max(self.y_a_zz, other.y_a_zz),
        }
    }
}

fn twice(block: &[Count]) -> f64 {
    2.0 * bound(block)
}
