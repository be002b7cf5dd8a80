//! A robot as a model by machine code.

use crate::quantity::{Backend, JitQuantity};
use costate::codegen::{CodegenError, Coordinates, Quantity};
use costate::dynamics::{Contraction, Dynamics, Linearisation, Structure};
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::step::VelocityForm;
use costate::{EvalError, LengthError};

/// [`Dynamics`] of a robot in either coordinates, x = (q, p) or (q, v): f, its Jacobians and contracted
/// Hessians by machine code, or by the generic code where there is none.
///
/// For optimisers and for [time steps](costate::step), as [`JitQuantity`] is for single quantities; a clone
/// is a workspace for another thread.
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
pub struct JitModel {
    coordinates: Coordinates,
    n: usize,
    quantities: [JitQuantity; 3],
    inputs: Vec<f64>,
    outputs: Vec<f64>,
    f: Vec<f64>,
    f_x: Matrix<f64>,
    f_u: Matrix<f64>,
    xx: Matrix<f64>,
    ux: Matrix<f64>,
}

/// Positions in [`JitModel::quantities`].
const VALUE: usize = 0;
const FIRST: usize = 1;
const SECOND: usize = 2;

impl JitModel {
    /// Records and compiles f, f_x and y'f_xx.
    ///
    /// # Errors
    /// [`CodegenError`]; all three are defined in both coordinates.
    pub fn new(robot: &Robot, coordinates: Coordinates) -> Result<Self, CodegenError> {
        let n = robot.dof();
        let of = |quantity| JitQuantity::new(robot, quantity, coordinates);
        let quantities = [of(Quantity::F)?, of(Quantity::FX)?, of(Quantity::YFXX)?];
        let (mut f_x, mut f_u) = (Matrix::zeros(2 * n, 2 * n), Matrix::zeros(2 * n, n));
        for i in 0..n {
            match coordinates {
                Coordinates::Hamiltonian => f_u[(n + i, i)] = 1.0,
                Coordinates::Lagrangian => f_x[(i, n + i)] = 1.0,
            }
        }
        Ok(Self {
            coordinates,
            n,
            inputs: vec![0.0; quantities[SECOND].inputs()],
            outputs: vec![0.0; quantities[SECOND].outputs()],
            quantities,
            f: vec![0.0; 2 * n],
            f_x,
            f_u,
            xx: Matrix::zeros(2 * n, 2 * n),
            ux: Matrix::zeros(n, n),
        })
    }

    /// How f, its Jacobians and its contracted Hessian are computed.
    pub fn backends(&self) -> [Backend<'_>; 3] {
        self.quantities.each_ref().map(JitQuantity::backend)
    }

    /// Evaluates one of the quantities and takes f.
    fn run(&mut self, which: usize, x: &[f64], u: &[f64], y: &[f64]) -> Result<(), EvalError> {
        let n = self.n;
        for (what, expected, found) in [("x", 2 * n, x.len()), ("u", n, u.len())] {
            LengthError::check(what, expected, found)?;
        }
        self.inputs[..2 * n].copy_from_slice(x);
        self.inputs[2 * n..3 * n].copy_from_slice(u);
        self.inputs[3 * n..3 * n + y.len()].copy_from_slice(y);
        let quantity = &mut self.quantities[which];
        let outputs = &mut self.outputs[..quantity.outputs()];
        quantity.evaluate(&self.inputs[..3 * n + y.len()], outputs)?;
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

    fn first(&self) -> Linearisation<'_, f64> {
        Linearisation { f: &self.f, f_x: self.f_x.view(), f_u: self.f_u.view() }
    }
}

/// All entries, row by row.
fn take(matrix: &mut Matrix<f64>, entries: &[f64]) {
    let columns = matrix.columns();
    for (i, row) in entries.chunks_exact(columns.max(1)).enumerate() {
        matrix.row_mut(i).copy_from_slice(row);
    }
}

impl Dynamics<f64> for JitModel {
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

    fn evaluate(&mut self, x: &[f64], u: &[f64]) -> Result<&[f64], EvalError> {
        self.run(VALUE, x, u, &[])?;
        Ok(&self.f)
    }

    fn linearise(&mut self, x: &[f64], u: &[f64]) -> Result<Linearisation<'_, f64>, EvalError> {
        self.run(FIRST, x, u, &[])?;
        self.take_jacobians();
        Ok(self.first())
    }

    fn contract(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<Contraction<'_, f64>, EvalError> {
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

/// A [`JitModel`] in (q, v), with f = (v, a), for [steps](costate::step) that need this form.
///
/// ```
/// use costate::robot::Robot;
/// use costate::step::{SemiImplicitEuler, Step};
/// use costate_jit::JitVelocityModel;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut step = SemiImplicitEuler::new(JitVelocityModel::new(&robot)?);
/// let next = step.evaluate(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.0], 0.01)?;
/// assert_eq!(next[0], 0.3 + 0.01 * next[2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A model in (q, p) does not have it:
///
/// ```compile_fail,E0277
/// # use costate::{codegen::Coordinates, robot::Robot, step::SemiImplicitEuler};
/// # let robot = Robot::from_file("robots/two_link.toml").unwrap();
/// let model = costate_jit::JitModel::new(&robot, Coordinates::Hamiltonian).unwrap();
/// SemiImplicitEuler::new(model);
/// ```
#[derive(Clone, Debug)]
pub struct JitVelocityModel(JitModel);

impl JitVelocityModel {
    /// Records and compiles f, f_x and y'f_xx in (q, v).
    ///
    /// # Errors
    /// As [`JitModel::new`].
    pub fn new(robot: &Robot) -> Result<Self, CodegenError> {
        JitModel::new(robot, Coordinates::Lagrangian).map(Self)
    }
}

impl VelocityForm<f64> for JitVelocityModel {}

impl Dynamics<f64> for JitVelocityModel {
    type Error = EvalError;

    fn states(&self) -> usize {
        self.0.states()
    }

    fn controls(&self) -> usize {
        self.0.controls()
    }

    fn structure(&self) -> Structure {
        self.0.structure()
    }

    fn evaluate(&mut self, x: &[f64], u: &[f64]) -> Result<&[f64], EvalError> {
        self.0.evaluate(x, u)
    }

    fn linearise(&mut self, x: &[f64], u: &[f64]) -> Result<Linearisation<'_, f64>, EvalError> {
        self.0.linearise(x, u)
    }

    fn contract(&mut self, x: &[f64], u: &[f64], y: &[f64]) -> Result<Contraction<'_, f64>, EvalError> {
        self.0.contract(x, u, y)
    }
}
