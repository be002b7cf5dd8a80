//! A recorded computation, ready to be evaluated, written as source text, or compiled.

use super::error::CodegenError;
use super::names::check_names;
use super::program_ends::{ProgramArgument, ProgramResult, RecordedResult, shaped, split};
use super::record::{Expr, Node, RecordingLimit, record};
use super::simplify::{Graph, simplify};
use crate::scalar::Operations;
use std::collections::HashSet;

/// A computation as a list of steps on numbers, without branches or loops: results from arguments.
///
/// ```
/// use costate::codegen::{Program, RecordedResult};
/// use costate::scalar::Scalar;
///
/// let program = Program::record("polar", &[("z", 2)], |arguments| {
///     let (sin, cos) = arguments[0][1].sin_cos();
///     let radius = arguments[0][0];
///     vec![RecordedResult::vector("x", vec![radius * cos, radius * sin])]
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
    arguments: Vec<ProgramArgument>,
    nodes: Vec<Node>,
    results: Vec<ProgramResult>,
    symmetry: Vec<u32>,
    column_major: bool,
}

/// A function that is recorded.
type Recorder<'a> = Box<dyn FnOnce(&[Vec<Expr>]) -> Result<Vec<RecordedResult>, CodegenError> + 'a>;

impl Program {
    /// Records a function: arguments by name and number of entries, results as it returns them.
    ///
    /// # Errors
    /// [`CodegenError::Foreign`] and [`CodegenError::Branch`] for a function that cannot be recorded,
    /// [`CodegenError::Shape`] and [`CodegenError::Name`] for results with a wrong number of entries or an
    /// unusable name.
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
    /// Those of the function and of [`record`](Self::record).
    pub fn try_record(
        name: &str,
        arguments: &[(&str, usize)],
        function: impl FnOnce(&[Vec<Expr>]) -> Result<Vec<RecordedResult>, CodegenError>,
    ) -> Result<Self, CodegenError> {
        Self::try_record_within(name, arguments, usize::MAX, function)
    }

    /// As [`try_record`](Self::try_record), for a program of at most `limit` steps.
    ///
    /// The recording stops after [`OPERATIONS_PER_STEP`](crate::codegen::OPERATIONS_PER_STEP) operations for
    /// each step of the limit, so its memory is bounded. The function then runs to its end without recording.
    ///
    /// # Errors
    /// Those of [`try_record`](Self::try_record); [`CodegenError::LongRecording`] where the recording was
    /// stopped,
    /// [`CodegenError::TooLarge`] where the program is longer than the limit.
    pub fn try_record_within(
        name: &str,
        arguments: &[(&str, usize)],
        limit: usize,
        function: impl FnOnce(&[Vec<Expr>]) -> Result<Vec<RecordedResult>, CodegenError>,
    ) -> Result<Self, CodegenError> {
        Self::recorded(name, arguments, limit, Box::new(function))
    }

    /// The same, compiled once for all functions.
    fn recorded(
        name: &str,
        arguments: &[(&str, usize)],
        limit: usize,
        function: Recorder<'_>,
    ) -> Result<Self, CodegenError> {
        let inputs = arguments.iter().map(|(_, entries)| entries).sum();
        let limited = RecordingLimit { name, steps: limit };
        let (outcome, (nodes, entries)) =
            record(inputs, limited, |expressions| match function(&split(expressions, arguments)) {
                Ok(results) => {
                    let entries = results.iter().flat_map(|result| result.entries.iter().copied()).collect();
                    (Ok(results), entries)
                }
                Err(error) => (Err(error), Vec::new()),
            })?;
        let results = outcome?;
        let Graph { nodes, results: ids } = simplify(&nodes, &entries);
        let program = Self {
            name: name.into(),
            notes: Vec::new(),
            arguments: arguments.iter().map(|&(name, entries)| ProgramArgument::new(name, entries)).collect(),
            nodes,
            results: shaped(results, ids)?,
            symmetry: Vec::new(),
            column_major: false,
        };
        let names = program.arguments.iter().map(|argument| &argument.name);
        check_names(name, names.chain(program.results.iter().map(|result| &result.name)))?;
        program.check_limit(limit)?;
        Ok(program)
    }

    /// Refuses a program of more steps than the limit.
    pub(super) fn check_limit(&self, limit: usize) -> Result<(), CodegenError> {
        let steps = self.steps();
        if steps <= limit {
            return Ok(());
        }
        Err(CodegenError::TooLarge { name: self.name.clone(), steps, limit })
    }

    /// Its name, an identifier.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether matrices among its results lie column by column.
    pub fn is_column_major(&self) -> bool {
        self.column_major
    }

    /// The same program with matrices among its results column by column, as Fortran, Eigen and MATLAB keep
    /// them.
    #[must_use]
    pub fn column_major(mut self) -> Self {
        if !self.column_major {
            for result in &mut self.results {
                let (rows, columns) = (result.rows, result.columns);
                let places = (0..columns).flat_map(|j| (0..rows).map(move |i| i * columns + j));
                result.entries = places.map(|place| result.entries[place]).collect();
            }
        }
        Self { column_major: true, ..self }
    }

    /// Lines about it that the head of generated code begins with.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The same program with these lines about it.
    #[must_use]
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// For each entry of all arguments the one in its place when equal branches of a robot exchange their
    /// roles, as left and right arm; empty where nothing is known.
    ///
    /// It tells a compiler which steps may be alike, and promises nothing: the numbers of the branches may
    /// differ.
    pub fn symmetry(&self) -> &[u32] {
        &self.symmetry
    }

    /// The same program with this symmetry of n joints, in every argument; all are multiples of n numbers.
    #[must_use]
    pub(super) fn with_symmetry(mut self, images: &[usize]) -> Self {
        let n = images.len();
        if n > 0 && self.arguments.iter().all(|argument| argument.entries % n == 0) {
            let image = |k: usize| (k / n * n + images[k % n]) as u32;
            self.symmetry = (0..self.inputs()).map(image).collect();
        }
        self
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
    pub fn arguments(&self) -> &[ProgramArgument] {
        &self.arguments
    }

    /// Its steps, each after those that it uses; [`Node::Input`] counts through the entries of all arguments.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Its results.
    pub fn results(&self) -> &[ProgramResult] {
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

    /// Number of steps without constants and inputs: the length of generated code is in proportion.
    pub fn steps(&self) -> usize {
        self.nodes.iter().filter(|node| !node.is_leaf()).count()
    }

    /// Operations of one evaluation, each product once; a product joined with a sum counts as a product and a
    /// sum.
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
}
