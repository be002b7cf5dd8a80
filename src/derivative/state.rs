//! Where methods are compared.

/// A state in both sets of coordinates, actuation u, and costate y (2n).
#[derive(Clone, Debug)]
pub(super) struct State<S> {
    /// (q, p).
    pub x: Vec<S>,
    pub v: Vec<S>,
    pub u: Vec<S>,
    pub y: Vec<S>,
}

impl<S: Copy> State<S> {
    /// (q, v, u), the inputs of forward dynamics.
    pub fn z(&self) -> Vec<S> {
        let q = &self.x[..self.v.len()];
        [q, &self.v, &self.u].concat()
    }

    pub fn map<T>(&self, lift: impl Fn(S) -> T) -> State<T> {
        let all = |values: &[S]| values.iter().map(|&value| lift(value)).collect();
        State { x: all(&self.x), v: all(&self.v), u: all(&self.u), y: all(&self.y) }
    }
}
