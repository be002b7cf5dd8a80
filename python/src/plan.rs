//! Where the arguments of a call go and where its results come from.
//!
//! All numbers of one state lie in one buffer: a one, a zero, numbers that are passed on, the arguments of
//! the core, its results, products of these. [`Piece`]s of it make a result array, for one state as for
//! four.

use crate::argument::{Argument, Entries};
use std::ops::Range;

/// The positions of a number 1 and, for four states, of a number 0 in every buffer.
pub const ONE: usize = 0;
pub const ZERO: usize = 1;

/// A part of an argument and its place in the buffer.
#[derive(Debug)]
pub struct Place {
    pub argument: usize,
    pub start: usize,
    pub length: usize,
    pub at: usize,
}

/// A part of a result; all of it that no piece writes is zero.
#[derive(Clone, Debug)]
pub enum Piece {
    /// `length` numbers, each `from.1` places after the one before, to every `to.1`-th place.
    Move { to: (usize, usize), from: (usize, usize), length: usize },
    /// Adds the sum of `length` products to one number, which no other kind of piece writes.
    Product { to: usize, a: (usize, usize), b: (usize, usize), length: usize },
}

/// A sum of products in the buffer, which is put at a place there or added to what is there.
#[derive(Debug)]
struct Product {
    to: usize,
    adds: bool,
    a: (usize, usize),
    b: (usize, usize),
    length: usize,
}

/// A result array: its shape for one state.
#[derive(Debug)]
pub struct Output {
    pub shape: Vec<usize>,
    pub length: usize,
    /// What is moved there; it is cleared before where that is not all of it.
    moves: Vec<Move>,
    cleared: bool,
    /// The same number by number: where each of them is in the buffer.
    pub places: Vec<u32>,
}

/// As [`Piece::Move`].
#[derive(Clone, Copy, Debug)]
struct Move {
    to: (usize, usize),
    from: (usize, usize),
    length: usize,
}

/// What a call reads and writes.
#[derive(Debug)]
pub struct Plan {
    pub arguments: Vec<Argument>,
    pub places: Vec<Place>,
    pub core_inputs: Range<usize>,
    pub core_outputs: Range<usize>,
    pub outputs: Vec<Output>,
    /// Sums of products, behind the results of the core.
    products: Vec<Product>,
    size: usize,
}

impl Plan {
    /// The plan of a core whose arguments and results are those of the call, in the same order.
    pub fn whole(arguments: &[Argument], shapes: &[&[usize]]) -> Self {
        let mut plan = PlanBuilder::new(0);
        for argument in arguments {
            plan.parts(argument.name, argument.entries, [(argument.length, true)]);
        }
        let length = |shape: &[usize]| shape.iter().product::<usize>();
        let mut plan = plan.results(shapes.iter().map(|shape| length(shape)).sum());
        let mut from = plan.core_outputs.start;
        for shape in shapes {
            plan = plan.output(shape, vec![Piece::copy(0, from, length(shape))]);
            from += length(shape);
        }
        plan
    }

    /// Numbers in the buffer of one state.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Computes the products of one state, or of four, once the core has its results.
    #[inline(always)]
    pub fn multiply<T: Number>(&self, buffer: &mut [T]) {
        for &Product { to, adds, a, b, length } in &self.products {
            let mut sum = if adds { buffer[to] } else { T::ZERO };
            for k in 0..length {
                sum.add_product(buffer[a.0 + k * a.1], buffer[b.0 + k * b.1]);
            }
            buffer[to] = sum;
        }
    }
}

/// Takes the arguments of a [`Plan`].
pub struct PlanBuilder {
    arguments: Vec<Argument>,
    places: Vec<Place>,
    passed: usize,
    first: usize,
    core: usize,
}

impl PlanBuilder {
    /// A plan without arguments; at most `passed` numbers of them are not for the core.
    pub fn new(passed: usize) -> Self {
        let first = ZERO + 1 + passed;
        Self { arguments: Vec::new(), places: Vec::new(), passed: ZERO + 1, first, core: first }
    }

    /// An argument that the core reads; returns where it is.
    pub fn core(&mut self, name: &'static str, length: usize) -> usize {
        self.split(name, [(length, true)])[0]
    }

    /// The argument q, nq entries, which the core reads.
    pub fn positions(&mut self, sizes: [usize; 2]) -> usize {
        let Argument { name, length, entries } = Argument::of_positions("q", sizes);
        self.parts(name, entries, [(length, true)])[0]
    }

    /// An argument in parts, each with its length and whether the core reads it.
    pub fn split<const N: usize>(&mut self, name: &'static str, parts: [(usize, bool); N]) -> [usize; N] {
        self.parts(name, Entries::Joints, parts)
    }

    fn parts<const N: usize>(
        &mut self,
        name: &'static str,
        entries: Entries,
        parts: [(usize, bool); N],
    ) -> [usize; N] {
        let mut start = 0;
        let places = parts.map(|(length, for_core)| {
            let next = if for_core { &mut self.core } else { &mut self.passed };
            let at = *next;
            *next += length;
            self.places.push(Place { argument: self.arguments.len(), start, length, at });
            start += length;
            at
        });
        self.arguments.push(Argument { name, length: start, entries });
        places
    }

    /// All arguments are known; the core has so many results.
    pub fn results(self, count: usize) -> Plan {
        Plan {
            arguments: self.arguments,
            places: self.places,
            core_inputs: self.first..self.core,
            core_outputs: self.core..self.core + count,
            outputs: Vec::new(),
            products: Vec::new(),
            size: self.core + count,
        }
    }
}

impl Plan {
    /// One more result array.
    #[must_use]
    pub fn output(mut self, shape: &[usize], pieces: Vec<Piece>) -> Self {
        let length = shape.iter().product();
        let mut moves: Vec<Move> = Vec::with_capacity(pieces.len());
        // Where the products of this result are.
        let mut sums: Vec<(usize, usize)> = Vec::new();
        for piece in pieces {
            match piece {
                Piece::Move { to, from, length } => moves.push(Move { to, from, length }),
                Piece::Product { to: place, a, b, length } => {
                    let known = sums.iter().find(|(of, _)| *of == place).map(|(_, to)| *to);
                    let to = known.unwrap_or(self.size);
                    if known.is_none() {
                        self.size += 1;
                        sums.push((place, to));
                        // Sums of neighbours are moved together.
                        match moves.last_mut() {
                            Some(Move { to: (start, 1), from: (from, 1), length })
                                if (*start + *length, *from + *length) == (place, to) =>
                            {
                                *length += 1;
                            }
                            _ => moves.push(Move { to: (place, 1), from: (to, 1), length: 1 }),
                        }
                    }
                    self.products.push(Product { to, adds: known.is_some(), a, b, length });
                }
            }
        }
        let cleared = moves.iter().map(|part| part.length).sum::<usize>() < length;
        // Pieces of a larger array, as those of tensors for CasADi, end after their own shape.
        let end = |part: &Move| part.length.checked_sub(1).map_or(0, |last| part.to.0 + last * part.to.1 + 1);
        let most = moves.iter().map(end).fold(length, usize::max);
        let mut places = vec![ZERO as u32; most];
        for &Move { to, from, length } in &moves {
            (0..length).for_each(|k| places[to.0 + k * to.1] = (from.0 + k * from.1) as u32);
        }
        self.outputs.push(Output { shape: shape.to_vec(), length, moves, cleared, places });
        self
    }
}

impl Piece {
    /// Numbers in their order.
    pub fn copy(to: usize, from: usize, length: usize) -> Self {
        Self::Move { to: (to, 1), from: (from, 1), length }
    }

    /// A block of rows of this length from places `from` on, into a matrix with `columns` columns.
    pub fn rows(to: usize, columns: usize, from: usize, [rows, length]: [usize; 2]) -> Vec<Self> {
        if length == columns {
            return vec![Self::copy(to, from, rows * length)];
        }
        (0..rows).map(|i| Self::copy(to + i * columns, from + i * length, length)).collect()
    }

    /// Ones along a diagonal of a matrix with `columns` columns.
    pub fn diagonal(to: usize, columns: usize, length: usize) -> Self {
        Self::Move { to: (to, columns + 1), from: (ONE, 0), length }
    }
}

/// One number of one state, or of four.
pub trait Number: Copy {
    const ZERO: Self;
    /// The number of one state.
    fn of(self, state: usize) -> f64;
    fn add_product(&mut self, a: Self, b: Self);
}

impl Number for f64 {
    const ZERO: Self = 0.0;
    fn of(self, _: usize) -> f64 {
        self
    }
    fn add_product(&mut self, a: Self, b: Self) {
        *self += a * b;
    }
}

impl Number for [f64; 4] {
    const ZERO: Self = [0.0; 4];
    fn of(self, state: usize) -> f64 {
        self[state]
    }
    fn add_product(&mut self, a: Self, b: Self) {
        for state in 0..4 {
            self[state] += a[state] * b[state];
        }
    }
}

impl Output {
    /// Writes the result of one of the states of a buffer.
    pub fn write<T: Number>(&self, buffer: &[T], state: usize, result: &mut [f64]) {
        if self.cleared {
            result.fill(0.0);
        }
        for &Move { to, from, length } in &self.moves {
            if (to.1, from.1) == (1, 1) {
                let from = &buffer[from.0..from.0 + length];
                result[to.0..to.0 + length].iter_mut().zip(from).for_each(|(to, from)| *to = from.of(state));
                continue;
            }
            (0..length).for_each(|k| result[to.0 + k * to.1] = buffer[from.0 + k * from.1].of(state));
        }
    }
}
