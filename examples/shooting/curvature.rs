//! First and optionally second derivatives of the problem, node by node.

use crate::problem::{NotEvaluated, Problem};
use costate::dynamics::{Cost, CostHessian};
use costate::matrix::Block;
use costate::step::Step;
use nalgebra::{DMatrix, DVector};

/// One vector for each node.
pub type Nodes = Vec<DVector<f64>>;

/// The second derivatives that the solver uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// Of the Lagrangian: those of the cost and those of y'Phi, exact.
    Exact,
    /// Of the cost alone: those of Phi are dropped.
    CostOnly,
    /// The same and a multiple of the identity in the states: more after a step that was cut to less than a
    /// third, less after others, from the step after the next one on.
    Damped,
    /// Those of the cost at the start, then damped BFGS on each node's block.
    Bfgs,
}

impl Curvature {
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::CostOnly => "Gauss-Newton",
            Self::Damped => "damped G.-N.",
            Self::Bfgs => "BFGS",
        }
    }

    /// All kinds, the exact one first.
    pub const ALL: [Self; 4] = [Self::Exact, Self::CostOnly, Self::Damped, Self::Bfgs];
}

/// The derivatives of the problem at one chain of nodes.
#[derive(Clone)]
pub struct Model {
    /// Gradient of the cost, node by node.
    pub gradient: Nodes,
    /// (Phi_x, Phi_u), node by node.
    pub jacobian: Vec<DMatrix<f64>>,
    /// Hessian of the Lagrangian (or of the cost), node by node.
    pub hessian: Vec<DMatrix<f64>>,
}

impl Model {
    /// Costates `y_(k+1)` of the defects in; gradient of `cost + sum_k y_(k+1)'defect_k` out.
    pub fn lagrangian_gradient(&self, costates: &[DVector<f64>]) -> Nodes {
        let mut gradient = self.gradient.clone();
        for (k, costate) in costates.iter().enumerate() {
            gradient[k].gemv_tr(1.0, &self.jacobian[k], costate, 1.0);
            let mut next = gradient[k + 1].rows_mut(0, costate.len());
            next -= costate;
        }
        gradient
    }
}

impl<M: Step<f64>, L: Cost<f64>, F: Cost<f64>> Problem<M, L, F> {
    /// All derivatives at a chain of nodes. Second derivatives are those of `factor cost + y'Phi`, or of
    /// `factor cost` alone.
    pub fn model(
        &mut self,
        nodes: &[DVector<f64>],
        costates: &[DVector<f64>],
        (curvature, factor): (Curvature, f64),
    ) -> Result<Model, NotEvaluated> {
        let (n, m, h) = (self.states(), self.controls(), self.h);
        let mut gradient = Vec::with_capacity(nodes.len());
        let mut hessian = Vec::with_capacity(nodes.len());
        let mut jacobian = Vec::with_capacity(costates.len());
        for (pair, costate) in nodes.windows(2).zip(costates) {
            let (x, u) = pair[0].as_slice().split_at(n);
            let running = self.running.hessian(x, u).map_err(NotEvaluated::because)?;
            let (slope, mut second) = cost_at_node(&running, [h, factor], n, m);
            let first = if curvature == Curvature::Exact {
                let phi = self.step.contract(x, u, h, costate.as_slice()).map_err(NotEvaluated::because)?;
                add(&mut second, (0, 0), phi.xx, 1.0);
                if let Some(ux) = phi.ux {
                    add(&mut second, (n, 0), ux, 1.0);
                    add_transposed(&mut second, (0, n), ux, 1.0);
                }
                if let Some(uu) = phi.uu {
                    add(&mut second, (n, n), uu, 1.0);
                }
                phi.first
            } else {
                self.step.linearise(x, u, h).map_err(NotEvaluated::because)?
            };
            let mut both = DMatrix::zeros(n, n + m);
            add(&mut both, (0, 0), first.phi_x, 1.0);
            add(&mut both, (0, n), first.phi_u, 1.0);
            gradient.push(slope);
            hessian.push(second);
            jacobian.push(both);
        }
        let last = nodes[self.intervals].as_slice();
        let terminal = self.terminal.hessian(last, &[]).map_err(NotEvaluated::because)?;
        let (slope, second) = cost_at_node(&terminal, [1.0, factor], n, 0);
        gradient.push(slope);
        hessian.push(second);
        Ok(Model { gradient, jacobian, hessian })
    }
}

/// Weight times the gradient and the Hessian of a cost, this one times a factor too.
fn cost_at_node(
    cost: &CostHessian<'_, f64>,
    [h, factor]: [f64; 2],
    n: usize,
    m: usize,
) -> (DVector<f64>, DMatrix<f64>) {
    let slope = cost.gradient.x.iter().chain(cost.gradient.u).map(|entry| h * entry);
    let gradient = DVector::from_iterator(n + m, slope);
    let mut hessian = DMatrix::zeros(n + m, n + m);
    add(&mut hessian, (0, 0), cost.xx, factor * h);
    add(&mut hessian, (n, n), cost.uu, factor * h);
    if let Some(ux) = cost.ux {
        add(&mut hessian, (n, 0), ux, factor * h);
        add_transposed(&mut hessian, (0, n), ux, factor * h);
    }
    (gradient, hessian)
}

fn add(target: &mut DMatrix<f64>, (top, left): (usize, usize), block: Block<'_, f64>, factor: f64) {
    for (i, row) in block.iter_rows().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            target[(top + i, left + j)] += factor * entry;
        }
    }
}

fn add_transposed(
    target: &mut DMatrix<f64>,
    (top, left): (usize, usize),
    block: Block<'_, f64>,
    factor: f64,
) {
    for (i, row) in block.iter_rows().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            target[(top + j, left + i)] += factor * entry;
        }
    }
}

/// Damped BFGS: one block per node, and the data of the last update.
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
