//! The variation of the Lagrangian at the points of an interval, from the two kernels.

use costate::EvalError;
use costate::kernels::{KernelOne, KernelTwo, friction};
use costate::matrix::{add_scaled, dot};
use costate::robot::Tree;

/// Weights of Lobatto's four points.
pub const WEIGHTS: [f64; 4] = [1.0 / 12.0, 5.0 / 12.0, 5.0 / 12.0, 1.0 / 12.0];

/// Lobatto's four points on [0, 1].
pub fn places() -> [f64; 4] {
    let half = 0.2_f64.sqrt() / 2.0;
    [0.0, 0.5 - half, 0.5 + half, 1.0]
}

/// D_ij, the derivative of the j-th Lagrange polynomial of these points at the i-th.
pub fn differentiation() -> [[f64; 4]; 4] {
    let c = places();
    let product = |j: usize| (0..4).filter(|&k| k != j).map(|k| c[j] - c[k]).product::<f64>();
    let mut d = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in (0..4).filter(|&j| j != i) {
            d[i][j] = product(i) / product(j) / (c[i] - c[j]);
        }
        d[i][i] = -d[i].iter().sum::<f64>();
    }
    d
}

/// Of an interval: its length (s), and q and y_p at its four points.
#[derive(Clone, Copy)]
pub struct Values<'a> {
    pub h: f64,
    pub q: &'a [f64],
    pub y: &'a [f64],
}

/// Blocks of second derivatives at a point, n x n each: by (y, q), (y, v), (y', q), (y', v), then by (q, q),
/// (v, q), (v, v), with their weights `h w`, `w` or `w / h`.
pub const BLOCKS: usize = 7;

/// Evaluates the variation L_q.y + L_v.y' + y.D and its derivatives.
pub struct Points {
    tree: Tree,
    n: usize,
    d: [[f64; 4]; 4],
    kernel: KernelOne<f64>,
    along: KernelTwo<f64>,
    v: Vec<f64>,
    y_rate: Vec<f64>,
    by_q: Vec<f64>,
    by_v: Vec<f64>,
    /// Of all four points.
    pub blocks: Vec<f64>,
}

impl Points {
    pub fn new(tree: Tree) -> Self {
        let n = tree.dof();
        let zeros = vec![0.0; n];
        Self {
            n,
            d: differentiation(),
            kernel: KernelOne::new(&tree),
            along: KernelTwo::new(&tree),
            v: zeros.clone(),
            y_rate: zeros.clone(),
            by_q: zeros.clone(),
            by_v: zeros,
            blocks: vec![0.0; 4 * BLOCKS * n * n],
            tree,
        }
    }

    /// Adds the gradient of the interval, without that of the cost of controls, to those by q and y of its
    /// points; with `second` sets the blocks.
    pub fn evaluate(
        &mut self,
        Values { h, q, y }: Values<'_>,
        [g_q, g_y]: [&mut [f64]; 2],
        second: bool,
    ) -> Result<(), EvalError> {
        let n = self.n;
        for i in 0..4 {
            for a in 0..n {
                let rate = |x: &[f64]| (0..4).map(|j| self.d[i][j] * x[j * n + a]).sum::<f64>() / h;
                (self.v[a], self.y_rate[a]) = (rate(q), rate(y));
            }
            let (q, y) = (&q[i * n..][..n], &y[i * n..][..n]);
            self.at(q, y)?;
            let w = WEIGHTS[i];
            for a in 0..n {
                let force = friction(&self.tree.joints()[a].friction, self.v[a]);
                self.by_v[a] += force.first * y[a];
                g_y[i * n + a] += h * w * (self.kernel.l_q()[a] + force.value);
                g_q[i * n + a] += h * w * self.by_q[a];
                for j in 0..4 {
                    g_y[j * n + a] += w * self.d[i][j] * self.kernel.momentum()[a];
                    g_q[j * n + a] += w * self.d[i][j] * self.by_v[a];
                }
            }
            if second {
                self.along.differentiate(&self.tree, &self.kernel, y, &self.y_rate)?;
                self.set_blocks(i, h, y);
            }
        }
        Ok(())
    }

    /// Kernel one, and the gradient by q and v but for friction.
    fn at(&mut self, q: &[f64], y: &[f64]) -> Result<(), EvalError> {
        let Self { tree, kernel, v, y_rate, by_q, by_v, .. } = self;
        kernel.set_position(tree, q)?;
        kernel.set_velocity(tree, v)?;
        kernel.second_order(tree);
        for a in 0..y.len() {
            by_q[a] = dot(kernel.l_qq().row(a), y);
            by_v[a] = dot(kernel.l_vq().row(a), y) + dot(kernel.mass_matrix().row(a), y_rate);
        }
        for (b, &rate) in y_rate.iter().enumerate() {
            add_scaled(by_q, rate, kernel.l_vq().row(b));
        }
        Ok(())
    }

    fn set_blocks(&mut self, i: usize, h: f64, y: &[f64]) {
        let (n, w) = (self.n, WEIGHTS[i]);
        let (mass, p, l_qq) = (self.kernel.mass_matrix(), self.kernel.l_vq(), self.kernel.l_qq());
        let (d_mass, d_p, d_l_qq) = (self.along.mass_matrix(), self.along.l_vq(), self.along.l_qq());
        let blocks = &mut self.blocks[i * BLOCKS * n * n..][..BLOCKS * n * n];
        for a in 0..n {
            for b in 0..n {
                let entries = [
                    h * w * l_qq[(a, b)],
                    w * p[(b, a)],
                    w * p[(a, b)],
                    w / h * mass[(a, b)],
                    h * w * d_l_qq[(a, b)],
                    w * d_p[(a, b)],
                    w / h * d_mass[(a, b)],
                ];
                entries.into_iter().enumerate().for_each(|(k, entry)| blocks[(k * n + a) * n + b] = entry);
            }
            let force = friction(&self.tree.joints()[a].friction, self.v[a]);
            blocks[(n + a) * n + a] += w * force.first;
            blocks[(6 * n + a) * n + a] += w / h * y[a] * force.second;
        }
    }
}
