//! What the generic code gives for the arguments of a program, to judge generated code by.

use costate::codegen::{Coordinates, Program, Quantity};
use costate::derivative::largest;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;

/// A state, a costate and directions.
#[derive(Clone, Debug)]
pub struct State {
    pub q: Vec<f64>,
    /// p or v.
    pub second: Vec<f64>,
    /// u or a.
    pub u: Vec<f64>,
    /// 2n.
    pub y: Vec<f64>,
    /// 2n.
    pub d: Vec<f64>,
}

impl State {
    /// All arguments of a program but parameters, one after the other.
    pub fn inputs(&self, program: &Program) -> Vec<f64> {
        let of = |name: &str, entries: usize| {
            match name {
                "q" => &self.q,
                "p" | "v" => &self.second,
                "u" | "a" => &self.u,
                "y" if entries == self.u.len() => return self.y[entries..].to_vec(),
                "y" => &self.y,
                "d" => &self.d,
                _ => panic!("no argument {name}"),
            }
            .to_vec()
        };
        let arguments = program.arguments().iter().filter(|argument| argument.name != "parameters");
        arguments.flat_map(|argument| of(&argument.name, argument.entries)).collect()
    }
}

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

/// A result by the generic code, and the size of the terms it is made of, which rounding is in proportion to.
pub type Expected = (&'static str, Vec<f64>, f64);

/// All results of a quantity by the generic code.
pub fn expected(robot: &Robot, quantity: Quantity, coordinates: Coordinates, state: &State) -> Vec<Expected> {
    let State { q, second, u, y, d } = state;
    match coordinates {
        Coordinates::Hamiltonian => in_q_p(robot, quantity, q, second, u, y, d),
        Coordinates::Lagrangian => in_q_v(robot, quantity, q, second, u, &y[u.len()..]),
    }
}

fn in_q_p(
    robot: &Robot,
    quantity: Quantity,
    q: &[f64],
    p: &[f64],
    u: &[f64],
    y: &[f64],
    d: &[f64],
) -> Vec<Expected> {
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    let product = second.hessian_product(q, p, y, d).unwrap().to_vec();
    let y_f_x = second.first().adjoint(q, p, u, y).unwrap().y_f_x.to_vec();
    let energy = second.first().energy(q, p).unwrap();
    let m = second.first().mass_matrix(q).unwrap().as_slice().to_vec();
    let all = second.contract(q, p, u, y).unwrap();
    let (f, f_x) = (all.linearisation().f().to_vec(), flat(all.linearisation().matrix()));
    let y_f_xx = flat(all.matrix());
    let size = largest(&f_x).max(1.0);
    let (with_y, with_d) = (size * largest(y), size * largest(y) * largest(d));
    match quantity {
        Quantity::F => vec![("f", f, size)],
        Quantity::FX => vec![("f", f, size), ("f_x", f_x, size)],
        Quantity::YFX => vec![("f", f, size), ("y_f_x", y_f_x, with_y)],
        Quantity::YFXX => vec![("f", f, size), ("f_x", f_x, size), ("y_f_xx", y_f_xx, with_y)],
        Quantity::HessianProduct => vec![("y_f_xx_d", product, largest(&y_f_xx).max(with_d))],
        Quantity::MassMatrix => vec![("m", m, 0.0)],
        Quantity::Energy => {
            vec![("kinetic", vec![energy.kinetic], 0.0), ("potential", vec![energy.potential], size)]
        }
        _ => panic!("not in (q, p), or not known here"),
    }
}

fn in_q_v(robot: &Robot, quantity: Quantity, q: &[f64], v: &[f64], u: &[f64], y: &[f64]) -> Vec<Expected> {
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let mut second = LagrangianSecondOrder::<f64>::new(robot);
    let all = second.contract_forward_dynamics(q, v, u, y).unwrap();
    let (qdd, qdd_z) =
        (all.forward_dynamics().acceleration().to_vec(), flat(all.forward_dynamics().matrix()));
    let (xx, uq) = (flat(all.xx()), flat(all.uq()));
    let energy = lagrangian.energy(q, v).unwrap();
    let m = lagrangian.mass_matrix(q).unwrap().as_slice().to_vec();
    let tau = lagrangian.linearise_inverse_dynamics(q, v, u).unwrap();
    let tau_size = largest(tau.tau_q.as_slice()).max(largest(tau.tau_v.as_slice())).max(1.0);
    let n = v.len();
    let tau_z: Vec<f64> = (0..n)
        .flat_map(|i| [tau.tau_q, tau.tau_v, tau.tau_a].map(|block| block.row(i).to_vec()).concat())
        .collect();
    let tau = tau.tau.to_vec();
    let bent = second.contract_inverse_dynamics(q, v, u, y).unwrap();
    let (tau_xx, tau_aq) = (flat(bent.xx()), flat(bent.aq()));
    let tau_y = tau_size * largest(y);
    let size = largest(&qdd_z).max(largest(&qdd)).max(1.0);
    let with_y = size * largest(y);
    match quantity {
        Quantity::F => vec![("qdd", qdd, size)],
        Quantity::FX => vec![("qdd", qdd, size), ("qdd_z", qdd_z, size)],
        Quantity::YFX => {
            let column = |j: usize| (0..n).map(|i| y[i] * qdd_z[i * 3 * n + j]).sum();
            vec![("qdd", qdd, size), ("y_qdd_z", (0..3 * n).map(column).collect(), with_y)]
        }
        Quantity::YFXX => vec![
            ("qdd", qdd, size),
            ("qdd_z", qdd_z, size),
            ("y_qdd_xx", xx, with_y),
            ("y_qdd_uq", uq, with_y),
        ],
        Quantity::MassMatrix => vec![("m", m, 0.0)],
        Quantity::Energy => {
            vec![("kinetic", vec![energy.kinetic], 0.0), ("potential", vec![energy.potential], tau_size)]
        }
        Quantity::InverseDynamics => vec![("tau", tau, tau_size)],
        Quantity::TauZ => vec![("tau", tau, tau_size), ("tau_z", tau_z, tau_size)],
        Quantity::YTauZZ => vec![
            ("tau", tau, tau_size),
            ("tau_z", tau_z, tau_size),
            ("y_tau_xx", tau_xx, tau_y),
            ("y_tau_aq", tau_aq, tau_y),
        ],
        _ => panic!("not in (q, v), or not known here"),
    }
}

/// What is wrong with the results of a program, one after the other, if anything is.
pub fn judge(program: &Program, found: &[f64], expected: &[Expected], tolerance: f64) -> Result<(), String> {
    let mut rest = found;
    for result in program.results() {
        let (found, more) = rest.split_at(result.entries.len());
        rest = more;
        let (_, expected, natural) = expected.iter().find(|(name, ..)| *name == result.name).unwrap();
        assert_eq!(found.len(), expected.len(), "length of {}", result.name);
        let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        let (worst, size) = (largest(&differences), largest(expected).max(*natural));
        if worst.is_nan() || worst > tolerance * size {
            return Err(format!("{} of {} is off by {:.2e}", result.name, program.name(), worst / size));
        }
    }
    Ok(())
}
