//! What constraints do where they set in, and the derivatives of their forces.

use crate::cores::Writer;
use crate::errors::Failure;
use costate::constraints::{Impact, ImpactWeights};
use costate::contacts::ForceMap;
use costate::matrix::Block;

/// Appends the rows of a matrix.
fn put(writer: &mut Writer<'_, f64>, matrix: Block<'_, f64>) {
    matrix.iter_rows().for_each(|row| {
        writer.put(row);
    });
}

/// What an impact computes.
#[derive(Clone, Copy, Debug)]
pub enum OfImpact {
    /// v+, p+, impulses and the loss.
    Value,
    /// Their Jacobians.
    Jacobian,
    /// The Hessian of y.p+.
    Hessian,
}

/// An impact at (q, p).
pub fn impact(
    of: &mut Impact<f64>,
    what: OfImpact,
    nq: usize,
    inputs: &[f64],
    writer: &mut Writer<'_, f64>,
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(nq);
    let (p, y) = rest.split_at(n);
    match what {
        OfImpact::Value => {
            let after = of.evaluate(q, p)?;
            writer.put(after.velocity).put(after.momentum).put(after.impulse).put(&[after.loss]);
        }
        OfImpact::Jacobian => {
            let found = of.linearise(q, p)?;
            put(writer, found.velocity_x());
            put(writer, found.momentum_x());
            put(writer, found.impulse_x());
        }
        OfImpact::Hessian => {
            let k = of.hamiltonian().constraints().count();
            let (velocity, impulse) = (vec![0.0; n], vec![0.0; k]);
            let weights = ImpactWeights { velocity: &velocity, momentum: y, impulse: &impulse };
            put(writer, of.contract(q, p, weights)?.view());
        }
    }
    Ok(())
}

/// The derivatives of the multipliers by (q, p, tau): the Jacobian, or the Hessian with weights that follow.
pub fn multipliers(
    of: &mut ForceMap<f64>,
    hessian: bool,
    nq: usize,
    inputs: &[f64],
    writer: &mut Writer<'_, f64>,
) -> Result<(), Failure> {
    let n = of.dof();
    let (q, rest) = inputs.split_at(nq);
    let (p, rest) = rest.split_at(n);
    let (tau, c) = rest.split_at(n);
    if hessian {
        put(writer, of.contract(q, p, tau, c)?.matrix());
    } else {
        put(writer, of.linearise(q, p, tau)?.lambda_z());
    }
    Ok(())
}
