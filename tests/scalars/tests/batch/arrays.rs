//! Node-major arrays of a model, from a batch and from single evaluations.

use costate::batch::{Batch, Failure, FirstOrderArrays, Model, ModelQuantity, Packed, SecondOrderArrays};
use costate::derivative::largest;
use costate::dynamics::Dynamics;
use costate::matrix::Block;
use costate::robot::{Robot, file};
use costate::scalar::{Count, Scalar};
use costate_test_support::rounding::{apart, bound, lift, of_inverse, size};

/// Node-major arrays of a model: what is read and what was written.
#[derive(Clone, Debug, Default)]
pub struct Arrays {
    pub x: Vec<f64>,
    pub u: Vec<f64>,
    pub y: Vec<f64>,
    /// f, f_x, f_u, xx, ux, uu.
    pub results: [Vec<f64>; 6],
    /// y'f_x, y'f_u.
    pub adjoint: [Vec<f64>; 2],
}

impl Arrays {
    /// States that differ from node to node.
    pub fn new(states: usize, controls: usize, nodes: usize) -> Self {
        let fill = |length: usize, phase: f64| {
            (0..nodes * length).map(|i| 0.9 * (1.7 * i as f64 + phase).sin()).collect::<Vec<_>>()
        };
        Self { x: fill(states, 0.1), u: fill(controls, 0.5), y: fill(states, 0.8), ..Self::default() }
    }

    pub fn nodes(&self, states: usize) -> usize {
        self.x.len() / states
    }

    /// Everything that a batch computes of a model.
    pub fn evaluate<S, D>(&mut self, batch: &mut Batch<S, Model<D>>) -> Vec<Failure<D::Error>>
    where
        S: Packed<Lane = f64>,
        D: Dynamics<S, Error: Send + Clone> + Send,
    {
        let layout = batch.layout(ModelQuantity::Contraction).unwrap().clone();
        let nodes = self.nodes(layout.inputs[0].length);
        for (result, argument) in self.results.iter_mut().zip(&layout.outputs) {
            *result = vec![7.0; nodes * argument.length];
        }
        self.adjoint = [vec![7.0; self.x.len()], vec![7.0; self.u.len()]];
        let [f, f_x, f_u, xx, ux, uu] = &mut self.results;
        let [y_f_x, y_f_u] = &mut self.adjoint;
        batch.adjoint([&self.x, &self.u, &self.y], [y_f_x, y_f_u]).unwrap();
        let first = FirstOrderArrays { f, f_x, f_u };
        let second = SecondOrderArrays { xx, ux, uu };
        batch.contract([&self.x, &self.u, &self.y], first, second).unwrap().to_vec()
    }
}

/// What one node has in the arrays of results.
pub type NodeResults<S = f64> = ([Vec<S>; 6], [Vec<S>; 2]);

/// The same from single evaluations; columns and blocks that do not exist are zero.
pub fn one_by_one<S: Scalar, D: Dynamics<S>>(model: &mut D, arrays: &Arrays) -> Vec<NodeResults<S>> {
    let (n, m) = (model.states(), model.controls());
    let flat = |block: Block<'_, S>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
    let [all_x, all_u, all_y] = [&arrays.x, &arrays.u, &arrays.y].map(|values| lift::<S>(values));
    let mut evaluate = |k: usize| {
        let (x, u, y) = (&all_x[k * n..][..n], &all_u[k * m..][..m], &all_y[k * n..][..n]);
        let mut adjoint = [vec![S::zero(); n], vec![S::zero(); m]];
        let [y_f_x, y_f_u] = &mut adjoint;
        model.adjoint(x, u, y, y_f_x, y_f_u).unwrap();
        let second = model.contract(x, u, y).unwrap();
        let (mut ux, mut uu) = (vec![S::zero(); m * n], vec![S::zero(); m * m]);
        for (row, found) in ux.chunks_mut(n).zip(second.ux.iter().flat_map(Block::iter_rows)) {
            row[..found.len()].copy_from_slice(found);
        }
        for (row, found) in uu.chunks_mut(m).zip(second.uu.iter().flat_map(Block::iter_rows)) {
            row.copy_from_slice(found);
        }
        let first = second.first;
        ([first.f.to_vec(), flat(first.f_x), flat(first.f_u), flat(second.xx), ux, uu], adjoint)
    };
    (0..arrays.nodes(n)).map(&mut evaluate).collect()
}

/// Twice the bounds of the rounding errors of each result of each node, from single evaluations.
///
/// Several lanes may take another way through a tree: what is zero along one is a difference of products with
/// M^-1 along the other. They are of the size of the results, as in `rounding::Bounds`.
pub fn bounds<D: Dynamics<Count>>(robot: &Robot, model: &mut D, arrays: &Arrays) -> Vec<[f64; 8]> {
    let all = one_by_one(model, arrays);
    let states = arrays.x.chunks(arrays.x.len() / all.len());
    let of_node = |((results, adjoint), x): (&NodeResults<Count>, &[f64])| {
        let relative = of_inverse(robot, &x[..robot.nq()]);
        let of = |block: &Vec<Count>| 2.0 * bound(block) + relative * size(block).max(1.0);
        let mut all = results.iter().chain(adjoint);
        std::array::from_fn(|_| all.next().map_or(0.0, of))
    };
    all.iter().zip(states).map(of_node).collect()
}

/// Entries of node `k` in a node-major array of so many nodes.
pub fn node(array: &[f64], k: usize, nodes: usize) -> &[f64] {
    let length = array.len() / nodes;
    &array[k * length..(k + 1) * length]
}

/// Every result of every node against single evaluations, by this part of its largest entry.
pub fn agree<D: Dynamics<f64>>(model: &mut D, arrays: &Arrays, allowed: f64) {
    let expected = one_by_one(model, arrays);
    let of_node = |(results, adjoint): &NodeResults| {
        let mut all = results.iter().chain(adjoint);
        std::array::from_fn(|_| all.next().map_or(0.0, |block| allowed * largest(block)))
    };
    let allowed: Vec<[f64; 8]> = expected.iter().map(of_node).collect();
    let found = differing(&expected, arrays, &allowed);
    assert!(found.is_none(), "{}", found.unwrap());
}

/// The first result that differs by more than is allowed at its node.
pub fn differing(expected: &[NodeResults], arrays: &Arrays, allowed: &[[f64; 8]]) -> Option<String> {
    let nodes = expected.len();
    let of_node = |(k, (results, adjoint)): (usize, &NodeResults)| {
        let found = arrays.results.iter().chain(&arrays.adjoint);
        found.zip(results.iter().chain(adjoint)).enumerate().find_map(|(which, (found, expected))| {
            let (off, allowed) = (largest(&apart(node(found, k, nodes), expected)), allowed[k][which]);
            (off.is_nan() || off > allowed)
                .then(|| format!("result {which} of node {k} of {nodes}: {off:e}, {allowed:e} allowed"))
        })
    };
    expected.iter().enumerate().find_map(of_node)
}

pub fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/../../robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Three turning axes in one point; no inverse of M where the second is at a right angle.
pub fn gimbal() -> Robot {
    let text = "name = 'gimbal'\n\
        [[joint]]\nname = 'z'\naxis = [0.0, 0.0, 1.0]\n\
        [[joint]]\nname = 'y'\naxis = [0.0, 1.0, 0.0]\n\
        [[joint]]\nname = 'x'\naxis = [1.0, 0.0, 0.0]\nmass = 1.0\ninertia = { xx = 0.2, yy = 0.3, zz = 0.4 }\n";
    file::parse(text, Default::default()).unwrap()
}
