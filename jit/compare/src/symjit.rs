//! A program by symjit.

use crate::candidate::Candidate;
use costate::codegen::{Id, Node, Program};
use symjit::{Complex, Composer, Config, Slot, Translator};

/// Numbers of the values that it makes of a program.
struct Body {
    translator: Translator,
    slots: Vec<Slot>,
    minus_one: Slot,
    more: usize,
}

impl Body {
    fn constant(&mut self, value: f64) -> Slot {
        Slot::Const(self.translator.append_constant(Complex::new(value, 0.0)).unwrap())
    }

    fn sum(&mut self, to: Slot, a: Slot, b: Slot) -> Slot {
        self.translator.append_add(&to, &[a, b], 2).unwrap();
        to
    }

    fn product(&mut self, to: Slot, a: Slot, b: Slot) -> Slot {
        self.translator.append_mul(&to, &[a, b], 2).unwrap();
        to
    }

    fn another(&mut self) -> Slot {
        self.more += 1;
        Slot::Temp(self.more - 1)
    }

    fn difference(&mut self, to: Slot, a: Slot, b: Slot) -> Slot {
        let minus = self.another();
        let minus = self.product(minus, self.minus_one, b);
        self.sum(to, a, minus)
    }

    fn function(&mut self, to: Slot, name: &str, a: Slot) -> Slot {
        self.translator.append_fun(&to, name, &[a], true).unwrap();
        to
    }

    fn step(&mut self, k: usize, node: Node) -> Slot {
        let to = Slot::Temp(k);
        let of = |id: Id| self.slots[id.index()];
        match node {
            Node::Constant(value) => self.constant(value),
            Node::Input(k) => Slot::Param(k as usize),
            Node::Neg(a) => self.product(to, self.minus_one, of(a)),
            Node::Add(a, b) => self.sum(to, of(a), of(b)),
            Node::Sub(a, b) => self.difference(to, of(a), of(b)),
            Node::Mul(a, b) => self.product(to, of(a), of(b)),
            Node::Div(a, b) => {
                let (a, b) = (of(a), of(b));
                self.translator.append_div(&to, &a, &b, true, true).unwrap();
                to
            }
            Node::MulAdd(a, b, c) | Node::MulSub(a, b, c) | Node::NegMulAdd(a, b, c) => {
                let (a, b, c) = (of(a), of(b), of(c));
                let product = self.another();
                let product = self.product(product, a, b);
                match node {
                    Node::MulAdd(..) => self.sum(to, product, c),
                    Node::MulSub(..) => self.difference(to, product, c),
                    _ => self.difference(to, c, product),
                }
            }
            Node::Sin(a) => self.function(to, "sin", of(a)),
            Node::Cos(a) => self.function(to, "cos", of(a)),
            _ => panic!("the robots that are compared have no friction"),
        }
    }
}

/// Compiles with the most optimisation there is, fused operations allowed.
pub fn compile(program: &Program) -> Candidate {
    let mut config = Config::default();
    config.set_fastmath(true);
    config.set_opt_level(2);
    let mut translator = Translator::new(config);
    translator.set_num_params(program.inputs());
    let slots = Vec::new();
    let mut body = Body { translator, slots, minus_one: Slot::Const(0), more: program.nodes().len() };
    body.minus_one = body.constant(-1.0);
    for (k, &node) in program.nodes().iter().enumerate() {
        let slot = body.step(k, node);
        body.slots.push(slot);
    }
    let results = program.results().iter().flat_map(|result| &result.entries);
    for (k, id) in results.enumerate() {
        let slot = body.slots[id.index()];
        body.translator.append_assign(&Slot::Out(k), &slot).unwrap();
    }
    let applet = body.translator.compile().and_then(|application| application.seal()).unwrap();
    Candidate::new(0, move |x, y| applet.evaluate(x, y))
}
