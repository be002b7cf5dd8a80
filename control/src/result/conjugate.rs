//! Conjugate times with their multiplicity, from the Jacobi fields along an extremal.
//!
//! Jacobi fields solve $(\delta x, \delta y)' = G (\delta x, \delta y)$ with the Jacobian $G$ of the extremal. A time
//! $t_c$ is conjugate to the start with multiplicity m when m independent fields with $\delta x(0) = 0$ have
//! $\delta x(t_c) = 0$ as well. The Morse index of the motion is the number of conjugate times before T, each counted
//! with its multiplicity. With fields $X, Y$ at $t_i$ that start from $X(0) = 0$, $Y(0) = 1$, and the transition matrix
//! $[A\ B;\ C\ D]$ from $t_i$ to $t_j$,
//!
//! $$ X_j = B \thinspace \bigl(B^{-1} A + Y_i X_i^{-1}\bigr) \thinspace X_i , $$
//!
//! and both terms in the bracket are symmetric. As long as $[t_i, t_j]$ holds no pair of conjugate times of its own, the
//! number of conjugate times in $(t_i, t_j]$ is the number of eigenvalues of the bracket that are not positive. A sign of
//! a determinant would miss those of even multiplicity.

use crate::bvp::mesh::Span;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::DormandPrince;
use crate::result::motion::Certificate;
use crate::solve::Solved;
use nalgebra::{DMatrix, DVector};

/// Parts of the motion over which conjugate times are counted; the count must be the same over half as many.
const PIECES: usize = 32;
/// Relative tolerance of one integration step.
const TOLERANCE: f64 = 1e-11;
/// The same for a first look, which is enough where there are clearly no conjugate times.
const LOOSE: f64 = 1e-8;
/// There are clearly none where each eigenvalue is so many times as large as the error: the tolerance, or more where the
/// asymmetry shows more.
const CLEAR: f64 = 100.0;
/// Relative asymmetry of `B^-1 A` above which rounding decides: nothing is claimed then.
const MOST_ASYMMETRY: f64 = 1e-4;
/// Eigenvalues up to this fraction of the largest one count as not positive.
const ZERO: f64 = 1e-12;
/// The conjugate time is located to this fraction of a mesh interval.
const LOCATED: f64 = 1e-10;

/// Why conjugate times could not be counted.
struct Undecided;

/// A conjugate time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conjugate {
    /// Time (s).
    pub time: f64,
    /// Number of independent fields that vanish there.
    pub multiplicity: usize,
}

/// The fields at one node, 2N x N, with orthonormal columns: only their span matters.
fn orthonormal(fields: DMatrix<f64>) -> DMatrix<f64> {
    fields.qr().q()
}

/// A symmetric matrix with the signs of the bracket.
struct Bracket {
    form: DMatrix<f64>,
    /// The sizes of the two terms of each entry of its diagonal.
    sizes: DVector<f64>,
}

/// The bracket of a part of the motion, up to a congruence: `fields` at its start, `transition` to its end. `None` where
/// the fields start from zero.
fn bracket(fields: &DMatrix<f64>, transition: &DMatrix<f64>) -> Result<Option<Bracket>, Undecided> {
    let n = fields.ncols();
    let (x, y) = (fields.rows(0, n), fields.rows(n, n));
    if x.amax() == 0.0 {
        return Ok(None);
    }
    let (a, b) = (transition.view((0, 0), (n, n)), transition.view((0, n), (n, n)));
    let quotient = b.into_owned().lu().solve(&a.into_owned()).ok_or(Undecided)?;
    let asymmetry = (&quotient - quotient.transpose()).amax() / quotient.amax();
    if asymmetry.is_nan() || asymmetry > MOST_ASYMMETRY {
        return Err(Undecided);
    }
    // A congruence with X keeps the signs, and exists where X is singular too.
    let (of_fields, of_transition) = (x.transpose() * y, x.transpose() * quotient * x);
    let sizes = of_fields.diagonal().abs() + of_transition.diagonal().abs();
    Ok(Some(Bracket { form: of_fields + of_transition, sizes }))
}

/// Conjugate times in a part of the motion.
fn count(fields: &DMatrix<f64>, transition: &DMatrix<f64>) -> Result<usize, Undecided> {
    let Some(Bracket { form, .. }) = bracket(fields, transition)? else { return Ok(0) };
    let eigenvalues = (0.5 * (&form + form.transpose())).symmetric_eigenvalues();
    let bound = ZERO * eigenvalues.amax();
    Ok(eigenvalues.iter().filter(|&&value| value <= bound).count())
}

/// Whether a part of the motion clearly has no conjugate time. The bracket is scaled by the size of the two terms of its
/// diagonal, which makes its eigenvalues comparable: small ones are differences of large terms.
fn is_clear(fields: &DMatrix<f64>, transition: &DMatrix<f64>) -> Result<bool, Undecided> {
    let Some(Bracket { mut form, sizes }) = bracket(fields, transition)? else { return Ok(true) };
    for (i, j) in (0..sizes.len()).flat_map(|i| (0..sizes.len()).map(move |j| (i, j))) {
        form[(i, j)] /= (sizes[i] * sizes[j]).sqrt();
    }
    if form.iter().any(|entry| !entry.is_finite()) {
        return Ok(false);
    }
    let error = (&form - form.transpose()).amax().max(LOOSE);
    let eigenvalues = (0.5 * (&form + form.transpose())).symmetric_eigenvalues();
    Ok(eigenvalues.min() > CLEAR * error)
}

/// The fields and transition matrices of a motion, node by node.
struct Fields {
    /// Times of the nodes (s).
    times: Vec<f64>,
    /// Fields at the nodes.
    at: Vec<DMatrix<f64>>,
    /// Transition over each mesh interval.
    over: Vec<DMatrix<f64>>,
}

impl Fields {
    /// Transition from node i to node j.
    fn transition(&self, i: usize, j: usize) -> DMatrix<f64> {
        let size = self.at[0].nrows();
        self.over[i..j].iter().fold(DMatrix::identity(size, size), |product, next| next * product)
    }

    /// Nodes that divide the motion into about so many pieces of the same duration.
    fn borders(&self, pieces: usize) -> Vec<usize> {
        let last = self.times.len() - 1;
        let length = self.times[last] / pieces as f64;
        let mut borders = vec![0];
        for i in 1..=last {
            let from = self.times[borders[borders.len() - 1]];
            if i == last || self.times[i] - from >= length * (1.0 - 1e-9) {
                borders.push(i);
            }
        }
        borders
    }

    /// The number of conjugate times in each piece.
    fn counts(&self, borders: &[usize]) -> Result<Vec<usize>, Undecided> {
        borders.windows(2).map(|ends| count(&self.at[ends[0]], &self.transition(ends[0], ends[1]))).collect()
    }

    /// Whether no piece has a conjugate time, by a margin that covers the errors of the integration.
    fn are_clear(&self, borders: &[usize]) -> Result<bool, Undecided> {
        for ends in borders.windows(2) {
            if !is_clear(&self.at[ends[0]], &self.transition(ends[0], ends[1]))? {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Solved {
    /// The first conjugate time up to T, and what the count of all of them says about the motion.
    ///
    /// Only for ends that fix all states and controls that stay within their bounds; else
    /// [`Certificate::NotChecked`].
    pub(crate) fn second_variation<E: Extremal>(&self, extremal: &mut E) -> (Option<Conjugate>, Certificate) {
        let bounded = self.found.arcs.sides.iter().any(Option::is_some) || self.found.excess(extremal) >= 1.0;
        if bounded || !extremal.ends_are_fixed() {
            return (None, Certificate::NotChecked);
        }
        match self.first_conjugate(extremal) {
            Ok(None) => (None, Certificate::LocalMinimum),
            Ok(found) => (found, Certificate::NotMinimal),
            Err(Undecided) => (None, Certificate::NotChecked),
        }
    }

    fn first_conjugate<E: Extremal>(&self, extremal: &mut E) -> Result<Option<Conjugate>, Undecided> {
        let durations = self.found.durations(2 * extremal.states());
        let mut transitions = Transitions { solved: self, durations, tolerance: LOOSE };
        if transitions.show_clearly_none(extremal) {
            return Ok(None);
        }
        transitions.tolerance = TOLERANCE;
        let fields = transitions.fields(extremal)?;
        let borders = fields.borders(PIECES);
        let counts = fields.counts(&borders)?;
        let coarse = fields.counts(&fields.borders(PIECES / 2))?;
        if counts.iter().sum::<usize>() != coarse.iter().sum::<usize>() {
            return Err(Undecided);
        }
        let Some(piece) = counts.iter().position(|&count| count > 0) else { return Ok(None) };
        // Counted from the border before, so that no transition is over a very short time.
        let from = borders[if piece >= 2 { piece - 1 } else { piece }];
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

/// Integrates the Jacobi fields of a motion.
struct Transitions<'a> {
    solved: &'a Solved,
    /// Duration of each arc (s).
    durations: Vec<f64>,
    /// Relative tolerance of one integration step.
    tolerance: f64,
}

impl Transitions<'_> {
    /// Whether no piece of the motion has a conjugate time, by a margin.
    fn show_clearly_none<E: Extremal>(&self, extremal: &mut E) -> bool {
        let clear = |fields: Fields| {
            Ok(fields.are_clear(&fields.borders(PIECES))? && fields.are_clear(&fields.borders(PIECES / 2))?)
        };
        self.fields(extremal).and_then(clear).unwrap_or(false)
    }

    /// The conjugate time in mesh interval `k`; `before` is the transition from the node of `fields` to its start.
    fn locate<E: Extremal>(
        &self,
        extremal: &mut E,
        k: usize,
        all: &Fields,
        fields: &DMatrix<f64>,
        before: DMatrix<f64>,
    ) -> Result<Conjugate, Undecided> {
        let h = all.times[k + 1] - all.times[k];
        let (mut from, mut to, mut at_from) = (0.0, h, before);
        let mut multiplicity = count(fields, &(&all.over[k] * &at_from))?;
        while to - from > LOCATED * h {
            let middle = 0.5 * (from + to);
            let at_middle = self.transition(extremal, k, from, middle)? * &at_from;
            match count(fields, &at_middle)? {
                0 => (from, at_from) = (middle, at_middle),
                found => (to, multiplicity) = (middle, found),
            }
        }
        Ok(Conjugate { time: all.times[k] + 0.5 * (from + to), multiplicity })
    }

    fn fields<E: Extremal>(&self, extremal: &mut E) -> Result<Fields, Undecided> {
        let n = extremal.states();
        let mut start = DMatrix::zeros(2 * n, n);
        start.rows_mut(n, n).fill_with_identity();
        let mut fields = Fields { times: vec![0.0], at: vec![start], over: Vec::new() };
        for (k, span) in self.solved.found.equations.mesh.spans.iter().enumerate() {
            // Without bounds there is one arc, so every span is an interval.
            let Span::Interval { arc, length } = *span else { return Err(Undecided) };
            let h = length * self.durations[arc];
            let over = self.transition(extremal, k, 0.0, h)?;
            let next = orthonormal(&over * &fields.at[k]);
            fields.times.push(fields.times[k] + h);
            fields.at.push(next);
            fields.over.push(over);
        }
        Ok(fields)
    }

    /// The transition matrix over a part of a mesh interval, in seconds from its start.
    fn transition<E: Extremal>(
        &self,
        extremal: &mut E,
        span: usize,
        from: f64,
        to: f64,
    ) -> Result<DMatrix<f64>, Undecided> {
        let size = 2 * extremal.states();
        let Span::Interval { arc, length } = self.solved.found.equations.mesh.spans[span] else {
            return Err(Undecided);
        };
        let h = length * self.durations[arc];
        let law = self.solved.found.arcs.law(arc);
        let (mut w, mut g) = (vec![0.0; self.solved.found.equations.m], vec![0.0; size]);
        let mut jacobian = vec![0.0; size * size];
        let mut matrix = DMatrix::<f64>::identity(size, size);
        let mut integrator = DormandPrince::new(size * size, self.tolerance);
        integrator
            .integrate(matrix.as_mut_slice(), from..to, |t, columns, rates| {
                self.solved.found.equations.polynomial(span, t / h, &mut w);
                extremal.linearise(&w[..size], law, &mut g, &mut jacobian)?;
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
