//! The reference: automatic derivatives, and how they round.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::called::ByCalls;
use super::function::{DerivativeError, Function, InnerNumber};
use super::positions::{Moved, Positions};
use super::row::{COSTATE, Row, STATE, matrix};
use super::state::State;
use super::weighted_frames::{WeightedDerivatives, WeightedFrames};
use super::{CHUNK, ForwardDynamics, Hessian, InverseDynamics, Jacobian, NestedHessian, PhaseVelocity};
use crate::error::{EvalError, LengthError};
use crate::hamiltonian::Hamiltonian;
use crate::matrix::{Block, Matrix};
use crate::robot::{Robot, Tree};
use crate::scalar::{Count, Scalar};

/// A derivative that [`Routes`](super::Routes) compares: what a [`Quantity`](crate::codegen::Quantity)
/// computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedDerivative {
    /// Arguments q, p, u; results F and F_x.
    FX,
    /// q, p, u, y (2n): F, F_x and y'F_xx.
    YFXX,
    /// q, v, u: a and a_z, z = (q, v, u).
    AZ,
    /// q, v, u, y (n): a, a_z, y'a_zz in (q, v), 2n x 2n, and in (u, q).
    YAZZ,
    /// q, v, a: tau and tau_z, z = (q, v, a).
    TauZ,
    /// q, v, a, w: tau, tau_z, w'tau_zz in (q, v), 2n x 2n, and in (a, q).
    WTauZZ,
}

/// Scales, see [`Row`]: of velocities and torques, of what is dual to (q, v, u) and to (q, v, a).
const OF_VELOCITY: &[i8] = &[1];
const OF_TORQUE: &[i8] = &[-1];
const COSTATE_OF_Z: &[i8] = &[-1, -1, 1];
const COSTATE_OF_MOTION: &[i8] = &[-1, -1, -1];

/// Derivatives of F, a, tau and H, and of weighted sums over frames, by automatic differentiation.
#[derive(Clone, Debug)]
pub(super) struct Reference<S> {
    pub f_x: Matrix<S>,
    pub y_f_xx: Matrix<S>,
    pub a_z: Matrix<S>,
    pub y_a_zz: Matrix<S>,
    /// By dual numbers, and by dual numbers in dual numbers.
    pub dual_f_x: Matrix<S>,
    pub nested_y_f_xx: Matrix<S>,
    pub dual_a_z: Matrix<S>,
    pub nested_y_a_zz: Matrix<S>,
    /// Of inverse dynamics in z = (q, v, a).
    pub tau_z: Matrix<S>,
    pub w_tau_zz: Matrix<S>,
    pub frames: WeightedDerivatives<S>,
    /// H_x without friction, 2n.
    pub energy_gradient: Vec<S>,
}

impl<S: Scalar> Reference<S> {
    /// What a method computes for one derivative, compared with the reference.
    #[inline]
    pub fn row(&self, derivative: ComparedDerivative, route: &'static str, found: Block<'_, S>) -> Row<S> {
        use ComparedDerivative::{AZ, FX, TauZ, WTauZZ, YAZZ, YFXX};
        let (quantity, expected, scales) = match derivative {
            FX => ("F_x", &self.f_x, [STATE, COSTATE]),
            YFXX => ("y'F_xx", &self.y_f_xx, [COSTATE, COSTATE]),
            AZ => ("a_z, z = (q, v, u)", &self.a_z, [OF_VELOCITY, COSTATE_OF_Z]),
            YAZZ => ("y'a_zz", &self.y_a_zz, [COSTATE_OF_Z, COSTATE_OF_Z]),
            TauZ => ("tau_z, z = (q, v, a)", &self.tau_z, [OF_TORQUE, COSTATE_OF_MOTION]),
            WTauZZ => ("w'tau_zz", &self.w_tau_zz, [COSTATE_OF_MOTION, COSTATE_OF_MOTION]),
        };
        Row::new([quantity, route], found, expected.view(), scales)
    }
}

impl Reference<f64> {
    /// With one rounding of each entry for its error: smaller than the propagated one, except where an entry
    /// is exact.
    pub fn rounded_once(&self) -> Reference<Count> {
        Reference {
            f_x: rounded_once(&self.f_x),
            y_f_xx: rounded_once(&self.y_f_xx),
            a_z: rounded_once(&self.a_z),
            y_a_zz: rounded_once(&self.y_a_zz),
            dual_f_x: rounded_once(&self.dual_f_x),
            nested_y_f_xx: rounded_once(&self.nested_y_f_xx),
            dual_a_z: rounded_once(&self.dual_a_z),
            nested_y_a_zz: rounded_once(&self.nested_y_a_zz),
            tau_z: rounded_once(&self.tau_z),
            w_tau_zz: rounded_once(&self.w_tau_zz),
            frames: self.frames.map(rounded_once),
            energy_gradient: self.energy_gradient.iter().map(|&value| Count::rounded(value)).collect(),
        }
    }
}

/// See [`Count::rounded`].
pub(crate) fn rounded_once(a: &Matrix<f64>) -> Matrix<Count> {
    matrix(a.rows(), a.columns(), |i, j| Count::rounded(a[(i, j)]))
}

/// H(q, p) as a function of 2n inputs, without friction.
struct TotalEnergy {
    tree: Tree,
    positions: Positions,
}

impl TotalEnergy {
    fn new(robot: &Robot) -> Self {
        let tree = Tree::from(&robot.without_friction());
        Self { positions: Positions::new(&tree), tree }
    }
}

impl Function for TotalEnergy {
    type Workspace<S: Scalar> = (Hamiltonian<S>, Moved<S>);
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.tree.dof()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Self::Workspace<S> {
        (Hamiltonian::from_tree(self.tree.clone()), self.positions.room())
    }

    fn evaluate<S: Scalar>(
        &self,
        (energy, moved): &mut Self::Workspace<S>,
        x: &[S],
        h: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, p) = x.split_at(self.tree.dof());
        h[0] = energy.hamiltonian(self.positions.of(moved, q)?, p)?;
        Ok(())
    }
}

/// By num-dual's numbers over `f64`.
pub(super) struct Automatic {
    dual: Jacobian<ByCalls<PhaseVelocity>>,
    nested: NestedHessian<ByCalls<PhaseVelocity>>,
    hyperdual: Hessian<ByCalls<PhaseVelocity>>,
    dual_a: Jacobian<ByCalls<ForwardDynamics>>,
    nested_a: NestedHessian<ByCalls<ForwardDynamics>>,
    hyperdual_a: Hessian<ByCalls<ForwardDynamics>>,
    torque: Hessian<ByCalls<InverseDynamics>>,
    energy: Jacobian<ByCalls<TotalEnergy>>,
    frames: Hessian<ByCalls<WeightedFrames>>,
}

impl Automatic {
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (f, a) = (|| ByCalls(PhaseVelocity::new(robot)), || ByCalls(ForwardDynamics::new(robot)));
        Self {
            dual: Jacobian::new(f()),
            nested: NestedHessian::new(f()),
            hyperdual: Hessian::new(f()),
            dual_a: Jacobian::new(a()),
            nested_a: NestedHessian::new(a()),
            hyperdual_a: Hessian::new(a()),
            torque: Hessian::new(ByCalls(InverseDynamics::new(robot))),
            energy: Jacobian::new(ByCalls(TotalEnergy::new(robot))),
            frames: Hessian::new(ByCalls(WeightedFrames::new(robot))),
        }
    }

    #[inline]
    pub fn evaluate(&mut self, state: &State<f64>) -> Result<Reference<f64>, DerivativeError<EvalError>> {
        let State { q, u, y, .. } = state;
        let (x, z, y_p) = (&state.x()[..], &state.z()[..], &y[u.len()..]);
        for function in [self.dual.function_mut(), self.nested.function_mut(), self.hyperdual.function_mut()]
        {
            function.0.u.copy_from_slice(u);
            function.0.set_centre(q).map_err(wrong)?;
        }
        let of_a =
            [self.dual_a.function_mut(), self.nested_a.function_mut(), self.hyperdual_a.function_mut()];
        of_a.into_iter().try_for_each(|function| function.0.set_centre(q)).map_err(wrong)?;
        self.torque.function_mut().0.set_centre(q).map_err(wrong)?;
        self.energy.function_mut().0.positions.set_centre(q).map_err(wrong)?;
        self.frames.function_mut().0.positions.set_centre(q).map_err(wrong)?;
        Ok(Reference {
            y_f_xx: self.hyperdual.contract(x, y)?.clone(),
            f_x: self.hyperdual.last().jacobian().clone(),
            y_a_zz: self.hyperdual_a.contract(z, y_p)?.clone(),
            a_z: self.hyperdual_a.last().jacobian().clone(),
            dual_f_x: self.dual.linearise(x)?.jacobian.clone(),
            nested_y_f_xx: self.nested.contract(x, y)?.clone(),
            dual_a_z: self.dual_a.linearise(z)?.jacobian.clone(),
            nested_y_a_zz: self.nested_a.contract(z, y_p)?.clone(),
            w_tau_zz: self.torque.contract(z, y_p)?.clone(),
            tau_z: self.torque.last().jacobian().clone(),
            frames: frames(&mut self.frames, z)?,
            energy_gradient: self.energy.linearise(x)?.gradient().to_vec(),
        })
    }
}

/// Derivatives of weighted sums in (q, v), of z = (q, v, u).
#[inline]
fn frames<T: InnerNumber>(
    frames: &mut Hessian<ByCalls<WeightedFrames>, T>,
    z: &[T],
) -> Result<WeightedDerivatives<T>, DerivativeError<EvalError>> {
    let n = z.len() / 3;
    let all = frames.hessian_tensor(&z[..2 * n])?;
    let (first, second) = (|k, j| all.jacobian()[(k, j)], |[k, i, j]: [usize; 3]| all.entry(k, i, j));
    Ok(WeightedDerivatives::new(n, first, second))
}

/// The same over numbers that carry their rounding error.
pub(super) struct Rounding {
    f: Hessian<ByCalls<PhaseVelocity>, Count>,
    a: Hessian<ByCalls<ForwardDynamics>, Count>,
    torque: Hessian<ByCalls<InverseDynamics>, Count>,
    energy: Jacobian<ByCalls<TotalEnergy>, CHUNK, Count>,
    frames: Hessian<ByCalls<WeightedFrames>, Count>,
}

impl Rounding {
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        Self {
            f: Hessian::over(ByCalls(PhaseVelocity::new(robot))),
            a: Hessian::over(ByCalls(ForwardDynamics::new(robot))),
            torque: Hessian::over(ByCalls(InverseDynamics::new(robot))),
            energy: Jacobian::over(ByCalls(TotalEnergy::new(robot))),
            frames: Hessian::over(ByCalls(WeightedFrames::new(robot))),
        }
    }

    /// Dual numbers are assumed to round like hyper-dual numbers: their entries are those of the reference.
    #[inline]
    pub fn evaluate(
        &mut self,
        state: &State<Count>,
        [q, u]: [&[f64]; 2],
    ) -> Result<Reference<Count>, DerivativeError<EvalError>> {
        let (x, y) = (&state.x()[..], &state.y);
        self.f.function_mut().0.u.copy_from_slice(u);
        self.f.function_mut().0.set_centre(q).map_err(wrong)?;
        self.a.function_mut().0.set_centre(q).map_err(wrong)?;
        self.torque.function_mut().0.set_centre(q).map_err(wrong)?;
        self.energy.function_mut().0.positions.set_centre(q).map_err(wrong)?;
        self.frames.function_mut().0.positions.set_centre(q).map_err(wrong)?;
        let z = &state.z()[..];
        let (y_f_xx, y_a_zz) = (self.f.contract(x, y)?, self.a.contract(z, &y[u.len()..])?);
        let (y_f_xx, y_a_zz) = (y_f_xx.clone(), y_a_zz.clone());
        let (f_x, a_z) = (self.f.last().jacobian().clone(), self.a.last().jacobian().clone());
        Ok(Reference {
            dual_f_x: f_x.clone(),
            nested_y_f_xx: y_f_xx.clone(),
            dual_a_z: a_z.clone(),
            nested_y_a_zz: y_a_zz.clone(),
            w_tau_zz: self.torque.contract(z, &y[u.len()..])?.clone(),
            tau_z: self.torque.last().jacobian().clone(),
            frames: frames(&mut self.frames, z)?,
            f_x,
            y_f_xx,
            a_z,
            y_a_zz,
            energy_gradient: self.energy.linearise(x)?.gradient().to_vec(),
        })
    }
}

fn wrong(error: LengthError) -> DerivativeError<EvalError> {
    DerivativeError::Function(error.into())
}
