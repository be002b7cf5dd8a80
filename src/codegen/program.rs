//! A recorded computation, ready to be evaluated, written down or compiled.

use super::error::CodegenError;
use super::expr::Expr;
use super::lower::{Graph, lower};
use super::node::{Id, Node};
use super::order;
use super::recording::record;
use super::text::check_names;
use crate::error::check_length;
use crate::scalar::{Operations, Scalar};
use std::collections::HashSet;

/// One argument of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Argument {
    /// Its name, an identifier.
    pub name: String,
    /// Number of its entries.
    pub entries: usize,
    /// What it is, with units; one line, may be empty.
    pub meaning: String,
}

/// One result of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// Its name, an identifier.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The nodes that hold its entries, row by row.
    pub entries: Vec<Id>,
    /// What it is, with units; one line, may be empty.
    pub meaning: String,
}

/// A computation as a list of steps on numbers, without branch or loop: results from arguments.
///
/// ```
/// use costate::codegen::Program;
/// use costate::scalar::Scalar;
///
/// let program = Program::record("polar", &[("z", 2)], |arguments| {
///     let (sin, cos) = arguments[0][1].sin_cos();
///     let radius = arguments[0][0];
///     vec![("x".into(), 2, 1, vec![radius * cos, radius * sin])]
/// })?;
/// let mut x = [0.0; 2];
/// program.evaluate(&[2.0, 0.3], &mut x, &mut Vec::new())?;
/// assert_eq!(x, [2.0 * 0.3_f64.cos(), 2.0 * 0.3_f64.sin()]);
/// # Ok::<(), costate::codegen::CodegenError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    name: String,
    notes: Vec<String>,
    arguments: Vec<Argument>,
    nodes: Vec<Node>,
    results: Vec<Outcome>,
}

/// A result as a recorded function returns it: name, rows, columns and entries, row by row.
pub type RecordedResult = (String, usize, usize, Vec<Expr>);

impl Program {
    /// Records a function: arguments by name and number of entries, results as it returns them.
    ///
    /// # Errors
    /// [`CodegenError::Foreign`] and [`CodegenError::Branch`] for a function that cannot be recorded,
    /// [`CodegenError::Shape`] and [`CodegenError::Name`] for results that are not as they should be.
    pub fn record(
        name: &str,
        arguments: &[(&str, usize)],
        function: impl FnOnce(&[Vec<Expr>]) -> Vec<RecordedResult>,
    ) -> Result<Self, CodegenError> {
        Self::try_record(name, arguments, |expressions| Ok(function(expressions)))
    }

    /// As [`record`](Self::record), for a function that may fail.
    ///
    /// # Errors
    /// That of the function, and those of [`record`](Self::record).
    pub fn try_record(
        name: &str,
        arguments: &[(&str, usize)],
        function: impl FnOnce(&[Vec<Expr>]) -> Result<Vec<RecordedResult>, CodegenError>,
    ) -> Result<Self, CodegenError> {
        let inputs = arguments.iter().map(|(_, entries)| entries).sum();
        let (outcome, (nodes, entries)) = record(inputs, |expressions| {
            let mut rest = expressions;
            let mut split = Vec::new();
            for &(_, entries) in arguments {
                let (argument, more) = rest.split_at(entries);
                split.push(argument.to_vec());
                rest = more;
            }
            match function(&split) {
                Ok(results) => {
                    let entries = results.iter().flat_map(|(.., entries)| entries.iter().copied()).collect();
                    (Ok(results), entries)
                }
                Err(error) => (Err(error), Vec::new()),
            }
        })?;
        let results = outcome?;
        let Graph { nodes, results: ids } = order::few_waiting(&lower(nodes, &entries));
        let mut ids = ids.into_iter();
        let outcomes = results.into_iter().map(|(name, rows, columns, entries)| {
            let found = entries.len();
            if found != rows * columns {
                return Err(CodegenError::Shape { name, rows, columns, found });
            }
            let entries = ids.by_ref().take(found).collect();
            Ok(Outcome { name, rows, columns, entries, meaning: String::new() })
        });
        let results: Vec<Outcome> = outcomes.collect::<Result<_, _>>()?;
        let argument = |&(name, entries): &(&str, usize)| {
            let (name, meaning) = (String::from(name), String::new());
            Argument { name, entries, meaning }
        };
        let arguments: Vec<Argument> = arguments.iter().map(argument).collect();
        let names = arguments.iter().map(|argument| &argument.name);
        check_names(name, names.chain(results.iter().map(|result| &result.name)))?;
        Ok(Self { name: name.into(), notes: Vec::new(), arguments, nodes, results })
    }

    /// Its name, an identifier.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Lines about it for the head of generated code.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The same program with these lines about it.
    #[must_use]
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// The same program, with the meaning of arguments and results of these names.
    #[must_use]
    pub fn with_meanings(mut self, meanings: &[(&str, &str)]) -> Self {
        for &(name, text) in meanings {
            let arguments = self.arguments.iter_mut().map(|argument| (&argument.name, &mut argument.meaning));
            let results = self.results.iter_mut().map(|result| (&result.name, &mut result.meaning));
            for (_, meaning) in arguments.chain(results).filter(|(of, _)| *of == name) {
                *meaning = text.into();
            }
        }
        self
    }

    /// Its arguments.
    pub fn arguments(&self) -> &[Argument] {
        &self.arguments
    }

    /// Its steps, each after those that it uses; [`Node::Input`] counts through the entries of all arguments.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Its results.
    pub fn results(&self) -> &[Outcome] {
        &self.results
    }

    /// Number of entries of all arguments.
    pub fn inputs(&self) -> usize {
        self.arguments.iter().map(|argument| argument.entries).sum()
    }

    /// Number of entries of all results.
    pub fn outputs(&self) -> usize {
        self.results.iter().map(|result| result.entries.len()).sum()
    }

    /// Number of steps, constants and inputs left out: what code that is generated from it is as long as.
    pub fn steps(&self) -> usize {
        self.nodes.iter().filter(|node| !node.is_leaf()).count()
    }

    /// Operations of one evaluation, each product once; one that is joined with a sum is a product and a sum.
    pub fn operations(&self) -> Operations {
        let mut o = Operations::default();
        let mut joined = HashSet::new();
        let mut angles = vec![false; self.nodes.len()];
        for node in &self.nodes {
            match *node {
                Node::Constant(_) | Node::Input(_) | Node::Neg(_) | Node::Select(..) => {}
                Node::Add(..) | Node::Sub(..) => o.add += 1,
                Node::Mul(..) => o.mul += 1,
                Node::MulAdd(a, b, _) | Node::MulSub(a, b, _) | Node::NegMulAdd(a, b, _) => {
                    o.mul += u64::from(joined.insert((a, b)));
                    o.add += 1;
                }
                Node::Div(..) => o.div += 1,
                Node::Sqrt(_) => o.sqrt += 1,
                Node::Sin(a) | Node::Cos(a) => angles[a.index()] = true,
                Node::Exp(_) | Node::ExpM1(_) => o.exp += 1,
                Node::Less(..) => o.less += 1,
            }
        }
        o.sincos = angles.iter().filter(|angle| **angle).count() as u64;
        o
    }

    /// Evaluates it step by step: all arguments one after the other, all results likewise, each row by row.
    ///
    /// Slow beside generated code, and its judge. `work` is resized to the number of nodes; nothing else is allocated.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`](crate::EvalError::WrongLength), as [`CodegenError::Eval`].
    pub fn evaluate<S: Scalar>(
        &self,
        inputs: &[S],
        outputs: &mut [S],
        work: &mut Vec<S>,
    ) -> Result<(), CodegenError> {
        check_length("inputs", inputs, self.inputs())?;
        check_length("outputs", outputs, self.outputs())?;
        work.clear();
        for node in &self.nodes {
            let value = self.step(*node, inputs, work);
            work.push(value);
        }
        let entries = self.results.iter().flat_map(|result| &result.entries);
        outputs.iter_mut().zip(entries).for_each(|(output, id)| *output = work[id.index()]);
        Ok(())
    }

    /// The value of one step.
    fn step<S: Scalar>(&self, node: Node, inputs: &[S], work: &[S]) -> S {
        let of = |id: Id| work[id.index()];
        match node {
            Node::Constant(value) => S::from_f64(value),
            Node::Input(k) => inputs[k as usize],
            Node::Neg(a) => -of(a),
            Node::Add(a, b) => of(a) + of(b),
            Node::Sub(a, b) => of(a) - of(b),
            Node::Mul(a, b) => of(a) * of(b),
            Node::Div(a, b) => of(a) / of(b),
            Node::MulAdd(a, b, c) => of(a).mul_add(of(b), of(c)),
            Node::MulSub(a, b, c) => of(a).mul_add(of(b), -of(c)),
            Node::NegMulAdd(a, b, c) => (-of(a)).mul_add(of(b), of(c)),
            Node::Sqrt(a) => of(a).sqrt(),
            Node::Sin(a) => of(a).sin_cos().0,
            Node::Cos(a) => of(a).sin_cos().1,
            Node::Exp(a) => of(a).exp(),
            Node::ExpM1(a) => of(a).exp_m1(),
            // Its truth value is found where it is used.
            Node::Less(..) => S::zero(),
            Node::Select(mask, a, b) => match self.nodes[mask.index()] {
                Node::Less(x, y) => S::select(of(x).less(of(y)), of(a), of(b)),
                _ => of(b),
            },
        }
    }
}
