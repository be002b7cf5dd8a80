//! Derivatives by machine code: each order is compiled when the first line needs it.

use super::line::Answer;
use crate::terminal;
use costate::codegen::{CodegenError, Coordinates, Quantity};
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate_jit::{Backend, JitQuantity};

/// Machine code of f and f_x (or qdd and qdd_z), and of these with the contracted second derivatives.
pub struct Machine {
    robot: Robot,
    coordinates: Coordinates,
    first: Option<Compiled>,
    second: Option<Compiled>,
}

/// Results by name.
pub type Results = Vec<(&'static str, Matrix<f64>)>;

struct Compiled {
    evaluator: JitQuantity,
    results: Vec<f64>,
}

impl Compiled {
    /// Compiles the quantity. If that is impossible, a note on standard error gives the reason.
    fn new(robot: &Robot, quantity: Quantity, coordinates: Coordinates) -> Result<Self, CodegenError> {
        let evaluator = JitQuantity::new(robot, quantity, coordinates)?;
        if let Backend::Generic { .. } = evaluator.backend() {
            terminal::note(format!("{} by the {}", quantity.name(), evaluator.backend()));
        }
        Ok(Self { results: vec![0.0; evaluator.outputs()], evaluator })
    }
}

impl Machine {
    pub fn new(robot: &Robot, coordinates: Coordinates) -> Self {
        Self { robot: robot.clone(), coordinates, first: None, second: None }
    }

    /// All results by name, from the state, the actuation and, for the second order, y.
    pub fn evaluate(
        &mut self,
        state: [&[f64]; 3],
        y: Option<&[f64]>,
    ) -> Result<Results, Box<dyn std::error::Error>> {
        let (order, quantity) = match y {
            None => (&mut self.first, Quantity::FX),
            Some(_) => (&mut self.second, Quantity::YFXX),
        };
        let compiled = match order {
            Some(compiled) => compiled,
            None => order.insert(Compiled::new(&self.robot, quantity, self.coordinates)?),
        };
        let inputs = [&state.concat(), y.unwrap_or_default()].concat();
        let Compiled { evaluator, results } = compiled;
        evaluator.evaluate(&inputs, results)?;
        let mut rest = results.as_slice();
        let named = evaluator.results().iter().map(|shape| {
            let (entries, more) = rest.split_at(shape.entries());
            rest = more;
            (shape.name, Matrix::from_rows(shape.columns, entries))
        });
        Ok(named.collect())
    }
}

impl Answer {
    /// Adds a result under its name; one of a single column as a vector.
    pub fn result(&mut self, name: &str, entries: &Matrix<f64>) {
        match entries.columns() {
            1 => self.vector(name, entries.as_slice()),
            _ => self.matrix(name, entries.view()),
        }
    }
}
