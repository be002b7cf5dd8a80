//! The quantities that are timed, and the methods for them.

#[path = "differences.rs"]
mod differences;
#[path = "state.rs"]
mod state;

use crate::work::{Method, Order, Work};
use costate::Coordinates;
use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::{Robot, Tree};
use costate::tensors::Christoffel;
use differences::Differences;
pub use state::{Failure, State};
use std::hint::black_box;

/// Quantities that more than one method computes.
pub const F: &str = "F";
pub const FIRST: &str = "F, F_x";
pub const ADJOINT: &str = "F, y'F_x";
pub const SECOND: &str = "F, F_x, y'F_xx";

/// One call. It appends its figures to the list if one is given.
pub type Call<'a> = Box<dyn FnMut(Option<&mut Vec<f64>>) -> Result<(), Failure> + 'a>;

/// A quantity, a method for it, and the call that is timed.
pub struct Candidate<'a> {
    pub quantity: &'static str,
    pub route: &'static str,
    pub work: Call<'a>,
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
/// Those that take no floating and spherical joints are left out of robots that have some.
///
/// # Errors
/// None at a [`State`] of the robot.
pub fn candidates<'a>(
    robot: &Robot,
    state: &'a State,
    notes: &mut Vec<String>,
) -> Result<Vec<Candidate<'a>>, Failure> {
    let mut velocity = PhaseVelocity::new(robot).under(&state.u);
    velocity.set_centre(&state.q)?;
    let mut list = Vec::new();
    first_order(robot, state, &velocity, &mut list);
    second_order(robot, state, &mut list);
    if !robot.free_joints().is_empty() {
        notes.push(
            "Derivatives are those in the tangent space. No figures for methods that take no floating and spherical \
             joints: tensors, dual passes through F_x, the packed tensor, batches."
                .into(),
        );
    }
    automatic_second_order(robot, state, &velocity, &mut list, notes);
    in_velocities(robot, state, &mut list);
    Ok(list)
}

fn add<'a>(
    list: &mut Vec<Candidate<'a>>,
    [quantity, route]: [&'static str; 2],
    work: impl FnMut(Option<&mut Vec<f64>>) -> Result<(), Failure> + 'a,
) {
    list.push(Candidate { quantity, route, work: Box::new(work) });
}

fn first_order<'a>(robot: &Robot, state: &'a State, velocity: &PhaseVelocity, list: &mut Vec<Candidate<'a>>) {
    let n = robot.dof();
    let State { x, z, u, y, .. } = state;
    let (q, p) = x.split_at(robot.nq());
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
    if robot.free_joints().is_empty() {
        let mut tensors = Hamiltonian::<f64, _>::with_route(Tree::from(robot), Christoffel);
        add(list, [FIRST, "tensors"], move |to| {
            give(to, tensors.linearise(black_box(q), p, u)?.matrix());
            Ok(())
        });
    }
    let mut jacobian = Jacobian::new(velocity.clone());
    add(list, [FIRST, "dual numbers"], move |to| {
        give(to, jacobian.linearise(black_box(z))?.jacobian.view());
        Ok(())
    });
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut differences = Differences::new(robot);
    add(list, [FIRST, "central differences of F"], move |to| {
        let columns = differences.of(black_box(state), |[q, p], sign, column| {
            let f = hamiltonian.evaluate(q, p, u)?;
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
    let (q, p) = x.split_at(robot.nq());
    let (quantity, is_plain) = (SECOND, robot.free_joints().is_empty());
    let mut rule = HamiltonianSecondOrder::<f64>::new(robot);
    add(list, [quantity, "2n+1 rule"], move |to| {
        give(to, rule.contract(black_box(q), p, u, y)?.matrix());
        Ok(())
    });
    if is_plain {
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
    }
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let mut differences = Differences::new(robot);
    add(list, [quantity, "central differences of F_x"], move |to| {
        let columns = differences.of(black_box(state), |[q, p], sign, column| {
            let linear = hamiltonian.linearise(q, p, u)?;
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
    if is_plain {
        let mut full = FullHessian::<f64>::new(robot);
        add(list, ["F_x, all of F_xx", "packed tensor"], move |to| {
            give_slice(to, full.hessian_tensor(black_box(q), p)?.packed());
            Ok(())
        });
    }
}

/// Skipped with a note where they would take minutes for each call.
fn automatic_second_order<'a>(
    robot: &Robot,
    state: &'a State,
    velocity: &PhaseVelocity,
    list: &mut Vec<Candidate<'a>>,
    notes: &mut Vec<String>,
) {
    let State { z, y, .. } = state;
    let mut is_feasible = |route: &str, method| {
        let work = Work::of_state(robot, Coordinates::Hamiltonian, method, Order::Second);
        if work.is_excessive() {
            notes.push(format!("No figures for {route}: {work} for each state."));
        }
        !work.is_excessive()
    };
    let route = "dual in dual numbers through F";
    if is_feasible(route, Method::Nested) {
        let mut nested = NestedHessian::new(velocity.clone());
        add(list, [SECOND, route], move |to| {
            give(to, nested.contract(black_box(z), y)?.view());
            Ok(())
        });
    }
    let route = "hyper-dual pairs through F";
    if is_feasible(route, Method::HyperDual) {
        let mut hyperdual = Hessian::new(velocity.clone());
        add(list, [SECOND, route], move |to| {
            give(to, hyperdual.contract(black_box(z), y)?.view());
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
    add(list, ["a, a_z, y'a_zz", "pairs of joints"], move |to| {
        give(to, second.contract_forward_dynamics(black_box(q), v, u, costate)?.xx());
        Ok(())
    });
}

/// As [`give_slice`], for a matrix stored by columns.
fn give_transposed(to: Option<&mut Vec<f64>>, columns: &[f64], length: usize) {
    if let Some(to) = to {
        (0..length).for_each(|i| to.extend((0..length).map(|j| columns[j * length + i])));
    }
    black_box(columns[0]);
}
