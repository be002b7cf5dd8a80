//! One scheme and its reference, compared.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::kinds::Kind;
use crate::configuration::ConfigurationSpace;
use crate::derivative::{CLOSE, Called, InnerNumber, Judged, Row, Verdict, rounded_once};
use crate::error::EvalError;
use crate::matrix::{Matrix, filled};
use crate::robot::Robot;
use crate::scalar::{Count, Scalar};
use crate::step::{StepContraction, StepError};
use num_dual::HyperDual;

/// Exponents of the scales, see [`Row`].
#[derive(Clone, Copy)]
pub(super) struct Scales {
    /// Of the state x.
    state: &'static [i8],
    /// Of what is dual to (x, u).
    dual: &'static [i8],
    /// Of what is dual to (x, u, h).
    dual_with_h: &'static [i8],
}

/// For x = (q, p).
pub(super) const MOMENTA: Scales = Scales { state: &[1, -1], dual: &[-1, 1, 1], dual_with_h: &[-1, 1, 1, 0] };

/// For x = (q, v).
pub(super) const VELOCITIES: Scales =
    Scales { state: &[1, 1], dual: &[-1, -1, 1], dual_with_h: &[-1, -1, 1, 0] };

/// One scheme and its reference, in `f64` and in numbers that carry their rounding error.
pub(super) struct Compared<K: Kind> {
    name: &'static str,
    scales: Scales,
    space: ConfigurationSpace,
    step: K::Step<f64>,
    reference: K::Step<Called<HyperDual<f64>>>,
    rounded_step: K::Step<Count>,
    rounded_reference: K::Step<Called<HyperDual<Count>>>,
}

impl<K: Kind> Compared<K> {
    #[inline]
    pub fn new(name: &'static str, robot: &Robot, scales: Scales) -> Self {
        Self {
            name,
            scales,
            space: ConfigurationSpace::new(robot),
            step: K::step(robot),
            reference: K::step(robot),
            rounded_step: K::step(robot),
            rounded_reference: K::step(robot),
        }
    }

    /// The rows with their rounding errors; those of the reference are propagated where one rounding is not
    /// enough, see [`Routes`](crate::derivative::Routes).
    #[inline]
    pub fn rows(
        &mut self,
        [x, u, y]: [&[f64]; 3],
        h: f64,
        d: &[f64],
        tolerance: f64,
    ) -> Result<Vec<Judged>, StepError<EvalError>> {
        let Self { name, scales, space, step, reference, rounded_step, rounded_reference } = self;
        let reference = evaluate::<K, _>(space, reference, [x, u, y], h)?;
        let rows = compare::<K, _>((name, *scales), space, step, &reference, [x, u, y], h)?;
        let exact = |values: &[f64]| values.iter().map(|&value| Count::variable(value)).collect::<Vec<_>>();
        let (x, u, y, h) = (&exact(x)[..], &exact(u)[..], &exact(y)[..], Count::variable(h));
        let mut judged = |reference| -> Result<Vec<_>, StepError<EvalError>> {
            let rounded = compare::<K, _>((name, *scales), space, rounded_step, &reference, [x, u, y], h)?;
            Ok(rows.iter().cloned().zip(rounded).map(|(row, rounded)| Judged { row, rounded }).collect())
        };
        let mut found = judged(reference.map(|part| rounded_once(&part)))?;
        if found.iter().any(|row| row.judge(d).verdict(CLOSE * tolerance) == Verdict::Differs) {
            found = judged(evaluate::<K, _>(space, rounded_reference, [x, u, y], h)?)?;
        }
        // Hyper-dual numbers take two more iterations: their value is solved to rounding.
        let value = found.remove(0).judge(d);
        if value.verdict(tolerance.max(1.0)) == Verdict::Differs {
            return Err(StepError::Inaccurate { scheme: name, difference: value.difference });
        }
        Ok(found)
    }
}

/// Phi, phi_z and `y'phi_zz d` by hyper-dual numbers over one number type: z are (d, e) in q (+) d and w + e,
/// u and h, and phi is what follows relative to Phi, see [`FreeStep`](crate::step::FreeStep).
#[inline]
fn evaluate<K: Kind, S: InnerNumber>(
    space: &ConfigurationSpace,
    reference: &mut K::Step<Called<HyperDual<S>>>,
    [x, u, y]: [&[S]; 3],
    h: S,
) -> Result<[Matrix<S>; 3], StepError<EvalError>> {
    let (nq, n) = (space.nq(), space.dof());
    let (states, inputs) = (2 * n, 3 * n + 1);
    let (zero, one): (S, S) = (Scalar::zero(), Scalar::one());
    let constant = |value: S| Called(HyperDual::new(value, zero, zero, zero));
    let constants = |values: &[S]| values.iter().map(|&value| constant(value)).collect::<Vec<_>>();
    let direction = [y, u, &[zero]].concat();
    let values = [&filled(zero, n), &x[nq..], u, &[h]].concat();
    let (from, mut at, mut change) = (constants(&x[..nq]), constants(x), constants(&values[..n]));
    let (mut phi_z, mut product) = (Matrix::zeros(states, inputs), Matrix::zeros(1, inputs - 1));
    let mut phi = Matrix::zeros(x.len(), 1);
    for j in 0..inputs {
        let unit = |l| if l == j { one } else { zero };
        let number = |l| Called(HyperDual::new(values[l], direction[l], unit(l), zero));
        let z: Vec<_> = (0..inputs).map(number).collect();
        space.integrate(&from, &z[..n], &mut at[..nq])?;
        at[nq..].copy_from_slice(&z[n..states]);
        let next = K::evaluate(reference, &at, &z[states..inputs - 1], z[inputs - 1])?;
        for (k, next) in next.iter().enumerate() {
            phi[(k, 0)] = next.0.re;
        }
        let base: Vec<_> = next[..nq].iter().map(|entry| constant(entry.0.re)).collect();
        space.difference(&base, &next[..nq], &mut change)?;
        let mut sum = zero;
        for (k, entry) in change.iter().chain(&next[nq..]).enumerate() {
            phi_z[(k, j)] = entry.0.eps2;
            sum += entry.0.eps1eps2 * y[k];
        }
        if j + 1 < inputs {
            product[(0, j)] = sum;
        }
    }
    Ok([phi, phi_z, product])
}

/// Phi, phi_z and `y'phi_zz d` by a step, compared with the reference.
#[inline]
fn compare<K: Kind, S: Scalar>(
    (name, Scales { state, dual, dual_with_h }): (&'static str, Scales),
    space: &ConfigurationSpace,
    step: &mut K::Step<S>,
    [phi, phi_z, product]: &[Matrix<S>; 3],
    [x, u, y]: [&[S]; 3],
    h: S,
) -> Result<[Row<S>; 3], StepError<EvalError>> {
    let found = K::contract(step, [x, u, y], h)?;
    let first = jacobian(&found);
    let mut by_hand = Matrix::zeros(1, y.len() + u.len());
    let (in_x, in_u) = by_hand.row_mut(0).split_at_mut(y.len());
    found.times([y, u], [in_x, in_u]);
    Ok([
        value(["Phi", name], space, found.first.next, phi.as_slice(), state)?,
        Row::new(["Phi_z, z = (x, u, h)", name], first.view(), phi_z.view(), [state, dual_with_h]),
        Row::new(["y'Phi_zz d, z = (x, u)", name], by_hand.view(), product.view(), [&[0], dual]),
    ])
}

/// The next state: its difference to the reference, and the size of this, as directions.
#[inline]
fn value<S: Scalar>(
    name: [&'static str; 2],
    space: &ConfigurationSpace,
    found: &[S],
    reference: &[S],
    state: &'static [i8],
) -> Result<Row<S>, StepError<EvalError>> {
    let (nq, n) = (space.nq(), space.dof());
    let neutral: Vec<S> = space.neutral().into_iter().map(S::from_f64).collect();
    let (mut difference, mut size) = (Matrix::zeros(1, 2 * n), Matrix::zeros(1, 2 * n));
    let ((in_q, in_w), (of_q, of_w)) =
        (difference.row_mut(0).split_at_mut(n), size.row_mut(0).split_at_mut(n));
    space.difference(&reference[..nq], &found[..nq], in_q)?;
    space.difference(&neutral, &reference[..nq], of_q)?;
    of_w.copy_from_slice(&reference[nq..]);
    for (k, entry) in in_w.iter_mut().enumerate() {
        *entry = found[nq + k] - reference[nq + k];
    }
    Ok(Row { name, difference, size, scales: [&[0], state] })
}

/// `[Phi_x, Phi_u, Phi_h]`.
#[inline]
fn jacobian<S: Scalar>(found: &StepContraction<'_, S>) -> Matrix<S> {
    let first = &found.first;
    let rows = first.phi_x.iter_rows().zip(first.phi_u.iter_rows()).zip(first.phi_h);
    let entries: Vec<S> = rows.flat_map(|((x, u), h)| [x, u, std::slice::from_ref(h)].concat()).collect();
    Matrix::from_rows(entries.len() / first.phi_h.len().max(1), &entries)
}
