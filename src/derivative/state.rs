//! Where methods are compared.

use crate::matrix::filled;
use crate::scalar::Scalar;

/// A state in both sets of coordinates, actuation u, and costate y (2n).
#[derive(Clone, Debug)]
pub(super) struct State<S> {
    pub q: Vec<S>,
    pub p: Vec<S>,
    pub v: Vec<S>,
    pub u: Vec<S>,
    pub y: Vec<S>,
}

impl<S: Scalar> State<S> {
    /// (q, p), or (0, p) where positions are directions from q.
    pub fn x(&self) -> Vec<S> {
        [self.inputs(), self.p.clone()].concat()
    }

    /// (q, v, u), the inputs of forward dynamics, or (0, v, u).
    pub fn z(&self) -> Vec<S> {
        [self.inputs(), self.v.clone(), self.u.clone()].concat()
    }

    fn inputs(&self) -> Vec<S> {
        let n = self.v.len();
        if self.q.len() == n { self.q.clone() } else { filled(S::zero(), n) }
    }

    pub fn map<T>(&self, lift: impl Fn(S) -> T) -> State<T> {
        let all = |values: &[S]| values.iter().map(|&value| lift(value)).collect();
        let State { q, p, v, u, y } = self;
        State { q: all(q), p: all(p), v: all(v), u: all(u), y: all(y) }
    }
}
