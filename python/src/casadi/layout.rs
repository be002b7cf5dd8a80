//! The functions that CasADi derives from a function f, with the names that it looks for:
//!
//! | function | arguments | results |
//! |---|---|---|
//! | `f` | those of f | those of f |
//! | `jac_f` | the same, `out_*` | a matrix for each result and argument |
//! | `adj1_f` | the same, `adj_*` | `adj_*` for each argument: y'f_z |
//! | `jac_adj1_f` | the same, `out_adj_*` | a matrix for each of these and each argument of `adj1_f` |
//!
//! Arguments `out_*` are results that CasADi could pass and that are not needed: they have no entries.
//! Matrices lie column by column.

use crate::cores::Order;
use crate::plan::{Piece, Plan, PlanBuilder};
use std::ffi::CString;

/// An argument or a result of f: a matrix, column by column.
#[derive(Clone, Copy, Debug)]
pub struct Variable {
    pub name: &'static str,
    pub rows: usize,
    pub columns: usize,
}

impl Variable {
    /// A vector.
    pub fn vector(name: &'static str, rows: usize) -> Self {
        Self { name, rows, columns: 1 }
    }

    fn entries(self) -> usize {
        self.rows * self.columns
    }
}

/// A matrix among the results of a core: entry (i, j) lies at `at + i * row + j * column`.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    pub at: usize,
    pub row: usize,
    pub column: usize,
}

impl Block {
    /// Moves its entries to a result, column by column.
    fn pieces(self, rows: usize, columns: usize) -> Vec<Piece> {
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
    pub inputs: Vec<Variable>,
    pub outputs: Vec<Variable>,
    /// Number of results of the core of each order.
    pub results: [usize; 3],
    /// Where the Jacobian begins: a row for each entry of the results, a column for each entry of the
    /// arguments.
    pub jacobian: usize,
    /// The blocks of the second derivatives of y'f by pairs of arguments; `None` where they vanish.
    pub hessian: Vec<Vec<Option<Block>>>,
}

/// An argument or result of one of the four functions.
#[derive(Debug)]
pub struct Port {
    pub name: CString,
    /// Rows and columns, then a one for a dense matrix, or zeros: the columns of one without entries begin.
    pub sparsity: Vec<i64>,
    /// Which argument or result of the plan it is, where it has entries.
    pub place: Option<usize>,
}

/// One of the four functions.
#[derive(Debug)]
pub struct Part {
    pub inputs: Vec<Port>,
    pub outputs: Vec<Port>,
    pub plan: Plan,
    pub order: Order,
}

/// Number of functions: f, its Jacobian, its adjoint, and the Jacobian of that.
pub const PARTS: usize = 4;

/// Takes the arguments and results of a function.
struct PartBuilder {
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    used: usize,
}

impl PartBuilder {
    fn input(&mut self, name: String, [rows, columns]: [usize; 2], used: bool) {
        let place = used.then_some(self.used);
        self.used += usize::from(used);
        self.inputs.push(port(name, [rows, columns], place));
    }

    /// A result; adds its pieces to the plan unless it has no entries.
    fn output(&mut self, plan: Plan, name: String, shape: [usize; 2], pieces: Option<Vec<Piece>>) -> Plan {
        self.outputs.push(port(name, shape, pieces.as_ref().map(|_| plan.outputs.len())));
        match pieces {
            Some(pieces) => plan.output(&shape, pieces),
            None => plan,
        }
    }
}

fn port(name: String, [rows, columns]: [usize; 2], place: Option<usize>) -> Port {
    let mut sparsity = vec![rows as i64, columns as i64];
    match place {
        Some(_) => sparsity.push(1),
        None => sparsity.resize(columns + 3, 0),
    }
    Port { name: CString::new(name).unwrap_or_default(), sparsity, place }
}

impl Description {
    /// The four functions.
    pub fn parts(&self) -> [Part; PARTS] {
        [self.value(), self.jacobian(), self.adjoint(), self.jacobian_of_adjoint()]
    }

    /// Begins a function: the arguments of f.
    fn begin(&self) -> (PartBuilder, PlanBuilder) {
        let passed = self.outputs.iter().map(|of| of.entries()).sum();
        let mut part = PartBuilder { inputs: Vec::new(), outputs: Vec::new(), used: 0 };
        let mut plan = PlanBuilder::new(passed);
        for of in &self.inputs {
            plan.core(of.name, of.entries());
            part.input(of.name.into(), [of.rows, of.columns], true);
        }
        (part, plan)
    }

    /// Adds the results of f, without entries, and their weights y; returns where y begins.
    fn weights(&self, part: &mut PartBuilder, plan: &mut PlanBuilder, for_core: bool) -> usize {
        self.spare_outputs(part);
        let mut first = None;
        for of in &self.outputs {
            part.input(format!("adj_{}", of.name), [of.rows, of.columns], true);
            let [at] = plan.split(of.name, [(of.entries(), for_core)]);
            first.get_or_insert(at);
        }
        first.unwrap_or_default()
    }

    fn spare_outputs(&self, part: &mut PartBuilder) {
        for of in &self.outputs {
            part.input(format!("out_{}", of.name), [of.rows, of.columns], false);
        }
    }

    fn results_of(&self, order: Order) -> usize {
        self.results[order as usize]
    }

    /// Variables with the number of entries before them.
    fn numbered(variables: &[Variable]) -> impl Iterator<Item = (usize, Variable)> {
        variables.iter().scan(0, |before, &of| {
            let at = *before;
            *before += of.entries();
            Some((at, of))
        })
    }

    /// The part of the Jacobian with the rows of one result and the columns of one argument.
    fn slope(&self, start: usize, result: usize, argument: usize) -> Block {
        let width = self.inputs.iter().map(|of| of.entries()).sum::<usize>();
        Block { at: start + self.jacobian + result * width + argument, row: width, column: 1 }
    }

    fn value(&self) -> Part {
        let (mut part, plan) = self.begin();
        let mut plan = plan.results(self.results_of(Order::Value));
        let start = plan.core_outputs.start;
        for (at, of) in Self::numbered(&self.outputs) {
            let pieces = vec![Piece::copy(0, start + at, of.entries())];
            plan = part.output(plan, of.name.into(), [of.rows, of.columns], Some(pieces));
        }
        part.finish(plan, Order::Value)
    }

    fn jacobian(&self) -> Part {
        let (mut part, plan) = self.begin();
        self.spare_outputs(&mut part);
        let mut plan = plan.results(self.results_of(Order::First));
        let start = plan.core_outputs.start;
        for (result, to) in Self::numbered(&self.outputs) {
            for (argument, by) in Self::numbered(&self.inputs) {
                let shape @ [rows, columns] = [to.entries(), by.entries()];
                let pieces = self.slope(start, result, argument).pieces(rows, columns);
                plan = part.output(plan, format!("jac_{}_{}", to.name, by.name), shape, Some(pieces));
            }
        }
        part.finish(plan, Order::First)
    }

    fn adjoint(&self) -> Part {
        let (mut part, mut plan) = self.begin();
        let y = self.weights(&mut part, &mut plan, false);
        let mut plan = plan.results(self.results_of(Order::First));
        let (start, length) = (plan.core_outputs.start, self.outputs.iter().map(|of| of.entries()).sum());
        for (argument, by) in Self::numbered(&self.inputs) {
            let Block { at, row, column } = self.slope(start, 0, argument);
            let product = |j| Piece::Product { to: j, a: (y, 1), b: (at + j * column, row), length };
            let pieces = (0..by.entries()).map(product).collect();
            plan = part.output(plan, format!("adj_{}", by.name), [by.rows, by.columns], Some(pieces));
        }
        part.finish(plan, Order::First)
    }

    fn jacobian_of_adjoint(&self) -> Part {
        let (mut part, mut plan) = self.begin();
        self.weights(&mut part, &mut plan, true);
        for of in &self.inputs {
            part.input(format!("out_adj_{}", of.name), [of.rows, of.columns], false);
        }
        let mut plan = plan.results(self.results_of(Order::Second));
        let start = plan.core_outputs.start;
        for ((argument, of), blocks) in Self::numbered(&self.inputs).zip(&self.hessian) {
            let rows = of.entries();
            for (by, block) in self.inputs.iter().zip(blocks) {
                let columns = by.entries();
                let block = block.map(|block| Block { at: start + block.at, ..block });
                let pieces = block.map(|block| block.pieces(rows, columns));
                let name = format!("jac_adj_{}_{}", of.name, by.name);
                plan = part.output(plan, name, [rows, columns], pieces);
            }
            for by in &self.outputs {
                let name = format!("jac_adj_{}_out_{}", of.name, by.name);
                plan = part.output(plan, name, [rows, by.entries()], None);
            }
            for (result, by) in Self::numbered(&self.outputs) {
                let columns = by.entries();
                let pieces = self.slope(start, result, argument).transposed().pieces(rows, columns);
                let name = format!("jac_adj_{}_adj_{}", of.name, by.name);
                plan = part.output(plan, name, [rows, columns], Some(pieces));
            }
        }
        part.finish(plan, Order::Second)
    }
}

impl PartBuilder {
    fn finish(self, plan: Plan, order: Order) -> Part {
        Part { inputs: self.inputs, outputs: self.outputs, plan, order }
    }
}
