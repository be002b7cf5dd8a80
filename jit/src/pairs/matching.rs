//! Which steps are mirror images of each other.

use super::colors::colors;
use super::terms::{Factor, Sums, Term};
use crate::step::{Op, Steps};
use std::collections::HashMap;

/// A value as the number in one lane of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Half {
    /// The step that is computed as a pair.
    pub of: usize,
    /// The lane: 0 for that step itself, 1 for its mirror image.
    pub lane: usize,
    /// Whether it is its own mirror image: both lanes have the same number, but for rounding.
    pub same: bool,
}

/// The halves of all heads, and the constants in mirror images.
pub(super) struct Matching {
    pub halves: Vec<Half>,
    /// For a constant that stands at a place of a step: the constant that stands there in its mirror image.
    pub partners: HashMap<(usize, usize), usize>,
}

/// A step by operation, colour and operands: equal for mirror images when the lanes of one are exchanged.
type Key = Vec<u64>;

/// Terms of a sum or operands of another step, each with its constant, if it has one.
type Items = Vec<([u64; 3], Option<Factor>)>;

struct Matcher<'a> {
    program: &'a Steps,
    sums: &'a Sums,
    colors: Vec<u64>,
    matching: Matching,
}

/// Finds the mirror images in a program, given those of its inputs.
///
/// A step is the mirror image of an earlier one if it has the same colour and the mirror images of that one's
/// operands. A step whose operands are their own mirror images, or each other's, is its own one if no other
/// step has the same operands.
pub(super) fn matching(program: &Steps, sums: &Sums, images: &[u32]) -> Matching {
    let halves = (0..program.steps.len()).map(|of| Half { of, lane: 0, same: false }).collect();
    let matching = Matching { halves, partners: HashMap::new() };
    let mut matcher = Matcher { program, sums, colors: colors(program, sums), matching };
    matcher.inputs(images);
    matcher.steps();
    matcher.matching
}

impl Matcher<'_> {
    fn inputs(&mut self, images: &[u32]) {
        let inputs = self.program.steps.iter().enumerate().filter(|(_, step)| step.op == Op::Input);
        let places: HashMap<u32, usize> = inputs.map(|(k, step)| (step.operands[0], k)).collect();
        for (&input, &k) in &places {
            let image = images[input as usize];
            let half = &mut self.matching.halves[k];
            match places.get(&image) {
                _ if image == input => half.same = true,
                Some(&of) if image < input => *half = Half { of, lane: 1, same: false },
                _ => {}
            }
        }
    }

    fn steps(&mut self) {
        let steps = &self.program.steps;
        let heads: Vec<usize> =
            (0..steps.len()).filter(|&k| self.sums.heads[k] == k && !steps[k].is_leaf()).collect();
        let plain = |value: usize| 1 + value as u64;
        let alike: Vec<Key> = heads.iter().map(|&k| self.key(k, &self.items(k, plain))).collect();
        let mut counts: HashMap<&Key, usize> = HashMap::new();
        alike.iter().for_each(|key| *counts.entry(key).or_default() += 1);
        let mut waiting: HashMap<Key, Vec<usize>> = HashMap::new();
        for (&k, alike) in heads.iter().zip(&alike) {
            let own = self.key(k, &self.lanes(k, 0));
            let mirrored = self.key(k, &self.lanes(k, 1));
            if own == mirrored && counts[alike] == 1 && self.pair_constants(k, k) {
                self.matching.halves[k].same = true;
                continue;
            }
            let images = waiting.get_mut(&mirrored);
            match images.and_then(|images| (!images.is_empty()).then(|| images.remove(0))) {
                Some(of) if self.pair(of, k) => {}
                _ => waiting.entry(own).or_default().push(k),
            }
        }
    }

    /// Records a mirror image, unless its constants contradict.
    fn pair(&mut self, of: usize, image: usize) -> bool {
        let pairs = self.pair_constants(of, image);
        if pairs {
            self.matching.halves[image] = Half { of, lane: 1, same: false };
        }
        pairs
    }

    /// Records the constants of a mirror image, unless a product that other sums use too has other ones.
    fn pair_constants(&mut self, of: usize, image: usize) -> bool {
        let constants = |items: Items| items.into_iter().filter_map(|item| item.1);
        let pairs: Vec<(Factor, Factor)> =
            constants(self.lanes(of, 0)).zip(constants(self.lanes(image, 1))).collect();
        let number = |constant: usize| {
            self.program.constants[self.program.steps[constant].operands[0] as usize][0].to_bits()
        };
        let fits = |(a, b): &(Factor, Factor)| {
            self.partner(a).is_none_or(|partner| number(partner) == number(b.value))
        };
        if !pairs.iter().all(fits) {
            return false;
        }
        for (a, b) in pairs {
            self.matching.partners.insert((a.user, a.place), b.value);
        }
        true
    }

    /// The constant in the mirror image of a step, if that is known already.
    fn partner(&self, factor: &Factor) -> Option<usize> {
        let half = self.matching.halves[self.sums.heads[factor.user]];
        match half {
            Half { lane: 1, of, .. } => {
                self.lanes(of, 0).into_iter().find_map(|item| item.1).map(|f| f.value)
            }
            _ => self.matching.partners.get(&(factor.user, factor.place)).copied(),
        }
    }

    /// The items of a step with operands by their halves, lanes exchanged or not.
    fn lanes(&self, k: usize, exchanged: usize) -> Items {
        self.items(k, |value| {
            let half = self.matching.halves[value];
            1 + 3 * half.of as u64 + if half.same { 2 } else { (half.lane ^ exchanged) as u64 }
        })
    }

    /// The items of a step, sorted where their order does not matter; all constants have the code 0.
    fn items(&self, k: usize, code: impl Fn(usize) -> u64) -> Items {
        let is_constant = |factor: &Factor| self.program.steps[factor.value].op == Op::Constant;
        let code = |factor: &Factor| if is_constant(factor) { 0 } else { code(factor.value) };
        let item = |negative: bool, factors: &[Factor]| {
            let mut codes = [u64::from(negative), 0, 0];
            codes[1..].iter_mut().zip(factors).for_each(|(place, factor)| *place = code(factor));
            codes[1..].sort_unstable();
            (codes, factors.iter().copied().find(is_constant))
        };
        let terms = &self.sums.terms[k];
        let step = &self.program.steps[k];
        let mut items: Items = if terms.is_empty() {
            let operands = step.operands().enumerate();
            operands.map(|(place, value)| item(false, &[Factor { user: k, place, value }])).collect()
        } else {
            terms.iter().map(|Term { negative, factors }| item(*negative, factors)).collect()
        };
        if !terms.is_empty() || step.op == Op::Mul {
            items.sort_by_key(|item| item.0);
        }
        items
    }

    fn key(&self, k: usize, items: &Items) -> Key {
        let op = if self.sums.terms[k].is_empty() { self.program.steps[k].op } else { Op::Add };
        let codes = items.iter().flat_map(|item| item.0);
        [self.colors[k], op as u64].into_iter().chain(codes).collect()
    }
}
