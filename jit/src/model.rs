//! A robot as a model by machine code, for one state and for four.

use crate::error::JitError;
use crate::fours::{Fours, Quantities};
use crate::quantity::{Backend, JitQuantity};
use costate::codegen::{CodegenError, Coordinates, Quantity};
use costate::dynamics::{Contraction, Dynamics, Linearisation, Structure};
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::scalar::{F64x4, Scalar};
use costate::{EvalError, LengthError};

/// [`Dynamics`] of a robot in either coordinates, x = (q, p) or (q, v): f, its Jacobians and contracted
/// Hessians by machine code, or by the generic code where there is none.
///
/// For optimisers and for [time steps](costate::step), as [`JitQuantity`] is for single quantities; a clone
/// is a workspace for another thread. [`JitLanesModel`] is the same for four states at once.
///
/// ```
/// use costate::codegen::Coordinates;
/// use costate::robot::Robot;
/// use costate::step::{RungeKutta4, Step};
/// use costate_jit::JitModel;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut step = RungeKutta4::new(JitModel::new(&robot, Coordinates::Lagrangian)?);
/// let next = step.evaluate(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.0], 0.01)?;
/// assert!((next[0] - 0.31).abs() < 1e-2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct JitModel<S: Scalar = f64, Q = [JitQuantity; 3]> {
    coordinates: Coordinates,
    n: usize,
    quantities: Q,
    inputs: Vec<S>,
    outputs: Vec<S>,
    f: Vec<S>,
    f_x: Matrix<S>,
    f_u: Matrix<S>,
    xx: Matrix<S>,
    ux: Matrix<S>,
}

/// A [`JitModel`] for four states at once: [`JitModel::over_lanes`] makes it.
pub type JitLanesModel = JitModel<F64x4, Fours>;

/// Positions of the quantities.
const VALUE: usize = 0;
const FIRST: usize = 1;
const SECOND: usize = 2;

/// The quantities in the order of their positions.
const QUANTITIES: [Quantity; 3] = [Quantity::F, Quantity::FX, Quantity::YFXX];

impl JitModel {
    /// Records and compiles f, f_x and y'f_xx.
    ///
    /// # Errors
    /// [`CodegenError`]; all three are defined in both coordinates. [`EvalError::FreeJoint`] for a robot with
    /// floating or spherical joints.
    pub fn new(robot: &Robot, coordinates: Coordinates) -> Result<Self, CodegenError> {
        Ok(Self::of(robot.dof(), coordinates, quantities(robot, coordinates)?))
    }

    /// How f, its Jacobians and its contracted Hessian are computed.
    pub fn backends(&self) -> [Backend<'_>; 3] {
        self.quantities.each_ref().map(JitQuantity::backend)
    }
}

impl JitLanesModel {
    /// Records and compiles f, f_x and y'f_xx for four states at once, each lane one of them; or says why
    /// there is no machine code.
    ///
    /// A [batch](costate::batch) of it evaluates any number of states, a [step](costate::step) of it steps
    /// from four. Where machine code is not certain of a state, the [quantities](JitQuantity) of one state
    /// compute it; an error is that of the first lane that has one.
    ///
    /// ```
    /// use costate::batch::{Batch, Model};
    /// use costate::codegen::Coordinates;
    /// use costate::robot::Robot;
    /// use costate_jit::JitModel;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// let robot = Robot::from_file("robots/two_link.toml")?;
    /// if let Ok(model) = JitModel::over_lanes(&robot, Coordinates::Lagrangian)? {
    ///     let (x, u, mut f) = (vec![0.2; 100 * 4], vec![0.0; 100 * 2], vec![0.0; 100 * 4]);
    ///     assert!(Batch::new(Model(model)).evaluate(&x, &u, &mut f)?.is_empty());
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CodegenError`] as [`JitModel::new`].
    pub fn over_lanes(
        robot: &Robot,
        coordinates: Coordinates,
    ) -> Result<Result<Self, JitError>, CodegenError> {
        let one = quantities(robot, coordinates)?;
        let fours = Fours::new(robot, QUANTITIES, coordinates, one)?;
        Ok(fours.map(|fours| Self::of(robot.dof(), coordinates, fours)))
    }
}

/// The quantities of one state.
fn quantities(robot: &Robot, coordinates: Coordinates) -> Result<[JitQuantity; 3], CodegenError> {
    // The first half of x is q, the first half of f its rate.
    robot.refuse_free_joints()?;
    let [f, f_x, y_f_xx] = QUANTITIES.map(|quantity| JitQuantity::new(robot, quantity, coordinates));
    Ok([f?, f_x?, y_f_xx?])
}

impl<S: Scalar, Q: Quantities<S>> JitModel<S, Q> {
    fn of(n: usize, coordinates: Coordinates, quantities: Q) -> Self {
        let (mut f_x, mut f_u) = (Matrix::zeros(2 * n, 2 * n), Matrix::zeros(2 * n, n));
        for i in 0..n {
            match coordinates {
                Coordinates::Hamiltonian => f_u[(n + i, i)] = S::one(),
                Coordinates::Lagrangian => f_x[(i, n + i)] = S::one(),
            }
        }
        Self {
            coordinates,
            n,
            inputs: vec![S::zero(); 5 * n],
            outputs: vec![S::zero(); quantities.outputs(SECOND)],
            quantities,
            f: vec![S::zero(); 2 * n],
            f_x,
            f_u,
            xx: Matrix::zeros(2 * n, 2 * n),
            ux: Matrix::zeros(n, n),
        }
    }

    /// Evaluates one of the quantities and takes f.
    fn run(&mut self, which: usize, x: &[S], u: &[S], y: &[S]) -> Result<(), EvalError> {
        let n = self.n;
        for (what, expected, found) in [("x", 2 * n, x.len()), ("u", n, u.len())] {
            LengthError::check(what, expected, found)?;
        }
        self.inputs[..2 * n].copy_from_slice(x);
        self.inputs[2 * n..3 * n].copy_from_slice(u);
        self.inputs[3 * n..3 * n + y.len()].copy_from_slice(y);
        let outputs = &mut self.outputs[..self.quantities.outputs(which)];
        self.quantities.evaluate(which, &self.inputs[..3 * n + y.len()], outputs)?;
        match self.coordinates {
            Coordinates::Hamiltonian => self.f.copy_from_slice(&self.outputs[..2 * n]),
            Coordinates::Lagrangian => {
                self.f[..n].copy_from_slice(&x[n..]);
                self.f[n..].copy_from_slice(&self.outputs[..n]);
            }
        }
        Ok(())
    }

    /// Takes the Jacobians; returns where the results behind them begin.
    fn take_jacobians(&mut self) -> usize {
        let n = self.n;
        match self.coordinates {
            Coordinates::Hamiltonian => {
                let end = 2 * n + 4 * n * n;
                take(&mut self.f_x, &self.outputs[2 * n..end]);
                end
            }
            Coordinates::Lagrangian => {
                let end = n + 3 * n * n;
                for (i, row) in self.outputs[n..end].chunks_exact(3 * n).enumerate() {
                    self.f_x.row_mut(n + i).copy_from_slice(&row[..2 * n]);
                    self.f_u.row_mut(n + i).copy_from_slice(&row[2 * n..]);
                }
                end
            }
        }
    }

    fn first(&self) -> Linearisation<'_, S> {
        Linearisation { f: &self.f, f_x: self.f_x.view(), f_u: self.f_u.view() }
    }
}

/// All entries, row by row.
fn take<S: Scalar>(matrix: &mut Matrix<S>, entries: &[S]) {
    let columns = matrix.columns();
    for (i, row) in entries.chunks_exact(columns.max(1)).enumerate() {
        matrix.row_mut(i).copy_from_slice(row);
    }
}

impl<S: Scalar, Q: Quantities<S>> Dynamics<S> for JitModel<S, Q> {
    type Error = EvalError;

    fn states(&self) -> usize {
        2 * self.n
    }

    fn controls(&self) -> usize {
        self.n
    }

    fn structure(&self) -> Structure {
        match self.coordinates {
            Coordinates::Hamiltonian => {
                Structure { constant_f_u: true, affine_in_u: true, f_u_depends_on: 0 }
            }
            Coordinates::Lagrangian => {
                Structure { constant_f_u: false, affine_in_u: true, f_u_depends_on: self.n }
            }
        }
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.run(VALUE, x, u, &[])?;
        Ok(&self.f)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.run(FIRST, x, u, &[])?;
        self.take_jacobians();
        Ok(self.first())
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        let n = self.n;
        LengthError::check("y", 2 * n, y.len())?;
        let y = if self.coordinates == Coordinates::Lagrangian { &y[n..] } else { y };
        self.run(SECOND, x, u, y)?;
        let start = self.take_jacobians();
        let (xx, ux) = self.outputs[start..].split_at(4 * n * n);
        take(&mut self.xx, xx);
        let lagrangian = self.coordinates == Coordinates::Lagrangian;
        if lagrangian {
            take(&mut self.ux, ux);
        }
        Ok(Contraction {
            first: self.first(),
            xx: self.xx.view(),
            ux: lagrangian.then(|| self.ux.view()),
            uu: None,
        })
    }
}
