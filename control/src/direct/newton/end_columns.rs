//! What Newton's equations have for the given ends, before these are taken out of them.

use crate::direct::motion::shape::Shape;
use crate::numerics::chain::ChainMatrix;

/// The columns of K for the states of both end nodes, with the entries of other vectors there.
#[derive(Clone, Debug)]
pub(crate) struct EndColumns {
    /// The first and the last interval with its nodes.
    intervals: [ChainMatrix; 2],
    /// K's column for the times of the first and of the last phase at the start and at the end.
    pub border: [Vec<f64>; 2],
    /// The gradient of the Lagrangian with the multipliers, exact at both ends.
    pub gradient: Vec<f64>,
    /// Number of intervals.
    count: usize,
    /// Unknowns of a node and of an interval.
    node: usize,
    inner: usize,
}

impl EndColumns {
    /// Room for n joints.
    pub fn new(n: usize, shape: Shape) -> Self {
        let (node, inner) = (shape.node() * n, shape.inner() * n);
        let matrix = || ChainMatrix::new(node, inner);
        Self {
            intervals: [matrix(), matrix()],
            border: Default::default(),
            gradient: Vec::new(),
            count: 0,
            node,
            inner,
        }
    }

    /// Takes them from the equations.
    pub fn take(&mut self, matrix: &ChainMatrix, by_times: &[Vec<f64>], count: usize) {
        self.count = count;
        let columns = [by_times.first(), by_times.last()];
        for (end, interval) in self.intervals.iter_mut().enumerate() {
            let last = end * (count - 1);
            interval.copy_interval(matrix, last);
            let state = end * count * self.node..(end * count + 1) * self.node;
            self.border[end].clear();
            self.border[end].extend(columns[end].into_iter().flat_map(|column| &column[state.clone()]));
        }
    }

    /// Where the unknowns of the interval of an end are among all: those of two nodes, then the inner ones.
    fn places(&self, end: usize) -> impl Iterator<Item = usize> + use<> {
        let (k, node, inner) = (end * (self.count - 1), self.node, self.inner);
        let first = node * (self.count + 1) + inner * k;
        (node * k..node * (k + 2)).chain(first..first + inner)
    }

    /// Begins the gradient of so many unknowns.
    pub fn reset(&mut self, size: usize, count: usize) {
        self.count = count;
        self.gradient.clear();
        self.gradient.resize(size, 0.0);
    }

    /// Entry `i` of the gradient at an end.
    pub fn gradient(&self, end: usize, i: usize) -> f64 {
        self.gradient[end * self.count * self.node + i]
    }

    /// `to += factor` times the column of entry `i` of the state at an end.
    pub fn add_column(&self, end: usize, i: usize, factor: f64, to: &mut [f64]) {
        let matrix = &self.intervals[end];
        for (row, place) in self.places(end).enumerate() {
            to[place] += factor * matrix.entry(row, end * self.node + i);
        }
    }

    /// Entry `i` of K x at an end.
    pub fn product(&self, end: usize, i: usize, x: &[f64]) -> f64 {
        let matrix = &self.intervals[end];
        let places = self.places(end).enumerate();
        places.map(|(row, place)| matrix.entry(row, end * self.node + i) * x[place]).sum()
    }
}
