//! The library's own derivatives beside automatic ones: every route against every other.

use super::function::{DerivativeError, Function, check_length};
use super::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use crate::error::EvalError;
use crate::hamiltonian::{Hamiltonian, SecondOrder};
use crate::matrix::Block;
use crate::robot::Robot;
use crate::scalar::Scalar;
use nalgebra::{DMatrix, SymmetricEigen};

/// `max |a - b| / max(max |b|, natural)` over all entries.
///
/// `natural` is the size of the terms that a quantity is the sum of: it can vanish though its terms do not (a balanced
/// wheel, friction at rest, a pendulum at a right angle), and is then rounding, of which no digit can agree.
pub fn relative_difference(a: Block<'_, f64>, b: Block<'_, f64>, natural: f64) -> f64 {
    let (a, b) = (a.as_nalgebra(), b.as_nalgebra());
    in_relation(largest(&(a - b)), largest(b), natural)
}

/// The largest absolute value; not-a-number if one is (which nalgebra's `amax` and `f64::max` would pass over).
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| worse(largest, value.abs()))
}

fn in_relation(difference: f64, size: f64, natural: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / worse(size, natural) }
}

/// Largest relative difference between two routes to F_x and to y'F_xx, see [`StateReport`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Names of the two routes.
    pub routes: (&'static str, &'static str),
    /// For F_x.
    pub f_x: f64,
    /// For y'F_xx.
    pub y_f_xx: f64,
}

/// What the routes say of each other at one state.
///
/// Differences are relative to the largest entry or, where a quantity vanishes, to its natural size (see
/// [`relative_difference`]): `e = sum |p_i v_i| + max |L_q|` for F_x; `max |y|` times e or a thousandth of `max |F_x|`
/// for y'F_xx; `max |v|` times the same for dH/dt.
#[derive(Clone, Debug, PartialEq)]
pub struct StateReport {
    /// Condition number of M in the 2-norm.
    pub condition: f64,
    /// Every pair of routes.
    pub differences: [Differences; 3],
    /// For each route of [`Routes::NAMES`]: largest asymmetry of J F_x (friction off), relative to its largest entry.
    pub jacobian_asymmetry: [f64; 3],
    /// For each route: largest asymmetry of y'F_xx, relative to its largest entry.
    pub hessian_asymmetry: [f64; 3],
    /// `|dH/dt|` along u = D = 0 relative to `sum |H_x,i F_i|`, gradient of H by dual numbers through H.
    pub energy_drift: f64,
}

impl StateReport {
    /// The largest of all figures: what must be small.
    pub fn worst(&self) -> f64 {
        let pairs = self.differences.iter().flat_map(|d| [d.f_x, d.y_f_xx]);
        let asymmetries = self.jacobian_asymmetry.iter().chain(&self.hessian_asymmetry).copied();
        pairs.chain(asymmetries).chain([self.energy_drift]).fold(0.0, worse)
    }

    /// [`worst`](Self::worst) in units of what double precision allows, `tolerance max(1, condition / 1000)`.
    pub fn excess(&self, tolerance: f64) -> f64 {
        self.worst() / (tolerance * (self.condition / 1000.0).max(1.0))
    }

    /// The larger of each figure of two reports.
    pub fn with_worse_of(mut self, other: &Self) -> Self {
        self.condition = worse(self.condition, other.condition);
        self.energy_drift = worse(self.energy_drift, other.energy_drift);
        for k in 0..3 {
            let (ours, theirs) = (&mut self.differences[k], &other.differences[k]);
            ours.f_x = worse(ours.f_x, theirs.f_x);
            ours.y_f_xx = worse(ours.y_f_xx, theirs.y_f_xx);
            self.jacobian_asymmetry[k] = worse(self.jacobian_asymmetry[k], other.jacobian_asymmetry[k]);
            self.hessian_asymmetry[k] = worse(self.hessian_asymmetry[k], other.hessian_asymmetry[k]);
        }
        self
    }
}

/// The larger of two figures; not-a-number is the worst.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// H(q, p) as a function of 2n inputs.
struct TotalEnergy(Robot);

impl Function for TotalEnergy {
    type Workspace<S: Scalar> = Hamiltonian<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.0.len()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Hamiltonian<S> {
        Hamiltonian::new(&self.0)
    }

    fn evaluate<S: Scalar>(
        &self,
        energy: &mut Hamiltonian<S>,
        x: &[S],
        h: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, p) = x.split_at(self.0.len());
        h[0] = energy.hamiltonian(q, p)?;
        Ok(())
    }
}

/// Analytic derivatives, dual numbers and hyper-dual numbers on one robot.
///
/// | route | F_x | y'F_xx |
/// |---|---|---|
/// | analytic | hand-derived | one dual pass through the hand-derived F_x |
/// | dual | dual numbers through F | dual numbers in dual numbers through F |
/// | hyperdual | hyper-dual numbers through F | hyper-dual numbers through F |
pub struct Routes {
    analytic: SecondOrder<f64>,
    dual: Jacobian<PhaseVelocity>,
    nested: NestedHessian<PhaseVelocity>,
    hyperdual: Hessian<PhaseVelocity>,
    conservative: Hamiltonian<f64>,
    conservative_dual: Jacobian<PhaseVelocity>,
    conservative_hyperdual: Hessian<PhaseVelocity>,
    energy: Jacobian<TotalEnergy>,
}

impl Routes {
    /// Names of the routes, in the order of every array.
    pub const NAMES: [&'static str; 3] = ["analytic", "dual", "hyperdual"];

    /// Builds every workspace.
    pub fn new(robot: &Robot) -> Self {
        let conservative = robot.without_friction();
        let function = || PhaseVelocity::new(robot);
        Self {
            analytic: SecondOrder::new(robot),
            dual: Jacobian::new(function()),
            nested: NestedHessian::new(function()),
            hyperdual: Hessian::new(function()),
            conservative: Hamiltonian::new(&conservative),
            conservative_dual: Jacobian::new(PhaseVelocity::new(&conservative)),
            conservative_hyperdual: Hessian::new(PhaseVelocity::new(&conservative)),
            energy: Jacobian::new(TotalEnergy(conservative)),
        }
    }

    /// Compares at x = (q, p) with actuation u and costate y (2n).
    ///
    /// # Errors
    /// Those of [`Hamiltonian`].
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
    ) -> Result<StateReport, DerivativeError<EvalError>> {
        let n = self.conservative.len();
        check_length("x", x, 2 * n)?;
        check_length("u", u, n)?;
        check_length("y", y, 2 * n)?;
        let (q, p) = x.split_at(n);
        for function in [self.dual.function_mut(), self.nested.function_mut(), self.hyperdual.function_mut()]
        {
            function.u.copy_from_slice(u);
        }
        let conservative = self.conservative.jacobian(q, p, &vec![0.0; n])?;
        let rate = conservative.f().to_vec();
        let j_f_x = [
            conservative.matrix().to_nalgebra(),
            self.conservative_dual.evaluate(x)?.jacobian.view().to_nalgebra(),
            self.conservative_hyperdual.evaluate(x)?.jacobian().view().to_nalgebra(),
        ]
        .map(|f_x| times_j(&f_x));
        let second = self.analytic.contracted_hessian(q, p, u, y)?;
        let mass_matrix = second.linearisation().mass_matrix().view().to_nalgebra();
        let first = self.dual.evaluate(x)?;
        let nested = self.nested.contracted(x, y)?;
        self.hyperdual.contracted(x, y)?;
        let by_hyperdual = self.hyperdual.last_contracted();
        let f_x =
            [second.linearisation().matrix(), first.jacobian.view(), self.hyperdual.last().jacobian().view()];
        let y_f_xx = [second.matrix(), nested.view(), by_hyperdual.view()];
        let energy = p.iter().zip(&rate).map(|(p, v)| (p * v).abs()).sum::<f64>() + largest(&rate[n..]);
        let along = worse(energy, 1e-3 * largest(f_x[0].as_nalgebra()));
        let pair = |a: usize, b: usize| Differences {
            routes: (Self::NAMES[a], Self::NAMES[b]),
            f_x: relative_difference(f_x[a], f_x[b], energy),
            y_f_xx: relative_difference(y_f_xx[a], y_f_xx[b], largest(y) * along),
        };
        let gradient = self.energy.evaluate(x)?.gradient();
        Ok(StateReport {
            condition: condition(mass_matrix),
            differences: [pair(0, 1), pair(0, 2), pair(1, 2)],
            jacobian_asymmetry: j_f_x.map(|j_f_x| asymmetry(&j_f_x, energy)),
            hessian_asymmetry: y_f_xx.map(|h| asymmetry(&h.to_nalgebra(), largest(y) * along)),
            energy_drift: drift(gradient, &rate, largest(&rate[..n]) * along),
        })
    }
}

/// `|sum_i g_i f_i| / sum_i |g_i f_i|`, see [`relative_difference`].
fn drift(gradient: &[f64], rate: &[f64], natural: f64) -> f64 {
    let terms = || gradient.iter().zip(rate).map(|(g, f)| g * f);
    in_relation(terms().sum::<f64>().abs(), terms().map(f64::abs).sum(), natural)
}

/// `J F_x` with `J = [0 1; -1 0]`.
fn times_j(f_x: &DMatrix<f64>) -> DMatrix<f64> {
    let n = f_x.nrows() / 2;
    DMatrix::from_fn(2 * n, 2 * n, |i, j| if i < n { f_x[(n + i, j)] } else { -f_x[(i - n, j)] })
}

/// `max |a - a'| / max |a|`, see [`relative_difference`].
fn asymmetry(a: &DMatrix<f64>, natural: f64) -> f64 {
    in_relation(largest(&(a - a.transpose())), largest(a), natural)
}

/// Largest over smallest eigenvalue of a symmetric positive definite matrix.
fn condition(mass_matrix: DMatrix<f64>) -> f64 {
    let values = SymmetricEigen::new(mass_matrix).eigenvalues;
    values.max() / values.min()
}

#[cfg(test)]
mod tests {
    use super::relative_difference;
    use crate::matrix::Matrix;

    /// A figure that is not a number must never look like agreement.
    #[test]
    fn not_a_number_is_not_agreement() {
        let good = Matrix::from_rows(2, &[1.0, 2.0, 3.0, 4.0]);
        for at in 0..4 {
            let mut entries = [1.0, 2.0, 3.0, 4.0];
            entries[at] = f64::NAN;
            let bad = Matrix::from_rows(2, &entries);
            assert!(relative_difference(good.view(), bad.view(), 0.0).is_nan(), "entry {at}");
            assert!(relative_difference(bad.view(), good.view(), 1.0).is_nan(), "entry {at}");
        }
        assert_eq!(relative_difference(good.view(), good.view(), 0.0), 0.0);
    }
}
