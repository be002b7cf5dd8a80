//! Every quantity by the generic code, with arguments and results as in its program.

use costate::EvalError;
use costate::codegen::{Coordinates, Quantity};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;

/// An argument or a result: `rows` times `columns` numbers, row by row; vectors have one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Its name, as in the table of [`Quantity`].
    pub name: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

impl Shape {
    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.rows * self.columns
    }
}

/// Fills the results from the arguments, both one after the other, each of the length that its shapes say.
type Work = dyn FnMut(&[f64], &mut Results<'_>) -> Result<(), EvalError> + Send + Sync;

/// One quantity of one robot with its workspace.
pub(crate) struct Generic {
    arguments: Vec<Shape>,
    results: Vec<Shape>,
    work: Box<Work>,
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
    /// The quantity; `None` where there is no such one in these coordinates.
    pub fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Option<Self> {
        let generic = match coordinates {
            Coordinates::Hamiltonian => in_q_p(robot, quantity)?,
            Coordinates::Lagrangian => in_q_v(robot, quantity)?,
        };
        Some(generic)
    }

    /// From its arguments, all vectors, its results, and what is done with both.
    fn of<const A: usize, const R: usize>(
        arguments: [(&'static str, usize); A],
        results: [(&'static str, usize, usize); R],
        mut evaluate: impl FnMut([&[f64]; A], &mut Results<'_>) -> Result<(), EvalError> + Send + Sync + 'static,
    ) -> Self {
        let split = move |inputs: &[f64], results: &mut Results<'_>| {
            let mut rest = inputs;
            let parts = arguments.map(|(_, entries)| {
                let (part, more) = rest.split_at(entries);
                rest = more;
                part
            });
            evaluate(parts, results)
        };
        Self {
            arguments: arguments.map(|(name, rows)| Shape { name, rows, columns: 1 }).to_vec(),
            results: results.map(|(name, rows, columns)| Shape { name, rows, columns }).to_vec(),
            work: Box::new(split),
        }
    }

    /// The arguments, in order.
    pub fn arguments(&self) -> &[Shape] {
        &self.arguments
    }

    /// The results, in order.
    pub fn results(&self) -> &[Shape] {
        &self.results
    }

    /// Evaluates the quantity; both lengths are those that the shapes say.
    pub fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), EvalError> {
        (self.work)(inputs, &mut Results { rest: outputs })
    }
}

fn in_q_p(robot: &Robot, quantity: Quantity) -> Option<Generic> {
    let (n, n2) = (robot.len(), 2 * robot.len());
    let (q, p, u, y, d) = (("q", n), ("p", n), ("u", n), ("y", n2), ("d", n2));
    let (f, f_x) = (("f", n2, 1), ("f_x", n2, n2));
    let mut first = Hamiltonian::<f64>::new(robot);
    let second = || HamiltonianSecondOrder::<f64>::new(robot);
    Some(match quantity {
        Quantity::F => Generic::of([q, p, u], [f], move |[q, p, u], results| {
            results.push(first.evaluate(q, p, u)?);
            Ok(())
        }),
        Quantity::FX => Generic::of([q, p, u], [f, f_x], move |[q, p, u], results| {
            let linear = first.linearise(q, p, u)?;
            results.push(linear.f());
            results.push_rows(linear.matrix());
            Ok(())
        }),
        Quantity::YFX => Generic::of([q, p, u, y], [f, ("y_f_x", n2, 1)], move |[q, p, u, y], results| {
            let product = first.adjoint(q, p, u, y)?;
            results.push(product.f);
            results.push(product.y_f_x);
            Ok(())
        }),
        Quantity::YFXX => {
            let mut second = second();
            Generic::of([q, p, u, y], [f, f_x, ("y_f_xx", n2, n2)], move |[q, p, u, y], results| {
                let all = second.contract(q, p, u, y)?;
                results.push(all.linearisation().f());
                results.push_rows(all.linearisation().matrix());
                results.push_rows(all.matrix());
                Ok(())
            })
        }
        Quantity::YFXXD => {
            let mut second = second();
            Generic::of([q, p, y, d], [("y_f_xx_d", n2, 1)], move |[q, p, y, d], results| {
                results.push(second.hessian_product(q, p, y, d)?);
                Ok(())
            })
        }
        Quantity::Energy => Generic::of([q, p], ENERGIES, move |[q, p], results| {
            let energy = first.energy(q, p)?;
            results.push(&[energy.kinetic, energy.potential]);
            Ok(())
        }),
        Quantity::MassMatrix => mass_matrix(robot),
        Quantity::InverseDynamics => return None,
    })
}

fn in_q_v(robot: &Robot, quantity: Quantity) -> Option<Generic> {
    let (n, n2) = (robot.len(), 2 * robot.len());
    let (q, v, u, a, y) = (("q", n), ("v", n), ("u", n), ("a", n), ("y", n));
    let (qdd, qdd_z) = (("qdd", n, 1), ("qdd_z", n, 3 * n));
    let mut first = Lagrangian::<f64>::new(robot);
    Some(match quantity {
        Quantity::F => Generic::of([q, v, u], [qdd], move |[q, v, u], results| {
            results.push(first.forward_dynamics(q, v, u)?);
            Ok(())
        }),
        Quantity::FX => Generic::of([q, v, u], [qdd, qdd_z], move |[q, v, u], results| {
            let linear = first.linearise_forward_dynamics(q, v, u)?;
            results.push(linear.acceleration());
            results.push_rows(linear.matrix());
            Ok(())
        }),
        Quantity::YFXX => {
            let mut second = LagrangianSecondOrder::<f64>::new(robot);
            let blocks = [qdd, qdd_z, ("y_qdd_xx", n2, n2), ("y_qdd_uq", n, n)];
            Generic::of([q, v, u, y], blocks, move |[q, v, u, y], results| {
                let all = second.contract_forward_dynamics(q, v, u, y)?;
                results.push(all.forward_dynamics().acceleration());
                for block in [all.forward_dynamics().matrix(), all.xx(), all.uq()] {
                    results.push_rows(block);
                }
                Ok(())
            })
        }
        Quantity::Energy => Generic::of([q, v], ENERGIES, move |[q, v], results| {
            let energy = first.energy(q, v)?;
            results.push(&[energy.kinetic, energy.potential]);
            Ok(())
        }),
        Quantity::InverseDynamics => Generic::of([q, v, a], [("tau", n, 1)], move |[q, v, a], results| {
            results.push(first.inverse_dynamics(q, v, a)?);
            Ok(())
        }),
        Quantity::MassMatrix => mass_matrix(robot),
        Quantity::YFX | Quantity::YFXXD => return None,
    })
}

/// The results of [`Quantity::Energy`].
const ENERGIES: [(&str, usize, usize); 2] = [("kinetic", 1, 1), ("potential", 1, 1)];

/// M, the same in both coordinates.
fn mass_matrix(robot: &Robot) -> Generic {
    let (n, mut hamiltonian) = (robot.len(), Hamiltonian::<f64>::new(robot));
    Generic::of([("q", n)], [("m", n, n)], move |[q], results| {
        results.push(hamiltonian.mass_matrix(q)?.as_slice());
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::{Generic, Shape};
    use costate::codegen::{Coordinates, Options, Quantity, robot_program};
    use costate::robot::Robot;

    /// Names, sizes and order are those of the programs, and there is a quantity where there is a program.
    #[test]
    fn arguments_and_results_are_those_of_programs() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/ur5.urdf");
        let robot = Robot::from_file(file).unwrap();
        for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
            for quantity in Quantity::ALL {
                let generic = Generic::new(&robot, quantity, coordinates);
                let program = robot_program(&robot, quantity, coordinates, &Options::default());
                let (Some(generic), Ok(program)) = (&generic, &program) else {
                    assert!(generic.is_none() && program.is_err(), "{}", quantity.name());
                    continue;
                };
                let same = |shape: &Shape, name: &str, rows: usize, columns: usize| {
                    assert_eq!((shape.name, shape.rows, shape.columns), (name, rows, columns));
                };
                assert_eq!(generic.arguments().len(), program.arguments().len());
                for (shape, argument) in generic.arguments().iter().zip(program.arguments()) {
                    same(shape, &argument.name, argument.entries, 1);
                }
                assert_eq!(generic.results().len(), program.results().len());
                for (shape, result) in generic.results().iter().zip(program.results()) {
                    same(shape, &result.name, result.rows, result.columns);
                }
            }
        }
    }
}
