//! The nodes of a recording, each distinct one once, with constants folded.
//!
//! A reference to a node carries a sign, so that a negation is free while recording and `a - b` and `b - a`
//! are one node: the sign of a product is that of its factors, sums absorb the signs of their terms.

use super::node::{Id, Node};
use super::value::{Signed, Truth, Value};
use crate::codegen::error::CodegenError;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A hasher for keys of two words: multiply and fold.
#[derive(Default)]
struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        // Arrays of words come as their bytes.
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|&word| self.write_u64(u64::from_le_bytes(word)));
        rest.iter().for_each(|&byte| self.write_u64(byte.into()));
    }
    fn write_u64(&mut self, word: u64) {
        let product = u128::from(self.0 ^ word) * u128::from(0x9e37_79b9_7f4a_7c15_u64);
        self.0 = (product as u64) ^ ((product >> 64) as u64).rotate_left(29);
    }
    fn write_usize(&mut self, _: usize) {}
}

type Places = HashMap<[u64; 2], Id, BuildHasherDefault<KeyHasher>>;

/// All nodes of a recording, each after its operands.
#[derive(Default)]
pub(in crate::codegen) struct Arena {
    pub nodes: Vec<Node>,
    places: Places,
    /// The first error.
    pub error: Option<CodegenError>,
}

impl Arena {
    /// With room for so many nodes.
    pub fn with_capacity(nodes: usize) -> Self {
        let mut arena = Self::default();
        arena.nodes.reserve(nodes);
        arena.places.reserve(nodes);
        arena
    }

    /// The position of a node, which is added if it is new.
    pub fn intern(&mut self, node: Node) -> Id {
        let next = Id(self.nodes.len() as u32);
        let id = *self.places.entry(node.key()).or_insert(next);
        if id == next {
            self.nodes.push(node);
        }
        id
    }

    /// Entry k of the arguments.
    pub fn input(&mut self, k: u32) -> Value {
        self.positive(Node::Input(k))
    }

    /// Keeps the first error.
    pub fn fail(&mut self, error: CodegenError) {
        self.error.get_or_insert(error);
    }

    fn positive(&mut self, node: Node) -> Value {
        Value::Of(Signed { id: self.intern(node), negative: false })
    }

    /// A constant is a node with its sign: steps that differ in the signs of constants only, as those of the
    /// left and the right side of a robot, remain alike.
    pub fn signed(&mut self, value: Value) -> Signed {
        match value {
            Value::Of(signed) => signed,
            Value::Constant(value) => Signed { id: self.intern(Node::Constant(value)), negative: false },
        }
    }

    /// A node that holds the value with its sign.
    pub fn whole(&mut self, value: Value) -> Id {
        match value {
            Value::Constant(value) => self.intern(Node::Constant(value)),
            Value::Of(Signed { id, negative: false }) => id,
            Value::Of(Signed { id, negative: true }) => match self.nodes[id.index()] {
                Node::Constant(value) => self.intern(Node::Constant(-value)),
                _ => self.intern(Node::Neg(id)),
            },
        }
    }

    fn constant(&self, id: Id) -> Option<f64> {
        match self.nodes[id.index()] {
            Node::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// The order of operands that can be exchanged: constants first, whenever they appeared.
    fn rank(&self, id: Id) -> (bool, Id) {
        (self.constant(id).is_none(), id)
    }

    /// The signed terms of a sum of two.
    fn terms(&self, value: Value) -> Option<[Signed; 2]> {
        let Value::Of(Signed { id, negative }) = value else { return None };
        let (a, b, minus) = match self.nodes[id.index()] {
            Node::Add(a, b) => (a, b, false),
            Node::Sub(a, b) => (a, b, true),
            _ => return None,
        };
        Some([Signed { id: a, negative }, Signed { id: b, negative: negative != minus }])
    }

    pub fn add(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => return Value::Constant(x + y),
            _ if a.is(0.0) => return b,
            _ if b.is(0.0) => return a,
            (term, Value::Constant(more)) | (Value::Constant(more), term) => {
                if let Some(sum) = self.add_to_constant(term, more) {
                    return sum;
                }
            }
            _ => {}
        }
        if let Some(rest) = self.cancelled(a, b).or_else(|| self.cancelled(b, a)) {
            return rest;
        }
        if let Some(product) = self.factored(a, b) {
            return product;
        }
        let (a, b) = (self.signed(a), self.signed(b));
        if a.id == b.id {
            return match a.negative == b.negative {
                true => self.mul(Value::Constant(2.0), Value::Of(a)),
                false => Value::Constant(0.0),
            };
        }
        let [first, second] = if self.rank(a.id) < self.rank(b.id) { [a, b] } else { [b, a] };
        let node = match first.negative == second.negative {
            true => Node::Add(first.id, second.id),
            false => Node::Sub(first.id, second.id),
        };
        self.positive(node).negated_if(first.negative)
    }

    /// `(x + c) + more = x + (c + more)`.
    fn add_to_constant(&mut self, sum: Value, more: f64) -> Option<Value> {
        let [a, b] = self.terms(sum)?;
        let (rest, constant) = match (self.constant(a.id), self.constant(b.id)) {
            (Some(value), _) => (b, if a.negative { -value } else { value }),
            (_, Some(value)) => (a, if b.negative { -value } else { value }),
            _ => return None,
        };
        Some(self.add(Value::Of(rest), Value::Constant(constant + more)))
    }

    /// `a + (b - a) = b`.
    fn cancelled(&self, a: Value, sum: Value) -> Option<Value> {
        let (Value::Of(a), [x, y]) = (a, self.terms(sum)?) else { return None };
        let opposite = |term: Signed| term.id == a.id && term.negative != a.negative;
        match (opposite(x), opposite(y)) {
            (true, _) => Some(Value::Of(y)),
            (_, true) => Some(Value::Of(x)),
            _ => None,
        }
    }

    /// `a x + (b - a) x = b x`.
    fn factored(&mut self, first: Value, second: Value) -> Option<Value> {
        let (Value::Of(first), Value::Of(second)) = (first, second) else { return None };
        let (Node::Mul(a, b), Node::Mul(c, d)) =
            (self.nodes[first.id.index()], self.nodes[second.id.index()])
        else {
            return None;
        };
        for (common, x, y) in [(a, b, d), (a, b, c), (b, a, d), (b, a, c)] {
            let other = if y == c { d } else { c };
            if common != other {
                continue;
            }
            let x = Value::Of(Signed { id: x, negative: first.negative });
            let y = Value::Of(Signed { id: y, negative: second.negative });
            if let Some(rest) = self.cancelled(x, y).or_else(|| self.cancelled(y, x)) {
                return Some(self.mul(rest, Value::Of(Signed { id: common, negative: false })));
            }
        }
        None
    }

    pub fn mul(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => return Value::Constant(x * y),
            (Value::Constant(c), x) | (x, Value::Constant(c)) => {
                if c == 0.0 {
                    return Value::Constant(0.0);
                } else if c.abs() == 1.0 {
                    return x.negated_if(c < 0.0);
                } else if let Some(product) = self.scale_scaled(x, c) {
                    return product;
                }
            }
            _ => {}
        }
        let (a, b) = (self.signed(a), self.signed(b));
        let [first, second] = if self.rank(a.id) < self.rank(b.id) { [a.id, b.id] } else { [b.id, a.id] };
        let node = Node::Mul(first, second);
        self.positive(node).negated_if(a.negative != b.negative)
    }

    /// `c (d x) = (c d) x`.
    fn scale_scaled(&mut self, product: Value, c: f64) -> Option<Value> {
        let Value::Of(Signed { id, negative }) = product else { return None };
        let Node::Mul(a, b) = self.nodes[id.index()] else { return None };
        let (d, x) = match (self.constant(a), self.constant(b)) {
            (Some(d), _) => (d, b),
            (_, Some(d)) => (d, a),
            _ => return None,
        };
        let factor = c * d;
        let x = Value::Of(Signed { id: x, negative });
        factor.is_normal().then(|| self.mul(Value::Constant(factor), x))
    }

    pub fn div(&mut self, a: Value, b: Value) -> Value {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => return Value::Constant(x / y),
            (_, Value::Constant(y)) if y.recip().is_normal() => {
                return self.mul(a, Value::Constant(y.recip()));
            }
            _ if a.is(0.0) => return a,
            _ => {}
        }
        let (a, b) = (self.signed(a), self.signed(b));
        self.positive(Node::Div(a.id, b.id)).negated_if(a.negative != b.negative)
    }

    /// A function that is neither even nor odd.
    pub fn function(&mut self, a: Value, node: impl Fn(Id) -> Node, fold: impl Fn(f64) -> f64) -> Value {
        match a {
            Value::Constant(value) => Value::Constant(fold(value)),
            Value::Of(_) => {
                let id = self.whole(a);
                self.positive(node(id))
            }
        }
    }

    /// Sine, odd, and cosine, even.
    pub fn sin_cos(&mut self, a: Value) -> (Value, Value) {
        match a {
            Value::Constant(value) => (Value::Constant(value.sin()), Value::Constant(value.cos())),
            Value::Of(Signed { id, negative }) => {
                let sin = self.positive(Node::Sin(id)).negated_if(negative);
                (sin, self.positive(Node::Cos(id)))
            }
        }
    }

    pub fn less(&mut self, a: Value, b: Value) -> Truth {
        match (a, b) {
            (Value::Constant(x), Value::Constant(y)) => Truth::Constant(x < y),
            (Value::Of(x), Value::Of(y)) if x == y => Truth::Constant(false),
            _ => {
                let (a, b) = (self.whole(a), self.whole(b));
                Truth::Of(self.intern(Node::Less(a, b)))
            }
        }
    }

    pub fn select(&mut self, mask: Truth, if_true: Value, if_false: Value) -> Value {
        match (mask, if_true, if_false) {
            (Truth::Constant(mask), ..) => {
                if mask {
                    if_true
                } else {
                    if_false
                }
            }
            (_, Value::Of(x), Value::Of(y)) if x == y => if_true,
            (Truth::Of(mask), ..) => {
                let (a, b) = (self.whole(if_true), self.whole(if_false));
                self.positive(Node::Select(mask, a, b))
            }
        }
    }
}
