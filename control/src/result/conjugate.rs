//! Conjugate times with their multiplicity, from the Jacobi fields along an extremal.
//!
//! Jacobi fields solve $(\delta x, \delta y)' = G (\delta x, \delta y)$ with the Jacobian $G$ of the
//! extremal. A time $t_c$ is conjugate to the start with multiplicity m when m independent fields with
//! $\delta x(0) = 0$ have $\delta x(t_c) = 0$ as well. The Morse index of the motion is the number of
//! conjugate times before T, each counted with its multiplicity. With fields $X, Y$ at $t_i$ that start from
//! $X(0) = 0$, $Y(0) = 1$, and the transition matrix $[A\ B;\ C\ D]$ from $t_i$ to $t_j$,
//!
//! $$ X_j = B \thinspace \bigl(B^{-1} A + Y_i X_i^{-1}\bigr) \thinspace X_i , $$
//!
//! and both terms in the bracket are symmetric. As long as $[t_i, t_j]$ holds no pair of conjugate times of
//! its own, the number of conjugate times in $(t_i, t_j]$ is the number of eigenvalues of the bracket that
//! are not positive. A sign of a determinant would miss those of even multiplicity.
//!
//! The motion is cut into pieces that are short enough for that by the bound of
//! [`disconjugate`](crate::result::disconjugate). So there is no conjugate time in the first piece, where
//! $X_0 = 0$ has no inverse.
//!
//! Transitions are collocated first, on both halves and on the whole of each interval of the mesh
//! ([`collocated`](crate::result::collocated)); the difference of both is the margin of all signs. Where that
//! leaves a doubt, and where there is a conjugate time, they are integrated.

use crate::bvp::mesh::Span;
use crate::constants::checks::conjugate::{LEAST_PART, LOCATED, LOOSE, PIECES, TOLERANCE};
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::result::along::Along;
use crate::result::collocated::Collocated;
use crate::result::disconjugate::{Reach, Sample, ordered};
use crate::result::jacobi_fields::{Fields, Part, Undecided, count, orthonormal};
use crate::result::motion::Certificate;
use crate::solve::Solved;
use nalgebra::DMatrix;
use std::ops::Range;

/// A conjugate time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conjugate {
    /// Time (s).
    pub time: f64,
    /// Number of independent fields that vanish there.
    pub multiplicity: usize,
}

impl Solved {
    /// The first conjugate time up to T, and what the count of all of them says about the motion.
    ///
    /// Only for ends that fix all states and controls that stay within their bounds; else
    /// [`Certificate::NotChecked`], also where the search is to stop.
    pub(crate) fn second_variation(
        &self,
        extremal: &mut dyn Extremal,
        stops: &mut dyn FnMut() -> bool,
    ) -> (Option<Conjugate>, Certificate) {
        let bounded = self.found.arcs.sides.iter().any(Option::is_some) || self.found.excess(extremal) >= 1.0;
        if bounded || !extremal.ends_are_fixed() {
            return (None, Certificate::NotChecked);
        }
        match self.first_conjugate(extremal, stops) {
            Ok(None) => (None, Certificate::LocalMinimum),
            Ok(found) => (found, Certificate::NotMinimal),
            Err(Undecided) => (None, Certificate::NotChecked),
        }
    }

    fn first_conjugate(
        &self,
        extremal: &mut dyn Extremal,
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Conjugate>, Undecided> {
        let durations = self.found.durations(2 * extremal.states());
        let collocated = Some(Collocated::new(&self.found.equations.scale[..2 * extremal.states()]));
        let mut transitions = Transitions { solved: self, durations, tolerance: LOOSE, collocated, stops };
        if transitions.show_none(extremal) {
            return Ok(None);
        }
        (transitions.tolerance, transitions.collocated) = (TOLERANCE, None);
        let fields = transitions.fields(extremal)?;
        let borders = &fields.borders;
        let counts = fields.counts(borders, TOLERANCE)?;
        let coarse = fields.counts(&fields.coarse(), TOLERANCE)?;
        if counts.iter().sum::<usize>() != coarse.iter().sum::<usize>() {
            return Err(Undecided);
        }
        let Some(piece) = counts.iter().position(|&count| count > 0) else { return Ok(None) };
        // Counted from the border before where that is short enough, so that no transition is over a very
        // short time.
        let earlier = piece >= 2
            && transitions.is_disconjugate(extremal, &fields, borders[piece - 1]..borders[piece + 1])?;
        let from = borders[if earlier { piece - 1 } else { piece }];
        let mut before = fields.transition(from, borders[piece]);
        for k in borders[piece]..borders[piece + 1] {
            let after = &fields.over[k] * &before;
            if count(&fields.at[from], &after)? > 0 {
                return transitions.locate(extremal, k, &fields, &fields.at[from], before).map(Some);
            }
            before = after;
        }
        Err(Undecided)
    }
}

/// A transition and the Jacobians on its way, in their order.
struct Sampled {
    over: DMatrix<f64>,
    /// A rougher one, where it is collocated.
    rough: Option<DMatrix<f64>>,
    samples: Vec<Sample>,
}

/// The Jacobi fields of a motion.
struct Transitions<'a> {
    solved: &'a Solved,
    /// Duration of each arc (s).
    durations: Vec<f64>,
    /// Relative tolerance of one integration step, or least error of a collocated transition.
    tolerance: f64,
    /// For a first look.
    collocated: Option<Collocated>,
    /// Whether the search is to stop: then nothing is decided.
    stops: &'a mut dyn FnMut() -> bool,
}

impl Transitions<'_> {
    /// Whether no piece of the motion has a conjugate time, by a margin.
    fn show_none(&mut self, extremal: &mut dyn Extremal) -> bool {
        let Ok(fields) = self.fields(extremal) else { return false };
        [&fields.borders, &fields.coarse()].into_iter().all(|borders| {
            let counts = fields.counts(borders, self.tolerance);
            counts.is_ok_and(|counts| counts.iter().all(|&count| count == 0))
        })
    }

    /// Whether the bound shows that these cuts hold no pair of conjugate times.
    fn is_disconjugate(
        &mut self,
        extremal: &mut dyn Extremal,
        fields: &Fields,
        cuts: Range<usize>,
    ) -> Result<bool, Undecided> {
        let duration = fields.times[cuts.end] - fields.times[cuts.start];
        let mut reach = Reach::new(extremal.states(), duration);
        for part in &fields.parts[cuts] {
            reach = reach.over(&self.sampled(extremal, *part)?.samples);
        }
        Ok(reach.is_disconjugate())
    }

    /// The conjugate time after cut `k`; `before` is the transition from the cut of `fields` to it.
    fn locate(
        &mut self,
        extremal: &mut dyn Extremal,
        k: usize,
        all: &Fields,
        fields: &DMatrix<f64>,
        before: DMatrix<f64>,
    ) -> Result<Conjugate, Undecided> {
        let part = all.parts[k];
        let h = part.to - part.from;
        let (mut from, mut to, mut at_from) = (part.from, part.to, before);
        let mut multiplicity = count(fields, &(&all.over[k] * &at_from))?;
        while to - from > LOCATED * h {
            let middle = 0.5 * (from + to);
            let next = Part { from, to: middle, ..part };
            let at_middle = self.transition(extremal, next, |_, _| ())? * &at_from;
            match count(fields, &at_middle)? {
                0 => (from, at_from) = (middle, at_middle),
                found => (to, multiplicity) = (middle, found),
            }
        }
        Ok(Conjugate { time: all.times[k] + 0.5 * (from + to) - part.from, multiplicity })
    }

    fn fields(&mut self, extremal: &mut dyn Extremal) -> Result<Fields, Undecided> {
        let n = extremal.states();
        let piece = self.durations.iter().sum::<f64>() / PIECES as f64;
        let mut start = DMatrix::zeros(2 * n, n);
        start.rows_mut(n, n).fill_with_identity();
        let mut fields = Fields {
            times: vec![0.0],
            at: vec![start],
            over: Vec::new(),
            rough: Vec::new(),
            parts: Vec::new(),
            borders: vec![0],
            needed: Vec::new(),
        };
        let mut reach = Reach::new(n, piece);
        for (span, kind) in self.solved.found.equations.mesh.spans.iter().enumerate() {
            // Without bounds there is one arc, so every span is an interval.
            let Span::Interval { arc, length } = *kind else { return Err(Undecided) };
            let h = length * self.durations[arc];
            let mut part = Part { span, from: 0.0, to: h };
            while part.from < h {
                if (self.stops)() {
                    return Err(Undecided);
                }
                let Sampled { over, rough, samples } = self.sampled(extremal, part)?;
                let cut = fields.over.len();
                let mut next = reach.clone().over(&samples);
                if !next.is_disconjugate() && fields.borders[fields.borders.len() - 1] < cut {
                    fields.borders.push(cut);
                    fields.needed.push(cut);
                    next = Reach::new(n, piece).over(&samples);
                }
                if !next.is_disconjugate() {
                    part.to = 0.5 * (part.from + part.to);
                    if part.to - part.from < LEAST_PART * h {
                        return Err(Undecided);
                    }
                    reach = Reach::new(n, piece);
                    continue;
                }
                reach = next;
                fields.times.push(fields.times[cut] + (part.to - part.from));
                fields.at.push(orthonormal(&over * &fields.at[cut]));
                fields.over.push(over);
                fields.rough.extend(rough);
                fields.parts.push(part);
                let border = fields.borders[fields.borders.len() - 1];
                if fields.times[cut + 1] - fields.times[border] >= piece * (1.0 - 1e-9) {
                    fields.borders.push(cut + 1);
                    reach = Reach::new(n, piece);
                }
                part = Part { span, from: part.to, to: h };
            }
        }
        if fields.borders[fields.borders.len() - 1] < fields.over.len() {
            fields.borders.push(fields.over.len());
        }
        Ok(fields)
    }

    /// The transition over a part of a mesh interval, with the Jacobians that it was integrated from.
    fn sampled(&mut self, extremal: &mut dyn Extremal, part: Part) -> Result<Sampled, Undecided> {
        let (states, mut samples) = (extremal.states(), Vec::new());
        let mut sample = |t: f64, jacobian: &[f64]| samples.push(Sample::new(t, states, jacobian));
        let Self { solved, durations, collocated, .. } = self;
        let (over, rough) = match collocated {
            Some(collocated) => {
                let mut along = Along::new(solved, extremal, part.span, durations).ok_or(Undecided)?;
                let evaluate = |t: f64, jacobian: &mut [f64]| {
                    along.jacobian(t, jacobian)?;
                    sample(t, jacobian);
                    Ok(())
                };
                let [halves, whole] = collocated.transitions(part.from..part.to, evaluate)?;
                (halves, Some(whole))
            }
            None => (self.transition(extremal, part, sample)?, None),
        };
        Ok(Sampled { over, rough, samples: ordered(samples) })
    }

    /// The transition matrix over a part of a mesh interval. `sample` is given each Jacobian.
    fn transition(
        &mut self,
        extremal: &mut dyn Extremal,
        Part { span, from, to }: Part,
        mut sample: impl FnMut(f64, &[f64]),
    ) -> Result<DMatrix<f64>, Undecided> {
        let size = 2 * extremal.states();
        let Self { solved, durations, stops, .. } = self;
        let mut along = Along::new(solved, extremal, span, durations).ok_or(Undecided)?;
        let mut jacobian = vec![0.0; size * size];
        let mut matrix = DMatrix::<f64>::identity(size, size);
        let mut integrator = DormandPrince::new(size * size, self.tolerance);
        integrator
            .integrate_until(matrix.as_mut_slice(), from..to, |t, columns, rates| {
                if stops() {
                    return Err(Stopped::Interrupted);
                }
                along.jacobian(t, &mut jacobian)?;
                sample(t, &jacobian);
                for (column, rate) in columns.chunks_exact(size).zip(rates.chunks_exact_mut(size)) {
                    for (rate, row) in rate.iter_mut().zip(jacobian.chunks_exact(size)) {
                        *rate = costate::matrix::dot(row, column);
                    }
                }
                Ok(())
            })
            .map_err(|_| Undecided)?;
        Ok(matrix)
    }
}
