//! Sums as sets of terms: two sums are alike whatever the order in which their terms are added.

use crate::step::{Op, Step, Steps};

/// A number or a product, with its sign in a sum.
#[derive(Clone, Debug)]
pub(super) struct Term {
    pub negative: bool,
    /// Its factors, each with the step and the place of that step's operands where it stands.
    pub factors: Vec<Factor>,
}

/// An operand: the step that has it, its place there, and its own step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factor {
    pub user: usize,
    pub place: usize,
    pub value: usize,
}

/// The steps of a program, with those that only serve one sum joined to it.
pub(super) struct Sums {
    /// For each step the sum that it belongs to, or itself.
    pub heads: Vec<usize>,
    /// For each step that is a head: its terms, if it is a sum.
    pub terms: Vec<Vec<Term>>,
}

/// The operands that a sum adds, with their places and signs.
fn addends(step: &Step) -> Vec<(usize, bool)> {
    match step.op {
        Op::Add => vec![(0, false), (1, false)],
        Op::Sub => vec![(0, false), (1, true)],
        Op::Neg => vec![(0, true)],
        Op::MulAdd | Op::NegMulAdd => vec![(2, false)],
        Op::MulSub => vec![(2, true)],
        _ => Vec::new(),
    }
}

impl Sums {
    pub fn new(program: &Steps) -> Self {
        let steps = &program.steps;
        let mut uses = vec![0; steps.len()];
        steps.iter().flat_map(Step::operands).for_each(|operand| uses[operand] += 1);
        program.results.iter().for_each(|result| uses[result.0 as usize] += 1);
        let mut heads: Vec<usize> = (0..steps.len()).collect();
        for (k, step) in steps.iter().enumerate().rev() {
            for (place, _) in addends(step) {
                let addend = step.operands[place] as usize;
                let joins = steps[addend].op == Op::Mul || !addends(&steps[addend]).is_empty();
                if joins && uses[addend] == 1 {
                    heads[addend] = heads[k];
                }
            }
        }
        let mut terms = vec![Vec::new(); steps.len()];
        for k in (0..steps.len()).filter(|&k| heads[k] == k && !addends(&steps[k]).is_empty()) {
            terms[k] = sum(steps, &heads, k);
        }
        Self { heads, terms }
    }
}

/// The terms of the sum that ends at `head`.
fn sum(steps: &[Step], heads: &[usize], head: usize) -> Vec<Term> {
    let mut terms = Vec::new();
    let mut open = vec![(head, false)];
    while let Some((k, negative)) = open.pop() {
        let step = &steps[k];
        let factor = |place: usize| Factor { user: k, place, value: step.operands[place] as usize };
        let product = |negative: bool| Term { negative, factors: vec![factor(0), factor(1)] };
        match step.op {
            Op::Mul | Op::MulAdd | Op::MulSub => terms.push(product(negative)),
            Op::NegMulAdd => terms.push(product(!negative)),
            _ => {}
        }
        for (place, opposite) in addends(step) {
            let (addend, negative) = (factor(place), negative != opposite);
            let product = steps[addend.value].op == Op::Mul;
            if heads[addend.value] == head {
                open.push((addend.value, negative));
            } else if product {
                let step = &steps[addend.value];
                let factor =
                    |place: usize| Factor { user: addend.value, place, value: step.operands[place] as usize };
                terms.push(Term { negative, factors: vec![factor(0), factor(1)] });
            } else {
                terms.push(Term { negative, factors: vec![addend] });
            }
        }
    }
    terms
}
