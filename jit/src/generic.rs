//! Every quantity by the generic code, with arguments and results as in its program.

use costate::EvalError;
use costate::codegen::{Coordinates, Quantity};
use costate::hamiltonian;
use costate::lagrangian;
use costate::matrix::Block;
use costate::robot::Robot;

/// The workspace of one quantity of one robot.
#[derive(Clone, Debug)]
pub(crate) struct Generic {
    quantity: Quantity,
    workspace: Workspace,
}

#[derive(Clone, Debug)]
enum Workspace {
    Hamiltonian(Box<hamiltonian::SecondOrder<f64>>),
    Lagrangian(Box<lagrangian::SecondOrder<f64>>),
}

/// Results, written one after the other.
struct Results<'a> {
    rest: &'a mut [f64],
}

impl Results<'_> {
    /// Appends numbers; there is room for them, since lengths are compared before anything is computed.
    fn push(&mut self, values: &[f64]) {
        let (here, rest) = std::mem::take(&mut self.rest).split_at_mut(values.len());
        here.copy_from_slice(values);
        self.rest = rest;
    }

    fn push_rows(&mut self, block: Block<'_, f64>) {
        block.iter_rows().for_each(|row| self.push(row));
    }
}

impl Generic {
    pub fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Self {
        let workspace = match coordinates {
            Coordinates::Hamiltonian => {
                Workspace::Hamiltonian(Box::new(hamiltonian::SecondOrder::new(robot)))
            }
            Coordinates::Lagrangian => Workspace::Lagrangian(Box::new(lagrangian::SecondOrder::new(robot))),
        };
        Self { quantity, workspace }
    }

    /// Evaluates the quantity; both lengths are those of its program.
    pub fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), EvalError> {
        let mut results = Results { rest: outputs };
        match &mut self.workspace {
            Workspace::Hamiltonian(second) => in_q_p(second, self.quantity, inputs, &mut results),
            Workspace::Lagrangian(second) => in_q_v(second, self.quantity, inputs, &mut results),
        }
    }
}

fn in_q_p(
    second: &mut hamiltonian::SecondOrder<f64>,
    quantity: Quantity,
    inputs: &[f64],
    results: &mut Results<'_>,
) -> Result<(), EvalError> {
    let n = second.len();
    let (q, rest) = inputs.split_at(n);
    match quantity {
        Quantity::MassMatrix => results.push(second.first().mass_matrix(q)?.as_slice()),
        Quantity::Energy => {
            let energy = second.first().energy(q, rest)?;
            results.push(&[energy.kinetic, energy.potential]);
        }
        Quantity::YFXXD => {
            let (p, rest) = rest.split_at(n);
            let (y, d) = rest.split_at(2 * n);
            results.push(second.hessian_product(q, p, y, d)?);
        }
        Quantity::F | Quantity::InverseDynamics => {
            let (p, u) = rest.split_at(n);
            results.push(second.first().phase_velocity(q, p, u)?);
        }
        Quantity::FX => {
            let (p, u) = rest.split_at(n);
            let linear = second.first().jacobian(q, p, u)?;
            results.push(linear.f());
            results.push_rows(linear.matrix());
        }
        Quantity::YFX => {
            let (p, rest) = rest.split_at(n);
            let (u, y) = rest.split_at(n);
            let product = second.first().adjoint(q, p, u, y)?;
            results.push(product.f);
            results.push(product.y_f_x);
        }
        Quantity::YFXX => {
            let (p, rest) = rest.split_at(n);
            let (u, y) = rest.split_at(n);
            let all = second.contracted_hessian(q, p, u, y)?;
            results.push(all.linearisation().f());
            results.push_rows(all.linearisation().matrix());
            results.push_rows(all.matrix());
        }
    }
    Ok(())
}

fn in_q_v(
    second: &mut lagrangian::SecondOrder<f64>,
    quantity: Quantity,
    inputs: &[f64],
    results: &mut Results<'_>,
) -> Result<(), EvalError> {
    let n = second.len();
    let (q, rest) = inputs.split_at(n);
    match quantity {
        Quantity::MassMatrix => results.push(second.first().mass_matrix(q)?.as_slice()),
        Quantity::Energy => {
            let energy = second.first().energy(q, rest)?;
            results.push(&[energy.kinetic, energy.potential]);
        }
        Quantity::InverseDynamics => {
            let (v, a) = rest.split_at(n);
            results.push(second.first().inverse_dynamics(q, v, a)?);
        }
        Quantity::F => {
            let (v, u) = rest.split_at(n);
            results.push(second.first().forward_dynamics(q, v, u)?);
        }
        Quantity::FX => {
            let (v, u) = rest.split_at(n);
            let linear = second.first().forward_dynamics_jacobian(q, v, u)?;
            results.push(linear.acceleration());
            results.push_rows(linear.matrix());
        }
        Quantity::YFXX | Quantity::YFX | Quantity::YFXXD => {
            let (v, rest) = rest.split_at(n);
            let (u, y) = rest.split_at(n);
            let all = second.contracted_hessian(q, v, u, y)?;
            results.push(all.linearisation().acceleration());
            results.push_rows(all.linearisation().matrix());
            results.push_rows(all.xx());
            results.push_rows(all.uq());
        }
    }
    Ok(())
}
