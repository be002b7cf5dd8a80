//! Elimination of the nodes, one after the other.
//!
//! In the order y_0, y_1, q_0, y_2, q_1, .. each q follows all controls that it meets. Then the pivots of
//! every q are positive and those of every y are negative if and only if the motion is a local minimum on its
//! mesh: the pivots up to q_k are those of the motion that ends at node k + 1.

use crate::numerics::{Rows, WrongSign, add, backward, factorise, forward, negate, subtract};

/// The front of node k: y_k, q_k-1, and what they meet: y_k+1, q_k, q_k+1. Rows of y are negated.
#[derive(Clone)]
pub struct Front {
    n: usize,
    /// n x 5n.
    of_y: Vec<f64>,
    /// n x 4n.
    of_q: Vec<f64>,
}

/// What is left of a front: y_k+1 (n x 3n), q_k and q_k+1 (2n x 2n).
pub struct Rest {
    of_y: Vec<f64>,
    of_q: Vec<f64>,
}

impl Rest {
    pub fn new(n: usize) -> Self {
        Self { of_y: vec![0.0; 3 * n * n], of_q: vec![0.0; 4 * n * n] }
    }

    pub fn clear(&mut self) {
        self.of_y.fill(0.0);
        self.of_q.fill(0.0);
    }
}

/// Which q of a front is given: q_k, or q_k+1.
#[derive(Clone, Copy)]
pub enum Given {
    Left,
    Right,
}

impl Front {
    pub fn new(n: usize) -> Self {
        Self { n, of_y: vec![0.0; 5 * n * n], of_q: vec![0.0; 4 * n * n] }
    }

    /// Takes what the last front left, and leaves a rest with nothing new.
    pub fn take(&mut self, rest: &mut Rest, first: bool) {
        let n = self.n;
        self.of_y.fill(0.0);
        self.of_q.fill(0.0);
        for a in 0..n {
            let (to, from) = (&mut self.of_y[5 * n * a..], &rest.of_y[3 * n * a..][..3 * n]);
            to[..2 * n].copy_from_slice(&from[..2 * n]);
            to[3 * n..4 * n].copy_from_slice(&from[2 * n..]);
            let (to, from) = (&mut self.of_q[4 * n * a..], &rest.of_q[2 * n * a..][..2 * n]);
            to[..n].copy_from_slice(&from[..n]);
            to[2 * n..3 * n].copy_from_slice(&from[n..]);
            if first {
                // There is no q before the first node.
                self.of_q[4 * n * a + a] = 1.0;
            }
        }
        for a in 0..n {
            let (above, below) = rest.of_q.split_at_mut(2 * n * n);
            above[2 * n * a..][..n].copy_from_slice(&below[2 * n * a + n..][..n]);
            above[2 * n * a + n..][..n].fill(0.0);
            below[2 * n * a..][..2 * n].fill(0.0);
        }
        rest.of_y.fill(0.0);
    }

    /// Adds the matrix of an interval: q left and right, y left and right.
    pub fn add(&mut self, nodes: &[f64], rest: &mut Rest) {
        let n = self.n;
        let at = |i: usize, j: usize, a: usize, b: usize| nodes[4 * n * (i * n + a) + j * n + b];
        for a in 0..n {
            let of_y = &mut self.of_y[5 * n * a..][..5 * n];
            let (left_y, left_q) = (&mut rest.of_y[3 * n * a..][..3 * n], &mut rest.of_q);
            for b in 0..n {
                of_y[b] -= at(2, 2, a, b);
                of_y[2 * n + b] -= at(2, 3, a, b);
                of_y[3 * n + b] -= at(0, 2, b, a);
                of_y[4 * n + b] -= at(1, 2, b, a);
                left_y[b] -= at(3, 3, a, b);
                left_y[n + b] -= at(0, 3, b, a);
                left_y[2 * n + b] -= at(1, 3, b, a);
                left_q[2 * n * a + b] += at(0, 0, a, b);
                left_q[2 * n * a + n + b] += at(0, 1, a, b);
                left_q[2 * n * (n + a) + n + b] += at(1, 1, a, b);
            }
        }
    }

    /// Rows and columns of a given q become those of the identity.
    pub fn give(&mut self, rest: &mut Rest, given: Given) {
        let n = self.n;
        let (of_front, of_rest) = match given {
            Given::Left => (3 * n, 0),
            Given::Right => (4 * n, n),
        };
        for a in 0..n {
            self.of_y[5 * n * a + of_front..][..n].fill(0.0);
            rest.of_y[3 * n * a + n + of_rest..][..n].fill(0.0);
            rest.of_q[2 * n * a + n..][..n].fill(0.0);
            let row = &mut rest.of_q[2 * n * (of_rest + a) + of_rest..][..n];
            row.fill(0.0);
            row[a] = 1.0;
        }
    }

    /// Eliminates y_k and q_k-1.
    pub fn eliminate(&mut self, rest: &mut Rest) -> Result<(), WrongSign> {
        let n = self.n;
        factorise(&mut self.of_y, 5 * n)?;
        add((&self.of_y, 5 * n), n, (&mut self.of_q, 4 * n));
        factorise(&mut self.of_q, 4 * n)?;
        let (of_y, of_q): (Rows<'_>, Rows<'_>) = ((&self.of_y, 5 * n), (&self.of_q, 4 * n));
        subtract(of_y, 2 * n, (&mut rest.of_y, 3 * n), 3 * n);
        add(of_q, n, (&mut rest.of_y, 3 * n));
        add(of_y, 3 * n, (&mut rest.of_q, 2 * n));
        subtract(of_q, 2 * n, (&mut rest.of_q, 2 * n), 2 * n);
        Ok(())
    }

    /// The first half of the solution for `part`: y_k, q_k-1, y_k+1, q_k, q_k+1.
    pub fn forward(&self, part: &mut [f64]) {
        let n = self.n;
        forward((&self.of_y, 5 * n), part);
        forward((&self.of_q, 4 * n), &mut part[n..]);
        negate(&mut part[..n]);
    }

    /// The second half: the last three are known.
    pub fn backward(&self, part: &mut [f64]) {
        let n = self.n;
        backward((&self.of_q, 4 * n), &mut part[n..]);
        backward((&self.of_y, 5 * n), part);
    }
}
