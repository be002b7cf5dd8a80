//! The steps of a program as this crate translates them: for numbers, or for pairs of numbers.

use costate::codegen::{Node, Program};

/// What a step computes from its operands a, b, c; the first two are no steps but values in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// Entry `operands[0]` of [`Steps::constants`].
    Constant,
    /// Entry `operands[0]` of [`Steps::inputs`].
    Input,
    /// `-a`
    Neg,
    /// `a + b`
    Add,
    /// `a - b`
    Sub,
    /// `a b`
    Mul,
    /// `a / b`
    Div,
    /// `a b + c`
    MulAdd,
    /// `a b - c`
    MulSub,
    /// `c - a b`
    NegMulAdd,
    Sqrt,
    Sin,
    Cos,
    Exp,
    ExpM1,
    /// `a < b`, all bits set or none.
    Less,
    /// `a ? b : c`
    Select,
    /// The two numbers of the pair a, exchanged.
    Exchange,
}

impl Op {
    /// Number of operands.
    fn arity(self) -> usize {
        match self {
            Self::Constant | Self::Input => 0,
            Self::Neg | Self::Sqrt | Self::Sin | Self::Cos | Self::Exp | Self::ExpM1 | Self::Exchange => 1,
            Self::Add | Self::Sub | Self::Mul | Self::Div | Self::Less => 2,
            Self::MulAdd | Self::MulSub | Self::NegMulAdd | Self::Select => 3,
        }
    }

    /// Whether it is in memory before the program begins.
    pub fn is_leaf(self) -> bool {
        self.arity() == 0
    }
}

/// An operation and the positions of its operands, unused ones 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Step {
    pub op: Op,
    pub operands: [u32; 3],
}

impl Step {
    /// Number of operands.
    pub fn arity(&self) -> usize {
        self.op.arity()
    }

    /// The positions of its operands.
    pub fn operands(&self) -> impl Iterator<Item = usize> + Clone {
        self.operands.into_iter().take(self.op.arity()).map(|operand| operand as usize)
    }

    pub fn is_leaf(&self) -> bool {
        self.op.is_leaf()
    }
}

/// A program: its steps, each after its operands, and what their leaves and results stand for.
///
/// In a program of pairs, every value is two numbers, one in each lane. Otherwise the second ones are
/// ignored.
#[derive(Clone, Debug, Default)]
pub struct Steps {
    pub steps: Vec<Step>,
    /// The numbers of each constant.
    pub constants: Vec<[f64; 2]>,
    /// The arguments of the program that each input consists of.
    pub inputs: Vec<[u32; 2]>,
    /// Position and lane of each result.
    pub results: Vec<(u32, usize)>,
}

impl Steps {
    /// Those of a program, each value one number.
    pub fn of(program: &Program) -> Self {
        let mut constants = Vec::new();
        let step = |node: &Node| {
            let mut operands = [0; 3];
            for (operand, id) in operands.iter_mut().zip(node.operands()) {
                *operand = id.index() as u32;
            }
            let op = match *node {
                Node::Constant(value) => {
                    operands[0] = constants.len() as u32;
                    constants.push([value; 2]);
                    Op::Constant
                }
                Node::Input(k) => {
                    operands[0] = k;
                    Op::Input
                }
                Node::Neg(_) => Op::Neg,
                Node::Add(..) => Op::Add,
                Node::Sub(..) => Op::Sub,
                Node::Mul(..) => Op::Mul,
                Node::Div(..) => Op::Div,
                Node::MulAdd(..) => Op::MulAdd,
                Node::MulSub(..) => Op::MulSub,
                Node::NegMulAdd(..) => Op::NegMulAdd,
                Node::Sqrt(_) => Op::Sqrt,
                Node::Sin(_) => Op::Sin,
                Node::Cos(_) => Op::Cos,
                Node::Exp(_) => Op::Exp,
                Node::ExpM1(_) => Op::ExpM1,
                Node::Less(..) => Op::Less,
                Node::Select(..) => Op::Select,
            };
            Step { op, operands }
        };
        let steps = program.nodes().iter().map(step).collect();
        let entries = program.results().iter().flat_map(|result| &result.entries);
        Self {
            steps,
            constants,
            inputs: (0..program.inputs() as u32).map(|k| [k; 2]).collect(),
            results: entries.map(|id| (id.index() as u32, 0)).collect(),
        }
    }

    /// Number of operations: without constants and inputs.
    pub fn count(&self) -> usize {
        self.steps.iter().filter(|step| !step.is_leaf()).count()
    }
}
