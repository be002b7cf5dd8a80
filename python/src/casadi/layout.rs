//! How the five functions that CasADi asks for of a function f are made of the results of its cores.

use crate::cores::Order;
use crate::plan::{Piece, Plan, PlanBuilder};
use costate::codegen::{ExternalPorts, Interface, Variable};
use std::ffi::CString;
use std::ops::Range;

/// A matrix among the results of a core: entry (i, j) lies at `at + i * row + j * column`.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    pub at: usize,
    pub row: usize,
    pub column: usize,
}

impl Block {
    /// Moves its entries to a result, column by column.
    fn pieces(self, [rows, columns]: [usize; 2]) -> Vec<Piece> {
        let Self { at, row, column } = self;
        (0..columns)
            .map(|j| Piece::Move { to: (j * rows, 1), from: (at + j * column, row), length: rows })
            .collect()
    }

    fn transposed(self) -> Self {
        Self { at: self.at, row: self.column, column: self.row }
    }
}

/// A function f and where its core puts its derivatives. A core of order `Value` or `First` has the
/// arguments of f, one of order `Second` the weights y of all results of f too. Results begin with those
/// of f.
#[derive(Debug)]
pub struct Description {
    interface: Interface,
    /// Number of results of the core of each order.
    results: [usize; 3],
    /// Where the Jacobian begins: a row for each entry of the results, a column for each entry of the
    /// arguments.
    jacobian: usize,
    /// The blocks of the second derivatives of y'f by pairs of arguments; `None` where they vanish.
    hessian: Vec<Vec<Option<Block>>>,
}

/// An argument or result of one of the five functions.
#[derive(Debug)]
pub struct Port {
    pub name: CString,
    pub sparsity: Vec<i64>,
    /// Whether it has entries; then it is an argument or a result of the plan too.
    pub full: bool,
}

/// One of the five functions.
#[derive(Debug)]
pub struct Part {
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    pub plan: Plan,
    pub order: Order,
    /// Of the function with all second derivatives alone.
    pub rows: Option<Rows>,
}

/// The second derivatives of all entries of the results of f: one evaluation of the core for each entry,
/// which has the weight 1, all others 0. The evaluation gives a row of each matrix of `jac_f`, that is every
/// m-th number of a column of `jac_jac_f`, for a result with m entries.
#[derive(Debug)]
pub struct Rows {
    /// Where the weights are.
    pub y: Range<usize>,
    /// The number of entries of each result of f.
    pub entries: Vec<usize>,
}

/// Number of functions: f, its Jacobian, its adjoint, the Jacobian of that, and of the Jacobian.
pub const PARTS: usize = 5;

/// Where the results of a core begin in the buffer of a plan, and the weights.
#[derive(Clone, Copy)]
struct Places {
    results: usize,
    y: usize,
}

/// Number of entries before a variable.
fn before(variables: &[Variable], k: usize) -> usize {
    variables[..k].iter().map(|of| of.entries()).sum()
}

fn ports(of: &[costate::codegen::Port]) -> Vec<Port> {
    let port = |of: &costate::codegen::Port| Port {
        name: CString::new(of.name.as_str()).unwrap_or_default(),
        sparsity: of.sparsity().into_iter().map(|number| number as i64).collect(),
        full: of.full,
    };
    of.iter().map(port).collect()
}

impl Description {
    pub fn new(
        inputs: Vec<Variable>,
        outputs: Vec<Variable>,
        results: [usize; 3],
        jacobian: usize,
        hessian: Vec<Vec<Option<Block>>>,
    ) -> Self {
        let curved = hessian.iter().map(|row| row.iter().map(Option::is_some).collect()).collect();
        Self { interface: Interface { inputs, outputs, curved }, results, jacobian, hessian }
    }

    /// The five functions.
    pub fn parts(&self) -> [Part; PARTS] {
        let Interface { inputs, outputs, .. } = &self.interface;
        let [value, jacobian, adjoint, second] = self.interface.functions();
        [
            self.part(value, Order::Value, None, |at, k| {
                vec![Piece::copy(0, at.results + before(outputs, k), outputs[k].entries())]
            }),
            self.part(jacobian, Order::First, None, |at, k| {
                let (of, by) = (k / inputs.len(), k % inputs.len());
                self.slope(at, of, by).pieces([outputs[of].entries(), inputs[by].entries()])
            }),
            self.part(adjoint, Order::First, Some(false), |at, k| self.products(at, k)),
            self.part(second, Order::Second, Some(true), |at, k| self.curvature(at, k)),
            self.tensor(self.interface.jacobian_of_jacobian()),
        ]
    }

    /// All second derivatives, see [`Rows`]: its plan has the pieces of one entry, where those of the first
    /// are.
    fn tensor(&self, of: ExternalPorts) -> Part {
        let Interface { inputs, outputs, .. } = &self.interface;
        let mut plan = PlanBuilder::new(0);
        for of in inputs {
            plan.core(of.name, of.entries());
        }
        let weights = before(outputs, outputs.len());
        let y = plan.core("y", weights);
        let mut plan = plan.results(self.results[Order::Second as usize]);
        let width = inputs.len() + outputs.len();
        for (k, port) in of.outputs.iter().enumerate().filter(|(_, port)| port.full) {
            let (result, argument, by) = (k / width / inputs.len(), k / width % inputs.len(), k % width);
            let (step, rows) = (outputs[result].entries(), inputs[argument].entries());
            let pieces = self.hessian[argument][by].map_or(Vec::new(), |Block { at, row, column }| {
                let at = plan.core_outputs.start + at;
                let piece =
                    |j| Piece::Move { to: (j * port.rows, step), from: (at + j * column, row), length: rows };
                (0..port.columns).map(piece).collect()
            });
            plan = plan.output(&[rows, port.columns], pieces);
        }
        let rows = Rows { y: y..y + weights, entries: outputs.iter().map(|of| of.entries()).collect() };
        let (inputs, outputs) = (ports(&of.inputs), ports(&of.outputs));
        Part { inputs, outputs, plan, order: Order::Second, rows: Some(rows) }
    }

    /// A function of this order whose k-th result is made of these pieces; its weights are for the core, or
    /// not, or there are none.
    fn part(
        &self,
        of: ExternalPorts,
        order: Order,
        weights: Option<bool>,
        pieces: impl Fn(Places, usize) -> Vec<Piece>,
    ) -> Part {
        let Interface { inputs, outputs, .. } = &self.interface;
        let mut plan = PlanBuilder::new(before(outputs, outputs.len()));
        for of in inputs {
            plan.core(of.name, of.entries());
        }
        let mut y = None;
        for (of, for_core) in outputs.iter().flat_map(|of| weights.map(|for_core| (of, for_core))) {
            let [at] = plan.split(of.name, [(of.entries(), for_core)]);
            y.get_or_insert(at);
        }
        let mut plan = plan.results(self.results[order as usize]);
        let places = Places { results: plan.core_outputs.start, y: y.unwrap_or_default() };
        for (k, port) in of.outputs.iter().enumerate().filter(|(_, port)| port.full) {
            plan = plan.output(&[port.rows, port.columns], pieces(places, k));
        }
        Part { inputs: ports(&of.inputs), outputs: ports(&of.outputs), plan, order, rows: None }
    }

    /// The part of the Jacobian with the rows of one result and the columns of one argument.
    fn slope(&self, at: Places, result: usize, argument: usize) -> Block {
        let Interface { inputs, outputs, .. } = &self.interface;
        let width = before(inputs, inputs.len());
        let place = before(outputs, result) * width + before(inputs, argument);
        Block { at: at.results + self.jacobian + place, row: width, column: 1 }
    }

    /// y'f_z for one argument.
    fn products(&self, at: Places, argument: usize) -> Vec<Piece> {
        let Interface { inputs, outputs, .. } = &self.interface;
        let Block { at: first, row, column } = self.slope(at, 0, argument);
        let length = before(outputs, outputs.len());
        let product = |j| Piece::Product { to: j, a: (at.y, 1), b: (first + j * column, row), length };
        (0..inputs[argument].entries()).map(product).collect()
    }

    /// A result of the Jacobian of the adjoint: for each argument the second derivatives in each argument,
    /// then those in `out_*`, which have no entries, then f_z transposed.
    fn curvature(&self, at: Places, k: usize) -> Vec<Piece> {
        let Interface { inputs, outputs, .. } = &self.interface;
        let width = inputs.len() + 2 * outputs.len();
        let (of, by) = (k / width, k % width);
        let rows = inputs[of].entries();
        match by.checked_sub(inputs.len() + outputs.len()) {
            Some(result) => self.slope(at, result, of).transposed().pieces([rows, outputs[result].entries()]),
            None => {
                let block = self.hessian[of][by].map(|block| Block { at: at.results + block.at, ..block });
                block.map_or(Vec::new(), |block| block.pieces([rows, inputs[by].entries()]))
            }
        }
    }
}
