//! What the generic code gives for the arguments of a program, to judge generated code by.

use crate::rounding::{At, Bounds, InverseBounds, close, rows as flat};
use costate::codegen::{Coordinates, Program, Quantity};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
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

/// A result by the generic code, and how far rounding may take another method from it.
pub type Expected = (&'static str, Vec<f64>, f64);

/// How results of a robot round at one state.
#[derive(Clone, Copy, Debug)]
pub struct Rounding {
    forward: Bounds,
    inverse: InverseBounds,
}

impl Rounding {
    /// At (q, v) with a = u.
    pub fn new(robot: &Robot, at: At<'_>) -> Self {
        let w = &at.y[at.u.len()..];
        Self { forward: Bounds::at(robot, at), inverse: InverseBounds::new(robot, [at.q, at.v, at.u, w]) }
    }
}

/// All results of a quantity by the generic code.
pub fn expected(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    state: &State,
    rounding: &Rounding,
) -> Vec<Expected> {
    match coordinates {
        Coordinates::Hamiltonian => in_q_p(robot, quantity, state, rounding),
        Coordinates::Lagrangian => in_q_v(robot, quantity, state, rounding),
    }
}

fn in_q_p(robot: &Robot, quantity: Quantity, state: &State, rounding: &Rounding) -> Vec<Expected> {
    let State { q, second: p, u, y, d } = state;
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    let product = second.hessian_product(q, p, y, d).unwrap().to_vec();
    let y_f_x = second.first().adjoint(q, p, u, y).unwrap().y_f_x.to_vec();
    let energy = second.first().energy(q, p).unwrap();
    let m = second.first().mass_matrix(q).unwrap().as_slice().to_vec();
    let all = second.contract(q, p, u, y).unwrap();
    let (f, f_x) = (all.linearisation().f().to_vec(), flat(all.linearisation().matrix()));
    let y_f_xx = flat(all.matrix());
    let of = &rounding.forward;
    match quantity {
        Quantity::F => vec![("f", f, of.f)],
        Quantity::FX => vec![("f", f, of.f), ("f_x", f_x, of.f_x)],
        Quantity::YFX => vec![("f", f, of.f), ("y_f_x", y_f_x, of.y_f_x)],
        Quantity::YFXX => vec![("f", f, of.f), ("f_x", f_x, of.f_x), ("y_f_xx", y_f_xx, of.y_f_xx)],
        Quantity::HessianProduct => vec![("y_f_xx_d", product, of.product)],
        Quantity::MassMatrix => vec![("m", m, of.m)],
        Quantity::Energy => vec![
            ("kinetic", vec![energy.kinetic], of.kinetic),
            ("potential", vec![energy.potential], of.potential),
        ],
        _ => panic!("not in (q, p), or not known here"),
    }
}

fn in_q_v(robot: &Robot, quantity: Quantity, state: &State, rounding: &Rounding) -> Vec<Expected> {
    let State { q, second: v, u, y, .. } = state;
    let (n, y) = (v.len(), &y[u.len()..]);
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let mut second = LagrangianSecondOrder::<f64>::new(robot);
    let all = second.contract_forward_dynamics(q, v, u, y).unwrap();
    let (qdd, qdd_z) =
        (all.forward_dynamics().acceleration().to_vec(), flat(all.forward_dynamics().matrix()));
    let (xx, uq) = (flat(all.xx()), flat(all.uq()));
    let energy = lagrangian.energy(q, v).unwrap();
    let m = lagrangian.mass_matrix(q).unwrap().as_slice().to_vec();
    let tau = lagrangian.linearise_inverse_dynamics(q, v, u).unwrap();
    let tau_z: Vec<f64> = (0..n)
        .flat_map(|i| [tau.tau_q, tau.tau_v, tau.tau_a].map(|block| block.row(i).to_vec()).concat())
        .collect();
    let tau = tau.tau.to_vec();
    let bent = second.contract_inverse_dynamics(q, v, u, y).unwrap();
    let (tau_xx, tau_aq) = (flat(bent.xx()), flat(bent.aq()));
    let Rounding { forward: of, inverse: of_tau } = rounding;
    match quantity {
        Quantity::F => vec![("qdd", qdd, of.a)],
        Quantity::FX => vec![("qdd", qdd, of.a), ("qdd_z", qdd_z, of.a_z)],
        Quantity::YFX => {
            let column = |j: usize| (0..n).map(|i| y[i] * qdd_z[i * 3 * n + j]).sum();
            vec![("qdd", qdd, of.a), ("y_qdd_z", (0..3 * n).map(column).collect(), of.y_a_z)]
        }
        Quantity::YFXX => vec![
            ("qdd", qdd, of.a),
            ("qdd_z", qdd_z, of.a_z),
            ("y_qdd_xx", xx, of.y_a_zz),
            ("y_qdd_uq", uq, of.y_a_zz),
        ],
        Quantity::MassMatrix => vec![("m", m, of_tau.m)],
        Quantity::Energy => vec![
            ("kinetic", vec![energy.kinetic], of_tau.kinetic),
            ("potential", vec![energy.potential], of_tau.potential),
        ],
        Quantity::InverseDynamics => vec![("tau", tau, of_tau.tau)],
        Quantity::TauZ => vec![("tau", tau, of_tau.tau), ("tau_z", tau_z, of_tau.tau_z)],
        Quantity::YTauZZ => vec![
            ("tau", tau, of_tau.tau),
            ("tau_z", tau_z, of_tau.tau_z),
            ("y_tau_xx", tau_xx, of_tau.w_tau_zz),
            ("y_tau_aq", tau_aq, of_tau.w_tau_zz),
        ],
        _ => panic!("not in (q, v), or not known here"),
    }
}

/// What is wrong with the results of a program, one after the other, if anything is.
pub fn judge(program: &Program, found: &[f64], expected: &[Expected]) -> Result<(), String> {
    let mut rest = found;
    for result in program.results() {
        let (found, more) = rest.split_at(result.entries.len());
        rest = more;
        let (name, expected, bound) = expected.iter().find(|(name, ..)| *name == result.name).unwrap();
        close(&format!("{name} of {}", program.name()), found, expected, *bound)
            .map_err(|error| error.to_string())?;
    }
    Ok(())
}
