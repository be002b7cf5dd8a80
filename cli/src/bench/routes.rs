//! The quantities that are timed, and the methods for them.

use crate::work::{Method, Order, Work};
use costate::Coordinates;
use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::{Robot, Tree};
use costate::tensors::Christoffel;
use std::hint::black_box;

/// Quantities that more than one method computes.
pub const F: &str = "F";
pub const FIRST: &str = "F, F_x";
pub const ADJOINT: &str = "F, y'F_x";
pub const SECOND: &str = "F, F_x, y'F_xx";

/// Why a candidate failed.
pub type Failure = Box<dyn std::error::Error>;

/// One call. It appends its figures to the list if one is given.
pub type Call<'a> = Box<dyn FnMut(Option<&mut Vec<f64>>) -> Result<(), Failure> + 'a>;

/// A quantity, a method for it, and the call that is timed.
pub struct Candidate<'a> {
    pub quantity: &'static str,
    pub route: &'static str,
    pub work: Call<'a>,
}

/// The state at which everything is evaluated.
pub struct State {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub u: Vec<f64>,
    /// (q, p).
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub d: Vec<f64>,
}

impl State {
    /// Uniformly random: q within +-pi, v, u, y and d within +-1.
    pub fn random(robot: &Robot, seed: u64) -> Result<Self, Failure> {
        let n = robot.dof();
        let mut random = fastrand::Rng::with_seed(seed);
        let mut numbers = |count: usize, most: f64| -> Vec<f64> {
            (0..count).map(|_| most * (2.0 * random.f64() - 1.0)).collect()
        };
        let q = numbers(n, std::f64::consts::PI);
        let [v, u, y, d] = [n, n, 2 * n, 2 * n].map(|count| numbers(count, 1.0));
        let mut x = q.clone();
        x.extend(Hamiltonian::<f64>::new(robot).momentum(&q, &v)?);
        Ok(Self { q, v, u, x, y, d })
    }
}

fn give(to: Option<&mut Vec<f64>>, block: Block<'_, f64>) {
    if let Some(to) = to {
        block.iter_rows().for_each(|row| to.extend(row));
    }
    black_box(block[(0, 0)]);
}

fn give_slice(to: Option<&mut Vec<f64>>, figures: &[f64]) {
    if let Some(to) = to {
        to.extend(figures);
    }
    black_box(figures[0]);
}

/// All candidates, grouped by quantity; other methods are compared with the first one for the same quantity.
pub fn candidates<'a>(robot: &Robot, state: &'a State, notes: &mut Vec<String>) -> Vec<Candidate<'a>> {
    let mut list = Vec::new();
    first_order(robot, state, &mut list);
    second_order(robot, state, &mut list);
    automatic_second_order(robot, state, &mut list, notes);
    in_velocities(robot, state, &mut list);
    list
}

fn add<'a>(
    list: &mut Vec<Candidate<'a>>,
    [quantity, route]: [&'static str; 2],
    work: impl FnMut(Option<&mut Vec<f64>>) -> Result<(), Failure> + 'a,
) {
    list.push(Candidate { quantity, route, work: Box::new(work) });
}

fn first_order<'a>(robot: &Robot, state: &'a State, list: &mut Vec<Candidate<'a>>) {
    let n = robot.dof();
    let State { x, u, y, .. } = state;
    let (q, p) = x.split_at(n);
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    add(list, [F, "analytic"], move |to| {
        give_slice(to, hamiltonian.evaluate(black_box(q), p, u)?);
        Ok(())
    });
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    add(list, [FIRST, "analytic"], move |to| {
        give(to, hamiltonian.linearise(black_box(q), p, u)?.matrix());
        Ok(())
    });
    let mut tensors = Hamiltonian::<f64, _>::with_route(Tree::from(robot), Christoffel);
    add(list, [FIRST, "tensors"], move |to| {
        give(to, tensors.linearise(black_box(q), p, u)?.matrix());
        Ok(())
    });
    let mut jacobian = Jacobian::new(PhaseVelocity::new(robot).under(u));
    add(list, [FIRST, "dual numbers"], move |to| {
        give(to, jacobian.linearise(black_box(x))?.jacobian.view());
        Ok(())
    });
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut differences = Differences::new(2 * n);
    add(list, [FIRST, "central differences of F"], move |to| {
        let columns = differences.of(black_box(x), |x, sign, column| {
            let f = hamiltonian.evaluate(&x[..n], &x[n..], u)?;
            column.iter_mut().zip(f).for_each(|(c, f)| *c += sign * f);
            Ok(())
        })?;
        give_transposed(to, columns, 2 * n);
        Ok(())
    });
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    add(list, [ADJOINT, "adjoint product"], move |to| {
        give_slice(to, hamiltonian.adjoint(black_box(q), p, u, y)?.y_f_x);
        Ok(())
    });
}

fn second_order<'a>(robot: &Robot, state: &'a State, list: &mut Vec<Candidate<'a>>) {
    let n = robot.dof();
    let State { x, u, y, d, .. } = state;
    let (q, p) = x.split_at(n);
    let quantity = SECOND;
    let mut rule = HamiltonianSecondOrder::<f64>::new(robot);
    add(list, [quantity, "2n+1 rule"], move |to| {
        give(to, rule.contract(black_box(q), p, u, y)?.matrix());
        Ok(())
    });
    let mut pass = DualPass::<f64>::new(robot);
    add(list, [quantity, "one dual pass through F_x"], move |to| {
        give(to, pass.contract(black_box(q), p, u, y)?.matrix());
        Ok(())
    });
    let mut tensors = DualPass::<f64, _>::with_route(Tree::from(robot), Christoffel);
    add(list, [quantity, "one dual pass through tensors"], move |to| {
        give(to, tensors.contract(black_box(q), p, u, y)?.matrix());
        Ok(())
    });
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut differences = Differences::new(2 * n);
    add(list, [quantity, "central differences of F_x"], move |to| {
        let columns = differences.of(black_box(x), |x, sign, column| {
            let linear = hamiltonian.linearise(&x[..n], &x[n..], u)?;
            for (row, y) in linear.matrix().iter_rows().zip(y) {
                column.iter_mut().zip(row).for_each(|(c, f)| *c += sign * y * f);
            }
            Ok(())
        })?;
        give_transposed(to, columns, 2 * n);
        Ok(())
    });
    let mut rule = HamiltonianSecondOrder::<f64>::new(robot);
    add(list, ["y'F_xx d", "product with a vector"], move |to| {
        give_slice(to, rule.hessian_product(black_box(q), p, y, d)?);
        Ok(())
    });
    let mut full = FullHessian::<f64>::new(robot);
    add(list, ["F_x, all of F_xx", "packed tensor"], move |to| {
        give_slice(to, full.hessian_tensor(black_box(q), p)?.packed());
        Ok(())
    });
}

/// Skipped with a note where they would take minutes for each call.
fn automatic_second_order<'a>(
    robot: &Robot,
    state: &'a State,
    list: &mut Vec<Candidate<'a>>,
    notes: &mut Vec<String>,
) {
    let State { x, u, y, .. } = state;
    let mut is_feasible = |route: &str, method| {
        let work = Work::of_state(robot, Coordinates::Hamiltonian, method, Order::Second);
        if work.is_excessive() {
            notes.push(format!("No figures for {route}: {work} for each state."));
        }
        !work.is_excessive()
    };
    let route = "dual in dual numbers through F";
    if is_feasible(route, Method::Nested) {
        let mut nested = NestedHessian::new(PhaseVelocity::new(robot).under(u));
        add(list, [SECOND, route], move |to| {
            give(to, nested.contract(black_box(x), y)?.view());
            Ok(())
        });
    }
    let route = "hyper-dual pairs through F";
    if is_feasible(route, Method::HyperDual) {
        let mut hyperdual = Hessian::new(PhaseVelocity::new(robot).under(u));
        add(list, [SECOND, route], move |to| {
            give(to, hyperdual.contract(black_box(x), y)?.view());
            Ok(())
        });
    }
}

fn in_velocities<'a>(robot: &Robot, state: &'a State, list: &mut Vec<Candidate<'a>>) {
    let State { q, v, u, y, .. } = state;
    let costate = &y[robot.dof()..];
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    add(list, ["tau(q, v, a)", "analytic"], move |to| {
        give_slice(to, lagrangian.inverse_dynamics(black_box(q), v, u)?);
        Ok(())
    });
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    add(list, ["a(q, v, u)", "analytic"], move |to| {
        give_slice(to, lagrangian.forward_dynamics(black_box(q), v, u)?);
        Ok(())
    });
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    add(list, ["a, a_z", "analytic"], move |to| {
        give(to, lagrangian.linearise_forward_dynamics(black_box(q), v, u)?.matrix());
        Ok(())
    });
    let mut second = LagrangianSecondOrder::<f64>::new(robot);
    add(list, ["a, a_z, y'a_zz", "one dual pass"], move |to| {
        give(to, second.contract_forward_dynamics(black_box(q), v, u, costate)?.xx());
        Ok(())
    });
}

/// Central differences: column j is `(g(x + h e_j) - g(x - h e_j)) / 2h`.
struct Differences {
    x: Vec<f64>,
    columns: Vec<f64>,
}

/// About the cube root of the rounding error of f64, where truncation and rounding errors are about equal.
const STEP: f64 = 6e-6;

impl Differences {
    fn new(length: usize) -> Self {
        Self { x: vec![0.0; length], columns: vec![0.0; length * length] }
    }

    /// `add_to(x, sign, column)` adds `sign g(x)` to the column.
    fn of(
        &mut self,
        x: &[f64],
        mut add_to: impl FnMut(&[f64], f64, &mut [f64]) -> Result<(), Failure>,
    ) -> Result<&[f64], Failure> {
        for (j, column) in self.columns.chunks_mut(x.len()).enumerate() {
            column.fill(0.0);
            for sign in [1.0, -1.0] {
                self.x.copy_from_slice(x);
                self.x[j] += sign * STEP;
                add_to(&self.x, sign * 0.5 / STEP, column)?;
            }
        }
        Ok(&self.columns)
    }
}

/// As [`give_slice`], for a matrix stored by columns.
fn give_transposed(to: Option<&mut Vec<f64>>, columns: &[f64], length: usize) {
    if let Some(to) = to {
        (0..length).for_each(|i| to.extend((0..length).map(|j| columns[j * length + i])));
    }
    black_box(columns[0]);
}
