//! Reference files: one state a line, see `tests/fixtures/README.md`.

use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian, PhaseVelocity, largest};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;
use serde_json::Value;
use std::path::Path;

/// One state and what an independent computation says of it.
pub struct Reference {
    pub line: Value,
}

impl Reference {
    pub fn read(path: &Path) -> Vec<Self> {
        let text = std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        text.lines().map(|line| Self { line: serde_json::from_str(line).unwrap() }).collect()
    }

    /// All numbers under a key, row by row.
    pub fn numbers(&self, key: &str) -> Vec<f64> {
        fn flatten(value: &Value, numbers: &mut Vec<f64>) {
            match value {
                Value::Array(values) => values.iter().for_each(|value| flatten(value, numbers)),
                value => numbers.push(value.as_f64().unwrap()),
            }
        }
        let mut numbers = Vec::new();
        flatten(&self.line[key], &mut numbers);
        numbers
    }

    /// `max |a - b| / max |b| <= 1e-10` for the array under `key`.
    pub fn agrees(&self, key: &str, found: &[f64], context: &str) {
        let expected = self.numbers(key);
        assert_eq!(found.len(), expected.len(), "{context}: length of {key}");
        let size = largest(&expected);
        let differences: Vec<f64> = found.iter().zip(&expected).map(|(a, b)| a - b).collect();
        let worst = largest(&differences);
        assert!(worst <= 1e-10 * size, "{context}: {key} is off by {:.2e}", worst / size);
    }
}

pub fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// Every route to every quantity against the references of one robot, in both coordinates.
pub fn check_robot(robot: &Robot, references: &[Reference]) {
    check_hamiltonian(robot, references);
    check_lagrangian(robot, references);
}

/// Every route to every quantity in (q, v).
fn check_lagrangian(robot: &Robot, references: &[Reference]) {
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let mut second = LagrangianSecondOrder::<f64>::new(robot);
    let mut dual: Jacobian<_> = Jacobian::new(ForwardDynamics::new(robot));
    let mut nested = NestedHessian::new(ForwardDynamics::new(robot));
    let mut hyperdual = Hessian::new(ForwardDynamics::new(robot));
    for (number, reference) in references.iter().enumerate() {
        let context = format!("{} state {}", robot.name(), number + 1);
        let [q, v, u, y] = ["q", "v", "u", "y"].map(|key| reference.numbers(key));
        let y_v = &y[q.len()..];
        let energy = lagrangian.energy(&q, &v).unwrap();
        reference.agrees("energy", &[energy.kinetic, energy.potential], &context);
        let a = lagrangian.forward_dynamics(&q, &v, &u).unwrap().to_vec();
        reference.agrees("qdd", &a, &context);
        reference.agrees("u", lagrangian.inverse_dynamics(&q, &v, &a).unwrap(), &context);
        let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
        reference.agrees("M", linear.mass_matrix().as_slice(), &context);
        reference.agrees("qdd_z", &flat(linear.matrix()), &context);
        let contracted = second.contract_forward_dynamics(&q, &v, &u, y_v).unwrap();
        reference.agrees("M", contracted.forward_dynamics().mass_matrix().as_slice(), &context);
        reference.agrees("qdd", contracted.forward_dynamics().acceleration(), &context);
        reference.agrees("qdd_z", &flat(contracted.forward_dynamics().matrix()), &context);
        reference.agrees("yv_qdd_zz", contracted.to_matrix().as_slice(), &context);
        let z = [q.as_slice(), &v, &u].concat();
        reference.agrees("qdd_z", dual.linearise(&z).unwrap().jacobian.as_slice(), &context);
        reference.agrees("yv_qdd_zz", nested.contract(&z, y_v).unwrap().as_slice(), &context);
        reference.agrees("yv_qdd_zz", hyperdual.contract(&z, y_v).unwrap().as_slice(), &context);
        reference.agrees("qdd_z", hyperdual.last().jacobian().as_slice(), &context);
    }
}

/// Every route to every quantity in (q, p).
fn check_hamiltonian(robot: &Robot, references: &[Reference]) {
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    for (number, reference) in references.iter().enumerate() {
        let context = format!("{} state {}", robot.name(), number + 1);
        let [q, v, p, u, y] = ["q", "v", "p", "u", "y"].map(|key| reference.numbers(key));
        reference.agrees("p", hamiltonian.momentum(&q, &v).unwrap(), &context);
        reference.agrees("v", hamiltonian.velocity(&q, &p).unwrap(), &context);
        let energy = hamiltonian.energy(&q, &p).unwrap();
        reference.agrees("energy", &[energy.kinetic, energy.potential], &context);
        reference.agrees("f", hamiltonian.evaluate(&q, &p, &u).unwrap(), &context);
        let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
        reference.agrees("f_x", &flat(linear.matrix()), &context);
        reference.agrees("M", linear.mass_matrix().as_slice(), &context);
        let contracted = second.contract(&q, &p, &u, &y).unwrap();
        reference.agrees("f", contracted.linearisation().f(), &context);
        reference.agrees("f_x", &flat(contracted.linearisation().matrix()), &context);
        reference.agrees("y_f_xx", &flat(contracted.matrix()), &context);
        let x = [q, p].concat();
        let function = || PhaseVelocity::new(robot).under(&u);
        let mut dual: Jacobian<_> = Jacobian::new(function());
        reference.agrees("f_x", dual.linearise(&x).unwrap().jacobian.as_slice(), &context);
        let mut nested = NestedHessian::new(function());
        reference.agrees("y_f_xx", nested.contract(&x, &y).unwrap().as_slice(), &context);
        let mut hyperdual = Hessian::new(function());
        reference.agrees("y_f_xx", hyperdual.contract(&x, &y).unwrap().as_slice(), &context);
        reference.agrees("f_x", hyperdual.last().jacobian().as_slice(), &context);
        reference.agrees("f", hyperdual.last().value(), &context);
    }
}
