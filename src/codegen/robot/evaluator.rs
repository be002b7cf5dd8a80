//! Every quantity of a robot for any scalar, with arguments and results as in its program.

use super::passed::{Arguments, Results};
use super::quantity::{Coordinates, Quantity, Variable};
use super::shape::Shape;
use crate::codegen::error::CodegenError;
use crate::codegen::record::Expr;
use crate::error::{EvalError, check_length};
use crate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use crate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use crate::matrix::add_scaled;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// A quantity of a robot by the generic code, with the arguments and results of its program.
///
/// [`robot_program`](super::robot_program) records it, and programs are compared with it. With
/// [`Count`](crate::scalar::Count) as S, operations are those of the algorithm that is recorded, where equal
/// ones are not merged.
///
/// ```
/// use costate::codegen::{Coordinates, Quantity, RobotQuantity};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut energy = RobotQuantity::<f64>::new(&robot, Quantity::Energy, Coordinates::Lagrangian)?;
/// let mut energies = [0.0; 2];
/// energy.evaluate(&[0.3, -0.8, 0.0, 0.0], &mut energies)?; // q, v in; kinetic, potential out
/// assert_eq!(energies[0], 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RobotQuantity<S: Scalar> {
    quantity: Quantity,
    variables: &'static [Variable],
    arguments: Vec<Shape>,
    results: Vec<Shape>,
    inputs: usize,
    outputs: usize,
    workspace: Workspace<S>,
    /// y'a_u, dx/dt and y'a_x for `y_f_x` in (q, v).
    products: Vec<S>,
}

#[derive(Clone, Debug)]
enum Workspace<S: Scalar> {
    Hamiltonian(Box<Hamiltonian<S>>),
    HamiltonianSecond(Box<HamiltonianSecondOrder<S>>),
    Lagrangian(Box<Lagrangian<S>>),
    LagrangianSecond(Box<LagrangianSecondOrder<S>>),
}

impl<S: Scalar> RobotQuantity<S> {
    /// The workspace of a quantity.
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates.
    pub fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Result<Self, CodegenError> {
        Self::from_tree(Tree::from(robot), quantity, coordinates)
    }

    /// The workspace of a quantity of an existing [`Tree`].
    ///
    /// # Errors
    /// [`CodegenError::Quantity`] where the quantity is not defined in these coordinates.
    pub fn from_tree(tree: Tree, quantity: Quantity, coordinates: Coordinates) -> Result<Self, CodegenError> {
        let (nq, n) = (tree.nq(), tree.dof());
        let variables = quantity.arguments(coordinates).ok_or_else(|| quantity.undefined(coordinates))?;
        let shape = |variable: &Variable| variable.shape(coordinates, [nq, n]);
        let arguments: Vec<Shape> = variables.iter().map(shape).collect();
        let (results, _) = quantity.results(coordinates, n);
        let second = matches!(quantity, Quantity::YFXX | Quantity::HessianProduct | Quantity::YTauZZ);
        let workspace = match (coordinates, second) {
            (Coordinates::Hamiltonian, false) => {
                Workspace::Hamiltonian(Box::new(Hamiltonian::from_tree(tree)))
            }
            (Coordinates::Hamiltonian, true) => {
                Workspace::HamiltonianSecond(Box::new(HamiltonianSecondOrder::from_tree(tree)))
            }
            // What is not checked counts or records: it takes the algorithms of the scalar that records.
            (Coordinates::Lagrangian, false) => Workspace::Lagrangian(Box::new(if S::CHECKED {
                Lagrangian::from_tree(tree)
            } else {
                Lagrangian::as_numbers::<Expr>(tree)
            })),
            (Coordinates::Lagrangian, true) => Workspace::LagrangianSecond(Box::new(if S::CHECKED {
                LagrangianSecondOrder::from_tree(tree)
            } else {
                LagrangianSecondOrder::as_numbers::<Expr>(tree)
            })),
        };
        let entries = |shapes: &[Shape]| shapes.iter().map(Shape::entries).sum();
        let (inputs, outputs) = (entries(&arguments), entries(&results));
        let products = vec![S::zero(); 5 * n];
        Ok(Self { quantity, variables, arguments, results, inputs, outputs, workspace, products })
    }

    /// The arguments, in order.
    pub fn arguments(&self) -> &[Shape] {
        &self.arguments
    }

    /// The results, in order.
    pub fn results(&self) -> &[Shape] {
        &self.results
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.inputs
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Evaluates the quantity: all arguments one after the other, all results likewise, each row by row.
    /// Allocates nothing.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`],
    /// [`EvalError::SingularMassMatrix`]. Outputs may be written before an error is found.
    pub fn evaluate(&mut self, inputs: &[S], outputs: &mut [S]) -> Result<(), EvalError> {
        check_length("inputs", inputs, self.inputs)?;
        check_length("outputs", outputs, self.outputs)?;
        let arguments = Arguments::split(self.variables, &self.arguments, inputs);
        let results = &mut Results { rest: outputs };
        match &mut self.workspace {
            Workspace::Hamiltonian(first) => hamiltonian(first, self.quantity, &arguments, results),
            Workspace::HamiltonianSecond(second) => {
                hamiltonian_second(second, self.quantity, &arguments, results)
            }
            Workspace::Lagrangian(first) if self.quantity == Quantity::YFX => {
                lagrangian_adjoint(first, &arguments, &mut self.products, results)
            }
            Workspace::Lagrangian(first) => lagrangian(first, self.quantity, &arguments, results),
            Workspace::LagrangianSecond(second) => {
                lagrangian_second(second, self.quantity, &arguments, results)
            }
        }
    }
}

/// The quantities of first order in (q, p).
fn hamiltonian<S: Scalar>(
    first: &mut Hamiltonian<S>,
    quantity: Quantity,
    &Arguments { q, rate: p, u, y, .. }: &Arguments<'_, S>,
    results: &mut Results<'_, S>,
) -> Result<(), EvalError> {
    match quantity {
        Quantity::F => results.push(first.evaluate(q, p, u)?),
        Quantity::FX => {
            let linear = first.linearise(q, p, u)?;
            results.push(linear.f()).push_rows(linear.matrix())
        }
        Quantity::YFX => {
            let product = first.adjoint(q, p, u, y)?;
            results.push(product.f).push(product.y_f_x)
        }
        Quantity::Energy => {
            let energy = first.energy(q, p)?;
            results.push(&[energy.kinetic, energy.potential])
        }
        Quantity::MassMatrix => results.push_rows(first.mass_matrix(q)?.view()),
        Quantity::YFXX
        | Quantity::HessianProduct
        | Quantity::InverseDynamics
        | Quantity::TauZ
        | Quantity::YTauZZ => results,
    };
    Ok(())
}

/// y'F_xx with F and F_x, and y'F_xx d.
fn hamiltonian_second<S: Scalar>(
    second: &mut HamiltonianSecondOrder<S>,
    quantity: Quantity,
    &Arguments { q, rate: p, u, y, d, .. }: &Arguments<'_, S>,
    results: &mut Results<'_, S>,
) -> Result<(), EvalError> {
    if quantity == Quantity::HessianProduct {
        results.push(second.hessian_product(q, p, y, d)?);
        return Ok(());
    }
    let all = second.contract(q, p, u, y)?;
    let linear = all.linearisation();
    results.push(linear.f()).push_rows(linear.matrix()).push_rows(all.matrix());
    Ok(())
}

/// The quantities of first order in (q, v).
fn lagrangian<S: Scalar>(
    first: &mut Lagrangian<S>,
    quantity: Quantity,
    &Arguments { q, rate: v, u, a, .. }: &Arguments<'_, S>,
    results: &mut Results<'_, S>,
) -> Result<(), EvalError> {
    match quantity {
        Quantity::F => results.push(first.forward_dynamics(q, v, u)?),
        Quantity::FX => {
            let linear = first.linearise_forward_dynamics(q, v, u)?;
            results.push(linear.acceleration()).push_rows(linear.matrix())
        }
        Quantity::Energy => {
            let energy = first.energy(q, v)?;
            results.push(&[energy.kinetic, energy.potential])
        }
        Quantity::InverseDynamics => results.push(first.inverse_dynamics(q, v, a)?),
        Quantity::TauZ => results.push_torques(first.linearise_inverse_dynamics(q, v, a)?),
        Quantity::MassMatrix => results.push_rows(first.mass_matrix(q)?.view()),
        Quantity::YFX | Quantity::YFXX | Quantity::HessianProduct | Quantity::YTauZZ => results,
    };
    Ok(())
}

/// y'a_z, z = (q, v, u), with a.
fn lagrangian_adjoint<S: Scalar>(
    first: &mut Lagrangian<S>,
    &Arguments { q, rate: v, u, y, .. }: &Arguments<'_, S>,
    products: &mut [S],
    results: &mut Results<'_, S>,
) -> Result<(), EvalError> {
    let n = v.len();
    if !first.tree().free().is_empty() {
        let linear = first.linearise_forward_dynamics(q, v, u)?;
        let y_a_z = &mut products[..3 * n];
        y_a_z.fill(S::zero());
        y.iter().zip(linear.matrix().iter_rows()).for_each(|(&y, row)| add_scaled(y_a_z, y, row));
        results.push(linear.acceleration()).push(y_a_z);
        return Ok(());
    }
    let (w, rest) = products.split_at_mut(n);
    let (f, y_a_x) = rest.split_at_mut(2 * n);
    w.copy_from_slice(y);
    first.solve_mass_matrix(q, w)?;
    first.adjoint_factored([q, v, u, w], f, y_a_x)?;
    results.push(&f[n..]).push(y_a_x).push(w);
    Ok(())
}

/// The contracted Hessian of the accelerations or of the actuation, with these and their Jacobian.
fn lagrangian_second<S: Scalar>(
    second: &mut LagrangianSecondOrder<S>,
    quantity: Quantity,
    &Arguments { q, rate: v, u, a, y, .. }: &Arguments<'_, S>,
    results: &mut Results<'_, S>,
) -> Result<(), EvalError> {
    if quantity == Quantity::YTauZZ {
        let all = second.contract_inverse_dynamics(q, v, a, y)?;
        results.push_torques(all.inverse_dynamics()).push_rows(all.xx()).push_rows(all.aq());
        return Ok(());
    }
    let all = second.contract_forward_dynamics(q, v, u, y)?;
    let linear = all.forward_dynamics();
    results.push(linear.acceleration()).push_rows(linear.matrix());
    results.push_rows(all.xx()).push_rows(all.uq());
    Ok(())
}
