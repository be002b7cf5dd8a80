//! What CasADi can compute of a robot: dynamics, inverse dynamics, time steps, frames, the centre of mass.

use super::layout::{Block, Description};
use crate::cores::{Core, Order, Writer, core_of};
use crate::engine::Engine;
use crate::engines::engine_of;
use crate::errors::Failure;
use crate::schemes::{self, Known, SCHEMES};
use costate::Coordinates;
use costate::codegen::{CodegenError, Quantity, Variable};
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::Robot;
use costate::spatial::{Force, Motion};
use std::sync::Arc;

/// A function of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    pub robot: Arc<Robot>,
    pub kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// (q, v, tau) -> a.
    Dynamics,
    /// (q, v, a) -> tau.
    InverseDynamics,
    /// (x, tau) -> next x, by a scheme of [`SCHEMES`] with this duration.
    Step { scheme: usize, dt: f64, coordinates: Coordinates },
    /// q -> (R, x) of the frame of this number.
    Frame(usize),
    /// (q, v) -> (omega, rate) of the frame of this number: its twist at its origin, in axes of the world.
    Twist(usize),
    /// q -> c.
    CentreOfMass,
}

impl Spec {
    /// Arguments, results, and where the derivatives are.
    pub fn description(&self) -> Description {
        let n = self.robot.dof();
        let vector = Variable::vector;
        match self.kind {
            Kind::Dynamics => torques(n, "tau", "a"),
            Kind::InverseDynamics => torques(n, "a", "tau"),
            Kind::Step { .. } => {
                let jacobian = 4 * n;
                let first = jacobian + 6 * n * n;
                Description::new(
                    vec![vector("x", 2 * n), vector("tau", n)],
                    vec![vector("x_next", 2 * n)],
                    [2 * n, first, first + 9 * n * n],
                    jacobian,
                    dense(first, &[2 * n, n]),
                )
            }
            Kind::Frame(_) => {
                let first = FRAME + FRAME * n;
                Description::new(
                    vec![vector("q", n)],
                    vec![Variable { name: "R", rows: 3, columns: 3 }, vector("x", 3)],
                    [FRAME, first, first + n * n],
                    FRAME,
                    dense(first, &[n]),
                )
            }
            Kind::Twist(_) => {
                let first = TWIST + TWIST * 2 * n;
                let mut hessian = dense(first, &[n, n]);
                hessian[1][1] = None;
                Description::new(
                    vec![vector("q", n), vector("v", n)],
                    vec![vector("omega", 3), vector("rate", 3)],
                    [TWIST, first, first + 4 * n * n],
                    TWIST,
                    hessian,
                )
            }
            Kind::CentreOfMass => {
                let first = 3 + 3 * n;
                Description::new(
                    vec![vector("q", n)],
                    vec![vector("c", 3)],
                    [3, first, first + n * n],
                    3,
                    dense(first, &[n]),
                )
            }
        }
    }

    /// What computes it.
    ///
    /// # Errors
    /// A quantity that the robot does not have; none of these is.
    pub fn engine(&self, order: Order) -> Result<Engine, CodegenError> {
        let robot = self.robot.clone();
        let in_velocities =
            |of: [Quantity; 3]| Ok(engine_of(robot, of[order as usize], Coordinates::Lagrangian)?.0);
        match self.kind {
            Kind::Dynamics => in_velocities([Quantity::F, Quantity::FX, Quantity::YFXX]),
            Kind::InverseDynamics => {
                in_velocities([Quantity::InverseDynamics, Quantity::TauZ, Quantity::YTauZZ])
            }
            Kind::Step { scheme, dt, coordinates } => {
                let (_, build): Known = SCHEMES[scheme];
                let steps = build.steps(&self.robot, coordinates)?;
                Ok(Engine::new(move || {
                    core_of(steps(), move |step, inputs, outputs| {
                        schemes::evaluate(step, dt, order, inputs, outputs)
                    })
                }))
            }
            Kind::Frame(frame) => {
                let workspace = Kinematics::<f64>::new(&self.robot);
                Ok(Engine::new(move || pose(workspace.clone(), frame, order)))
            }
            Kind::Twist(frame) => {
                let workspace = Kinematics::<f64>::new(&self.robot);
                Ok(Engine::new(move || twist(workspace.clone(), frame, order)))
            }
            Kind::CentreOfMass => {
                let workspace = Kinematics::<f64>::new(&self.robot);
                Ok(Engine::new(move || centre_of_mass(workspace.clone(), order)))
            }
        }
    }
}

/// Dynamics or inverse dynamics: the quantities of both are laid out alike. `xx` (2n x 2n) and `uq` (n x n)
/// follow the Jacobian; there are no other second derivatives.
fn torques(n: usize, third: &'static str, result: &'static str) -> Description {
    let first = n + 3 * n * n;
    let uq = first + 4 * n * n;
    let xx = |i: usize, j: usize| Some(Block { at: first + i * 2 * n * n + j * n, row: 2 * n, column: 1 });
    let uq_transposed = Some(Block { at: uq, row: 1, column: n });
    let uq = Some(Block { at: uq, row: n, column: 1 });
    Description::new(
        ["q", "v", third].map(|name| Variable::vector(name, n)).to_vec(),
        vec![Variable::vector(result, n)],
        [n, first, first + 5 * n * n],
        n,
        vec![vec![xx(0, 0), xx(0, 1), uq_transposed], vec![xx(1, 0), xx(1, 1), None], vec![uq, None, None]],
    )
}

/// The blocks of a matrix that begins at `at`, by arguments of these lengths.
fn dense(at: usize, lengths: &[usize]) -> Vec<Vec<Option<Block>>> {
    let width: usize = lengths.iter().sum();
    let starts: Vec<usize> = (0..lengths.len()).map(|k| lengths[..k].iter().sum()).collect();
    let block = |i: usize, j: usize| Some(Block { at: at + i * width + j, row: width, column: 1 });
    starts.iter().map(|&i| starts.iter().map(|&j| block(i, j)).collect()).collect()
}

/// Entries of an orientation and a position.
const FRAME: usize = 12;

/// R column by column, x; their Jacobian; their second derivatives weighted by y.
fn pose(workspace: Kinematics<f64>, frame: usize, order: Order) -> Box<dyn Core> {
    let n = workspace.dof();
    core_of(workspace, move |of, inputs, outputs| {
        let (q, y) = inputs.split_at(n);
        of.set_position(q)?;
        let pose = of.pose(frame)?;
        let column = |l: usize| pose.rotation.map(|row| row[l]);
        let mut writer = Writer(outputs);
        (0..3).for_each(|l| {
            writer.put(&column(l));
        });
        writer.put(&pose.position);
        if order == Order::Value {
            return Ok(());
        }
        let (jacobian, hessian) = writer.0.split_at_mut(FRAME * n);
        let motion = of.jacobian(frame, ReferenceFrame::LocalWorldAligned)?;
        for k in 0..n {
            let axis = [0, 1, 2].map(|i| motion[(i, k)]);
            for l in 0..3 {
                let turning = cross(axis, column(l));
                (0..3).for_each(|i| jacobian[(3 * l + i) * n + k] = turning[i]);
            }
            (0..3).for_each(|i| jacobian[(9 + i) * n + k] = motion[(3 + i, k)]);
        }
        if order == Order::Second {
            second(of, frame, y, hessian)?;
        }
        Ok(())
    })
}

/// The second derivatives of the entries of R and x, weighted by y.
fn second(of: &mut Kinematics<f64>, frame: usize, y: &[f64], hessian: &mut [f64]) -> Result<(), Failure> {
    let weights = [0, 1, 2].map(|i| [0, 1, 2].map(|l| y[3 * l + i]));
    hessian.copy_from_slice(of.rotation_hessian(frame, &weights)?.as_slice());
    let position = of.position_hessian(frame, &[y[9], y[10], y[11]])?.as_slice();
    hessian.iter_mut().zip(position).for_each(|(sum, entry)| *sum += entry);
    Ok(())
}

/// Entries of a twist.
const TWIST: usize = 6;

/// The angular velocity and that of the origin; their Jacobian in (q, v); second derivatives weighted by y.
fn twist(workspace: Kinematics<f64>, frame: usize, order: Order) -> Box<dyn Core> {
    let (n, axes) = (workspace.dof(), ReferenceFrame::LocalWorldAligned);
    core_of(workspace, move |of, inputs, outputs| {
        let (q, rest) = inputs.split_at(n);
        let (v, y) = rest.split_at(n);
        of.set_state(q, v)?;
        let Motion { angular, linear } = of.twist(frame, axes)?;
        let mut writer = Writer(outputs);
        writer.put(&angular.to_array()).put(&linear.to_array());
        if order == Order::Value {
            return Ok(());
        }
        let (jacobian, hessian) = writer.0.split_at_mut(TWIST * 2 * n);
        let by_position = of.twist_jacobian(frame, axes)?;
        rows_of(jacobian, 2 * n)
            .zip(by_position.as_slice().chunks_exact(n.max(1)))
            .for_each(|(to, row)| to[..n].copy_from_slice(row));
        let by_velocity = of.jacobian(frame, axes)?;
        rows_of(jacobian, 2 * n)
            .zip(by_velocity.as_slice().chunks_exact(n.max(1)))
            .for_each(|(to, row)| to[n..].copy_from_slice(row));
        if order == Order::Second {
            let weight = Force { moment: [y[0], y[1], y[2]].into(), force: [y[3], y[4], y[5]].into() };
            hessian.copy_from_slice(of.twist_hessian(frame, axes, &weight)?.as_slice());
        }
        Ok(())
    })
}

fn rows_of(matrix: &mut [f64], columns: usize) -> std::slice::ChunksExactMut<'_, f64> {
    matrix.chunks_exact_mut(columns.max(1))
}

/// The centre of mass; its Jacobian; its second derivatives weighted by y.
fn centre_of_mass(workspace: Kinematics<f64>, order: Order) -> Box<dyn Core> {
    let n = workspace.dof();
    core_of(workspace, move |of, inputs, outputs| {
        let (q, y) = inputs.split_at(n);
        of.set_position(q)?;
        let centre = of.centre_of_mass()?;
        let mut writer = Writer(outputs);
        writer.put(&centre.position);
        if order != Order::Value {
            writer.put(centre.jacobian.as_slice());
        }
        if order == Order::Second {
            writer.put(of.centre_of_mass_hessian(&[y[0], y[1], y[2]])?.as_slice());
        }
        Ok(())
    })
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
