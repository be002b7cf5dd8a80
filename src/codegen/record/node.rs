//! One step of a recorded computation.

/// Position of a node among the nodes of its program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Id(pub(in crate::codegen) u32);

impl Id {
    /// As an index into [`Program::nodes`](crate::codegen::Program::nodes).
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One step: an operation on the values of earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Node {
    /// A constant.
    Constant(f64),
    /// Entry k of all arguments, one after the other.
    Input(u32),
    /// `-a`.
    Neg(Id),
    /// `a + b`.
    Add(Id, Id),
    /// `a - b`.
    Sub(Id, Id),
    /// `a b`.
    Mul(Id, Id),
    /// `a / b`.
    Div(Id, Id),
    /// `a b + c`, rounded once where the target has the instruction.
    MulAdd(Id, Id, Id),
    /// `a b - c`, rounded once where the target has the instruction.
    MulSub(Id, Id, Id),
    /// `c - a b`, rounded once where the target has the instruction.
    NegMulAdd(Id, Id, Id),
    /// Square root.
    Sqrt(Id),
    /// Sine.
    Sin(Id),
    /// Cosine.
    Cos(Id),
    /// Exponential function.
    Exp(Id),
    /// `exp(a) - 1` without cancellation near 0.
    ExpM1(Id),
    /// `a < b`, a truth value that only [`Node::Select`] uses; false where one of them is not a number.
    Less(Id, Id),
    /// The second where the first, a [`Node::Less`], is true, else the third.
    Select(Id, Id, Id),
}

impl Node {
    /// Its operands, in the order in which they are listed above.
    pub fn operands(&self) -> impl Iterator<Item = Id> + Clone {
        const NONE: Id = Id(0);
        let (operands, count) = match *self {
            Self::Constant(_) | Self::Input(_) => ([NONE; 3], 0),
            Self::Neg(a) | Self::Sqrt(a) | Self::Sin(a) | Self::Cos(a) | Self::Exp(a) | Self::ExpM1(a) => {
                ([a, NONE, NONE], 1)
            }
            Self::Add(a, b) | Self::Sub(a, b) | Self::Mul(a, b) | Self::Div(a, b) | Self::Less(a, b) => {
                ([a, b, NONE], 2)
            }
            Self::MulAdd(a, b, c)
            | Self::MulSub(a, b, c)
            | Self::NegMulAdd(a, b, c)
            | Self::Select(a, b, c) => ([a, b, c], 3),
        };
        operands.into_iter().take(count)
    }

    /// The same step on other nodes.
    pub(in crate::codegen) fn map(self, of: impl Fn(Id) -> Id) -> Self {
        match self {
            Self::Constant(_) | Self::Input(_) => self,
            Self::Neg(a) => Self::Neg(of(a)),
            Self::Add(a, b) => Self::Add(of(a), of(b)),
            Self::Sub(a, b) => Self::Sub(of(a), of(b)),
            Self::Mul(a, b) => Self::Mul(of(a), of(b)),
            Self::Div(a, b) => Self::Div(of(a), of(b)),
            Self::MulAdd(a, b, c) => Self::MulAdd(of(a), of(b), of(c)),
            Self::MulSub(a, b, c) => Self::MulSub(of(a), of(b), of(c)),
            Self::NegMulAdd(a, b, c) => Self::NegMulAdd(of(a), of(b), of(c)),
            Self::Sqrt(a) => Self::Sqrt(of(a)),
            Self::Sin(a) => Self::Sin(of(a)),
            Self::Cos(a) => Self::Cos(of(a)),
            Self::Exp(a) => Self::Exp(of(a)),
            Self::ExpM1(a) => Self::ExpM1(of(a)),
            Self::Less(a, b) => Self::Less(of(a), of(b)),
            Self::Select(a, b, c) => Self::Select(of(a), of(b), of(c)),
        }
    }

    /// Whether it is a constant or an input.
    pub fn is_leaf(&self) -> bool {
        matches!(self, Self::Constant(_) | Self::Input(_))
    }

    /// Distinct for distinct nodes, equal for equal ones (constants by their bits).
    pub(in crate::codegen) fn key(&self) -> [u64; 2] {
        let tag: u64 = match self {
            Self::Constant(value) => return [0, value.to_bits()],
            Self::Input(k) => return [1, u64::from(*k)],
            Self::Neg(_) => 2,
            Self::Add(..) => 3,
            Self::Sub(..) => 4,
            Self::Mul(..) => 5,
            Self::Div(..) => 6,
            Self::MulAdd(..) => 7,
            Self::MulSub(..) => 8,
            Self::NegMulAdd(..) => 9,
            Self::Sqrt(_) => 10,
            Self::Sin(_) => 11,
            Self::Cos(_) => 12,
            Self::Exp(_) => 13,
            Self::ExpM1(_) => 14,
            Self::Less(..) => 15,
            Self::Select(..) => 16,
        };
        let mut ids = self.operands().map(|id| u64::from(id.0));
        let mut next = || ids.next().unwrap_or(0);
        [tag << 32 | next(), next() << 32 | next()]
    }
}
