//! Numbers that represent expressions of parameters.

use crate::codegen::record::Expr;
use crate::scalar::Scalar;
use nalgebra::Matrix3;

/// Labels and the expressions that they represent.
pub(super) struct Labels {
    state: u64,
    pub table: Vec<(f64, Expr)>,
}

impl Labels {
    pub fn new() -> Self {
        Self { state: 0x5eed, table: Vec::new() }
    }

    /// A label for an expression: a number in (1, 2) that no formula contains.
    pub fn label(&mut self, expr: Expr) -> f64 {
        self.state =
            self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let label = f64::from_bits(1.0_f64.to_bits() | (self.state >> 12));
        self.table.push((label, expr));
        label
    }

    pub fn all<const N: usize>(&mut self, expressions: [Expr; N]) -> [f64; N] {
        expressions.map(|expr| self.label(expr))
    }

    /// The label of a product or a difference that the kernels form from labels. Labels are looked up by
    /// their magnitudes.
    pub fn derived(&mut self, value: f64, expr: Expr) {
        self.table.push(if value < 0.0 { (-value, -expr) } else { (value, expr) });
    }
}

/// `A x`.
pub(super) fn turned(turn: &Matrix3<f64>, x: [Expr; 3]) -> [Expr; 3] {
    [0, 1, 2].map(|i| (0..3).fold(Expr::zero(), |sum, k| sum + x[k].times(turn[(i, k)])))
}
