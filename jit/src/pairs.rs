//! Programs of pairs: of a robot with two equal sides, both are computed at once.
//!
//! A symmetry of the robot exchanges inputs, as those of left and right limbs. Every step then has a mirror
//! image, the same function of the exchanged inputs, with constants of its own. A step and its mirror image
//! become one step on pairs of numbers. Where a step uses the mirror image of a pair, the two numbers are
//! exchanged first. Whatever steps are found to be mirror images, the program of pairs computes the results
//! of the program, with sums in another order.

mod colors;
mod matching;
mod terms;

use crate::step::{Op, Step, Steps};
use matching::{Half, Matching, matching};
use std::collections::HashMap;
use terms::Sums;

/// Most steps of a program of pairs, for each step of the program that it replaces: a pair costs more than a
/// number where it is loaded and stored.
const MOST: f64 = 0.85;

/// The program on pairs of numbers, whose inputs have these mirror images; `None` where it is not much
/// shorter.
pub(crate) fn paired(program: &Steps, images: &[u32]) -> Option<Steps> {
    if images.len() != program.inputs.len() {
        return None;
    }
    let sums = Sums::new(program);
    let matching = matching(program, &sums, images);
    let pairs = Pairs {
        program,
        sums,
        matching,
        new: Steps::default(),
        places: vec![0; program.steps.len()],
        exchanged: HashMap::new(),
        constants: HashMap::new(),
    };
    Some(pairs.steps(images)).filter(|new| (new.count() as f64) < MOST * program.count() as f64)
}

struct Pairs<'a> {
    program: &'a Steps,
    sums: Sums,
    matching: Matching,
    new: Steps,
    /// The places of pairs by their first steps.
    places: Vec<u32>,
    /// Exchanged pairs by the places of these.
    exchanged: HashMap<u32, u32>,
    constants: HashMap<[u64; 2], u32>,
}

impl Pairs<'_> {
    fn steps(mut self, images: &[u32]) -> Steps {
        let program = self.program;
        self.new.inputs = program.inputs.iter().zip(images).map(|(&[k, _], &image)| [k, image]).collect();
        for (k, &Step { op, mut operands }) in program.steps.iter().enumerate() {
            if self.half(self.sums.heads[k]).lane == 1 || op == Op::Constant {
                continue;
            }
            for (place, value) in program.steps[k].operands().enumerate() {
                operands[place] = self.operand(k, place, value);
            }
            self.places[k] = self.push(Step { op, operands });
        }
        for &(k, _) in &program.results {
            let k = k as usize;
            let result = match program.steps[k].op {
                Op::Constant => (self.constant([k, k]), 0),
                _ => (self.places[self.half(k).of], self.half(k).lane),
            };
            self.new.results.push(result);
        }
        self.new
    }

    /// The pair that a head belongs to; a step within a sum belongs to one of its own.
    fn half(&self, k: usize) -> Half {
        self.matching.halves[k]
    }

    /// The place of the pair that stands for an operand of step k.
    fn operand(&mut self, k: usize, place: usize, value: usize) -> u32 {
        if self.program.steps[value].op == Op::Constant {
            let partner = self.matching.partners.get(&(k, place)).copied();
            return self.constant([value, partner.unwrap_or(value)]);
        }
        let half = self.half(value);
        let pair = self.places[half.of];
        if half.lane == 0 {
            return pair;
        }
        if let Some(&known) = self.exchanged.get(&pair) {
            return known;
        }
        let exchanged = self.push(Step { op: Op::Exchange, operands: [pair, 0, 0] });
        self.exchanged.insert(pair, exchanged);
        exchanged
    }

    /// The place of a pair of constants, which are steps of the program.
    fn constant(&mut self, steps: [usize; 2]) -> u32 {
        let numbers = steps.map(|k| self.program.constants[self.program.steps[k].operands[0] as usize][0]);
        let key = numbers.map(f64::to_bits);
        if let Some(&known) = self.constants.get(&key) {
            return known;
        }
        let operands = [self.new.constants.len() as u32, 0, 0];
        self.new.constants.push(numbers);
        let place = self.push(Step { op: Op::Constant, operands });
        self.constants.insert(key, place);
        place
    }

    fn push(&mut self, step: Step) -> u32 {
        self.new.steps.push(step);
        self.new.steps.len() as u32 - 1
    }
}
