//! Damped BFGS on each node's block, for a solver without second derivatives.

use crate::curvature::{Model, Nodes};
use nalgebra::{DMatrix, DVector};

/// One block per node, and the data of the last update.
pub struct Learnt {
    pub hessian: Vec<DMatrix<f64>>,
    before: Option<(Nodes, Model)>,
}

impl Learnt {
    /// Starts from the Hessian of the cost, made definite by a small part of its largest entry.
    pub fn new(model: &Model) -> Self {
        let hessian = model.hessian.iter().map(|block| {
            let shift = 1e-3 * block.amax();
            block + DMatrix::identity(block.nrows(), block.ncols()) * shift
        });
        Self { hessian: hessian.collect(), before: None }
    }

    /// Updates from the change of the gradient of the Lagrangian since the last call, both with the current
    /// costates.
    pub fn learn(&mut self, nodes: Nodes, model: &Model, costates: &[DVector<f64>]) {
        if let Some((old_nodes, old)) = &self.before {
            let gradients = model.lagrangian_gradient(costates);
            let old_gradients = old.lagrangian_gradient(costates);
            for (k, block) in self.hessian.iter_mut().enumerate() {
                update(block, &(&nodes[k] - &old_nodes[k]), &(&gradients[k] - &old_gradients[k]));
            }
        }
        self.before = Some((nodes, model.clone()));
    }
}

/// Powell's damped update: stays positive definite for any curvature.
fn update(block: &mut DMatrix<f64>, step: &DVector<f64>, change: &DVector<f64>) {
    let image = &*block * step;
    let curvature = step.dot(&image);
    if curvature <= f64::EPSILON * step.norm_squared() {
        return;
    }
    let seen = step.dot(change);
    let share = if seen >= 0.2 * curvature { 1.0 } else { 0.8 * curvature / (curvature - seen) };
    let damped = change * share + &image * (1.0 - share);
    let along = step.dot(&damped);
    block.ger(1.0 / along, &damped, &damped, 1.0);
    block.ger(-1.0 / curvature, &image, &image, 1.0);
}
