//! The control that maximises the Hamiltonian.

use crate::extremal::relaxation::smoothing_price;
use crate::extremal::{BoundSide, ControlLaw, ControlRange, Relaxation, SideChange};
use crate::problem::{Bounds, Problem};
use costate::scalar::Scalar;

/// $u_i = \mathrm{clip}(r_i^{-1} b_i y_{p,i})$. As $b_i y_{p,i} u_i - \frac12 r_i u_i^2$ is concave in $u_i$,
/// its maximum within the bounds is the point nearest to its free maximum.
///
/// Controls that cost nothing jump from bound to bound. A [relaxed](Relaxation) problem makes them smooth by
/// the cost
///
/// $$ r w^2 \left( s \\, \mathrm{artanh} \\, s + \tfrac12 \log(1 - s^2) \right), \qquad s = (u - m) / w $$
///
/// with m the middle and w half the distance of the bounds. Near m it is $\frac12 r (u - m)^2$, and the
/// maximum is at $u = m + w \tanh(b y_p / (r w))$.
#[derive(Clone, Debug)]
pub(crate) struct Actuation {
    /// b_i.
    pub gain: Vec<f64>,
    /// r_i.
    pub effort: Vec<f64>,
    /// Lower and upper bounds.
    pub bounds: Vec<ControlRange>,
    /// Ranges of the controls that have the smooth cost now.
    smooth: Vec<Option<SmoothRange>>,
}

/// The range of a control with the smooth cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SmoothRange {
    /// m.
    pub middle: f64,
    /// w; infinite without bounds.
    pub width: f64,
}

/// A switching function and its slope in y_p of the control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Switching {
    pub value: f64,
    pub slope: f64,
}

/// A control and its cost.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control<S> {
    pub u: S,
    /// du / d(b y_p).
    pub slope: S,
    /// Its running cost.
    pub cost: S,
    /// Its running cost that only the relaxed problem has.
    pub smoothing: S,
}

impl Actuation {
    /// The actuation of a problem.
    pub fn new(problem: &Problem) -> Self {
        Self::of_parts(problem.gain.clone(), problem.cost.effort.clone(), problem.bounds.as_ref())
    }

    /// With these gains b_i, weights r_i and bounds.
    pub fn of_parts(gain: Vec<f64>, effort: Vec<f64>, bounds: Option<&Bounds>) -> Self {
        let range = |(&low, &high): (&f64, &f64)| ControlRange { low, high };
        let bounds = match bounds {
            Some(bounds) => bounds.u_min.iter().zip(&bounds.u_max).map(range).collect(),
            None => vec![ControlRange::UNBOUNDED; effort.len()],
        };
        Self { smooth: vec![None; effort.len()], gain, effort, bounds }
    }

    /// Widens the bounds of `original`, and gives a cost to controls that have none. At
    /// `relaxation.effort = 1` staying at a bound costs about as much as time.
    pub fn relax(&mut self, original: &Self, time_cost: f64, relaxation: Relaxation) {
        let price = smoothing_price(time_cost);
        for (i, &bounds) in original.bounds.iter().enumerate() {
            let ControlRange { low, high } = bounds;
            let (middle, half) = (0.5 * (low + high), bounds.half_width());
            let further = (relaxation.bounds - 1.0) * half;
            self.bounds[i] = match relaxation.bounds == 1.0 {
                true => bounds,
                false => ControlRange { low: low - further, high: high + further },
            };
            (self.effort[i], self.smooth[i]) = match original.effort[i] {
                0.0 if relaxation.effort > 0.0 => (
                    relaxation.effort * 2.0 * price / (half * half),
                    Some(SmoothRange { middle, width: relaxation.bounds * half }),
                ),
                effort => (
                    effort,
                    original.smooth[i]
                        .map(|range| SmoothRange { width: relaxation.bounds * range.width, ..range }),
                ),
            };
        }
    }

    /// The bounds that a control reaches: none where the original actuation is smooth, whose controls only
    /// come near them.
    pub fn reached_bounds(&self, original: &Self, i: usize) -> ControlRange {
        if original.smooth[i].is_some() { ControlRange::UNBOUNDED } else { self.bounds[i] }
    }

    /// `r_i^-1 b_i y_p,i`; infinite, or zero with y_p,i, for r_i = 0.
    pub fn unbounded(&self, i: usize, y_p: f64) -> f64 {
        let pull = self.gain[i] * y_p;
        let middle = self.smooth[i].map_or(0.0, |range| range.middle);
        if pull == 0.0 { middle } else { middle + pull / self.effort[i] }
    }

    /// u_i and its cost.
    pub fn control(&self, i: usize, y_p: f64, law: ControlLaw<'_>) -> Control<f64> {
        let sides = match (law, self.smooth[i]) {
            (ControlLaw::Maximal, None) => return self.maximal(i, y_p),
            (ControlLaw::Maximal, Some(range)) => {
                return self.smoothed(i, self.unbounded(i, y_p) - range.middle, range);
            }
            (ControlLaw::Given(sides), _) => sides,
        };
        let ControlRange { low, high } = self.bounds[i];
        let (u, slope) = match sides[i] {
            BoundSide::Low => (low, 0.0),
            BoundSide::Inside => (self.unbounded(i, y_p), self.effort[i].recip()),
            BoundSide::High => (high, 0.0),
        };
        Control { u, slope, cost: 0.5 * self.effort[i] * u * u, smoothing: 0.0 }
    }

    /// `u_i = clip(r_i^-1 b_i y_p,i)`; for r_i = 0 the bound that has the sign of b_i y_p,i.
    pub fn maximal<S: Scalar>(&self, i: usize, y_p: S) -> Control<S> {
        let (ControlRange { low, high }, r) = (self.bounds[i], self.effort[i]);
        let (pull, zero) = (y_p.times(self.gain[i]), S::zero());
        let (mut u, mut slope, at_low, at_high) = if r == 0.0 {
            (S::from_f64(0.0_f64.clamp(low, high)), zero, pull.less(zero), zero.less(pull))
        } else {
            let u = pull / S::from_f64(r);
            (u, S::from_f64(r.recip()), u.less(S::from_f64(low)), S::from_f64(high).less(u))
        };
        for (mask, bound) in [(at_low, low), (at_high, high)] {
            if bound.is_finite() {
                (u, slope) = (S::select(mask, S::from_f64(bound), u), S::select(mask, zero, slope));
            }
        }
        Control { u, slope, cost: (u * u).times(0.5 * r), smoothing: zero }
    }

    /// The smooth control for `free = b y_p / r`.
    fn smoothed(&self, i: usize, free: f64, SmoothRange { middle, width }: SmoothRange) -> Control<f64> {
        let r = self.effort[i];
        if width.is_infinite() {
            let smoothing = 0.5 * r * free * free;
            return Control { u: middle + free, slope: r.recip(), cost: 0.0, smoothing };
        }
        let argument = free / width;
        let s = argument.tanh();
        // 1/2 log(1 - s^2) = -log cosh, without cancellation.
        let size = argument.abs();
        let log_cosh = size + (-2.0 * size).exp().ln_1p() - std::f64::consts::LN_2;
        let smoothing = r * width * width * (s * argument - log_cosh);
        let cosh = log_cosh.exp();
        Control { u: middle + width * s, slope: (r * cosh * cosh).recip(), cost: 0.0, smoothing }
    }

    /// `b_i y_p,i - r_i u_i` at the bound that is reached or left, and its slope in y_p,i; between two bounds
    /// `b_i y_p,i`.
    pub fn switching(&self, i: usize, change: SideChange, y_p: f64) -> Switching {
        let ControlRange { low, high } = self.bounds[i];
        let bound = match (change.before, change.after) {
            (BoundSide::Low, BoundSide::High) | (BoundSide::High, BoundSide::Low) => 0.0,
            (BoundSide::Low, _) | (_, BoundSide::Low) => low,
            (BoundSide::High, _) | (_, BoundSide::High) => high,
            (BoundSide::Inside, BoundSide::Inside) => 0.0,
        };
        Switching { value: self.gain[i] * y_p - self.effort[i] * bound, slope: self.gain[i] }
    }
}
