//! What Newton's equations have for the ends of phases, before what is given there is taken out of them.

use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::numerics::chain::ChainMatrix;
use std::ops::Range;

/// The columns of K for the states of the nodes at the ends of phases, with the entries of other vectors
/// there.
#[derive(Clone, Debug)]
pub(crate) struct EndColumns {
    ends: Vec<EndColumn>,
    /// The gradient of the Lagrangian with the multipliers, exact at the start and at the end.
    pub gradient: Vec<f64>,
    /// Number of intervals.
    count: usize,
    /// Number of phases.
    phases: usize,
    /// Unknowns of a node and of an interval.
    node: usize,
    inner: usize,
}

/// Those of one end.
#[derive(Clone, Debug)]
struct EndColumn {
    /// The intervals beside it, with their nodes.
    matrix: ChainMatrix,
    intervals: Range<usize>,
    /// Its node among all.
    own: usize,
    /// K's columns for the times of all phases there, one after the other.
    border: Vec<f64>,
}

impl EndColumns {
    /// Room for n joints.
    pub fn new(n: usize, shape: Shape) -> Self {
        let (node, inner) = (shape.node() * n, shape.inner() * n);
        Self { ends: Vec::new(), gradient: Vec::new(), count: 0, phases: 0, node, inner }
    }

    /// Takes them from the equations.
    pub fn take(&mut self, matrix: &ChainMatrix, by_times: &[Vec<f64>], mesh: &Mesh) {
        (self.count, self.phases) = (mesh.intervals(), mesh.phases());
        let (node, inner) = (self.node, self.inner);
        self.ends.resize_with(mesh.ends().len(), || EndColumn {
            matrix: ChainMatrix::new(node, inner),
            intervals: 0..0,
            own: 0,
            border: Vec::new(),
        });
        for (end, &own) in self.ends.iter_mut().zip(mesh.ends()) {
            end.own = own;
            end.intervals = own.saturating_sub(1)..(own + 1).min(mesh.intervals());
            end.matrix.copy_intervals(matrix, end.intervals.clone());
            end.border.clear();
            end.border.extend(by_times.iter().flat_map(|column| &column[node * own..node * (own + 1)]));
        }
    }

    /// Where the unknowns that an end meets are among all: those of nodes, then the inner ones.
    fn places(&self, end: usize) -> impl Iterator<Item = usize> + use<> {
        let (near, node, inner) = (self.ends[end].intervals.clone(), self.node, self.inner);
        let first = node * (self.count + 1);
        (node * near.start..node * (near.end + 1)).chain(first + inner * near.start..first + inner * near.end)
    }

    /// Where its entry `i` is among those.
    fn own(&self, end: usize, i: usize) -> usize {
        let EndColumn { own, intervals, .. } = &self.ends[end];
        self.node * (own - intervals.start) + i
    }

    /// Begins the gradient of so many unknowns.
    pub fn reset(&mut self, size: usize, count: usize) {
        self.count = count;
        self.gradient.clear();
        self.gradient.resize(size, 0.0);
    }

    /// Entry `i` of the gradient at an end.
    pub fn gradient(&self, end: usize, i: usize) -> f64 {
        self.gradient[self.ends[end].own * self.node + i]
    }

    /// Entry `i` of an end in K's column for the time of a phase.
    pub fn by_time(&self, end: usize, phase: usize, i: usize) -> f64 {
        self.ends[end].border[self.node * phase + i]
    }

    /// `to += factor` times the column of entry `i` of the state at an end.
    pub fn add_column(&self, end: usize, i: usize, factor: f64, to: &mut [f64]) {
        let (matrix, own) = (&self.ends[end].matrix, self.own(end, i));
        for (row, place) in self.places(end).enumerate() {
            to[place] += factor * matrix.entry(row, own);
        }
    }

    /// Entry `i` at an end of what K makes of a step of the unknowns and of the times.
    pub fn product(&self, end: usize, i: usize, x: &[f64], times: &[f64]) -> f64 {
        let (matrix, own) = (&self.ends[end].matrix, self.own(end, i));
        let of_unknowns: f64 =
            self.places(end).enumerate().map(|(row, place)| matrix.entry(row, own) * x[place]).sum();
        let phases = (0..self.phases).map(|phase| self.by_time(end, phase, i) * times[phase]);
        of_unknowns + phases.sum::<f64>()
    }
}
