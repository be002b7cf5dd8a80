//! The smallest gap that the costates of a motion with jerks as controls leave.
//!
//! Two things are free in the bound of [`jerk_optimality`](super::jerk_optimality):
//!
//! - Every solution of the equations of the costates gives one. All of them differ by $c_0 + c_1 t + c_2 t^2$
//!   in $\lambda_a$ of each joint, and the gap is a convex function of these three numbers. With
//!   $\lambda_a \ne 0$ at an end the bound is one among motions with the same acceleration there. Those of a
//!   solver are not the best ones: a jerk that changes its sign at a node is optimal on a mesh wherever its
//!   price p does so between the points beside the node.
//! - A part $\alpha$ of the price may be integrated by parts, as $\int \alpha\, \delta j\, dt = -\int
//!   \dot\alpha\, \delta a\, dt$. The cost of torques is curved in a, by $W = \tau_a^\top r \tau_a$, so that
//!   this gains $\tfrac12 \dot\alpha^\top W^{-1} \dot\alpha$ at most. Where the jerk is inside its limits p
//!   is zero but for errors of the mesh; with $\alpha$ = p cut to $\pm \epsilon$ their squares count there,
//!   and $p - \alpha$ elsewhere.

use crate::numerics::lu;

/// What is known at one stage of the integration of the costates.
#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub piece: usize,
    /// s.
    pub time: f64,
    /// What it counts in the integral over time (s).
    pub weight: f64,
    /// $\sum \eta d$.
    pub slack: f64,
    /// p, j and $\dot\lambda_a$ of each joint.
    pub prices: Vec<f64>,
    pub jerks: Vec<f64>,
    pub rates: Vec<f64>,
    /// W; empty where there is none, or where p is not $\lambda_a$.
    pub curvature: Vec<f64>,
}

/// The stages of a motion, backwards in time.
#[derive(Clone, Debug, Default)]
pub(super) struct Stages {
    joints: usize,
    all: Vec<Stage>,
}

/// A joint at one stage, as one of the numbers that [`closest`] looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample {
    time: f64,
    stage: f64,
    price: f64,
    jerk: f64,
}

/// The largest jerk of a joint, and w of its cost `1/2 w j^2`.
type Control = [f64; 2];

/// The jerk that gains most at a price, and what it gains more than this one.
fn best([most, weight]: Control, price: f64, jerk: f64) -> [f64; 2] {
    let best = match weight > 0.0 {
        true => (price / weight).clamp(-most, most),
        false => most.copysign(price),
    };
    let gain = |jerk: f64| price * jerk - 0.5 * weight * jerk * jerk;
    [best, gain(best) - gain(jerk)]
}

/// Parts of the largest price of a joint to which $\alpha$ is cut, the best of which is taken.
const CUTS: [f64; 8] = [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1];

impl Stages {
    pub fn new(joints: usize) -> Self {
        Self { joints, all: Vec::new() }
    }

    pub fn push(&mut self, stage: Stage) {
        self.all.push(stage);
    }

    /// Gives the pieces the gaps of the best choice in each phase.
    pub fn settle(&mut self, controls: &[Control], phase: impl Fn(usize) -> usize, gaps: &mut [f64]) {
        let n = self.joints;
        let mut first = 0;
        let ends: Vec<usize> =
            self.all.chunk_by(|a, b| phase(a.piece) == phase(b.piece)).map(<[Stage]>::len).collect();
        for count in ends {
            let stages = &mut self.all[first..first + count];
            first += count;
            let mut sizes = vec![0.0_f64; n];
            for i in 0..n {
                let sample = |stage: &Stage| Sample {
                    time: stage.time,
                    stage: stage.weight,
                    price: stage.prices[i],
                    jerk: stage.jerks[i],
                };
                let samples: Vec<Sample> = stages.iter().map(sample).collect();
                let [c_0, c_1, c_2] = closest(controls[i], &samples);
                for stage in stages.iter_mut() {
                    stage.prices[i] += c_0 + stage.time * (c_1 + stage.time * c_2);
                    stage.rates[i] += c_1 + 2.0 * stage.time * c_2;
                    sizes[i] = sizes[i].max(stage.prices[i].abs());
                }
            }
            let mut work = Work::new(n);
            let of_cuts = CUTS.map(|cut| -> Option<Vec<f64>> {
                stages.iter().map(|stage| work.gap(stage, controls, &sizes, cut)).collect()
            });
            let total = |of: &Vec<f64>| of.iter().zip(&*stages).map(|(g, s)| s.weight * g.abs()).sum::<f64>();
            let least = of_cuts.iter().flatten().min_by(|a, b| total(a).total_cmp(&total(b)));
            let Some(least) = least else { continue };
            stages.iter().for_each(|stage| gaps[stage.piece] = 0.0);
            for (stage, gap) in stages.iter().zip(least) {
                gaps[stage.piece] += stage.weight * gap;
            }
        }
    }
}

/// Buffers for the gap at one stage.
struct Work {
    curvature: Vec<f64>,
    exchanges: Vec<usize>,
    rates: Vec<f64>,
    solved: Vec<f64>,
}

impl Work {
    fn new(n: usize) -> Self {
        Self { curvature: vec![0.0; n * n], exchanges: vec![0; n], rates: vec![0.0; n], solved: vec![0.0; n] }
    }

    /// The gap with $\alpha$ cut to this part of the sizes; `None` where the cost is not curved.
    fn gap(&mut self, stage: &Stage, controls: &[Control], sizes: &[f64], cut: f64) -> Option<f64> {
        let mut gap = stage.slack;
        for (i, &price) in stage.prices.iter().enumerate() {
            let most = cut * sizes[i];
            let alpha = price.clamp(-most, most);
            gap += best(controls[i], price - alpha, stage.jerks[i])[1];
            self.rates[i] = if price.abs() < most { stage.rates[i] } else { 0.0 };
        }
        if cut > 0.0 {
            if stage.curvature.is_empty() {
                return None;
            }
            self.curvature.copy_from_slice(&stage.curvature);
            let n = self.rates.len();
            if !lu::eliminate(&mut self.curvature, n, n, &mut self.exchanges) {
                return None;
            }
            self.solved.copy_from_slice(&self.rates);
            lu::solve(&self.curvature, n, &self.exchanges, &mut self.solved, 1);
            gap += 0.5 * self.rates.iter().zip(&self.solved).map(|(a, b)| a * b).sum::<f64>();
        }
        Some(gap)
    }
}

/// Weights of jerks that cost nothing, which round the corner of the gap where p changes its sign: so much
/// of the largest |p| over the limit, one after the other.
const ROUNDED: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
/// Newton's steps for each of them.
const STEPS: usize = 8;
/// Most halvings of a step.
const HALVINGS: usize = 6;
/// Added to the diagonal of Newton's matrix, relative to its largest entry, where too few prices are near a
/// corner.
const DAMPING: f64 = 1e-12;

/// The change of $\lambda_a$, $c_0 + c_1 t + c_2 t^2$, with the smallest sum of gaps of one joint; zero where
/// none is smaller than that of the costates as they are.
fn closest(control: Control, samples: &[Sample]) -> [f64; 3] {
    let size = samples.iter().fold(0.0, |most: f64, sample| most.max(sample.price.abs()));
    let ends = samples.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[from, to], sample| {
        [from.min(sample.time), to.max(sample.time)]
    });
    let length = ends[1] - ends[0];
    // Not true for NaN.
    if !(size > 0.0 && size.is_finite() && length > 0.0) {
        return [0.0; 3];
    }
    // In the part x of the time between the first and the last sample.
    let basis = |sample: &Sample| {
        let x = (sample.time - ends[0]) / length;
        [1.0, x, x * x]
    };
    let price = |sample: &Sample, c: &[f64; 3]| {
        sample.price + basis(sample).iter().zip(c).map(|(a, b)| a * b).sum::<f64>()
    };
    let [most, weight] = control;
    let sum = |c: &[f64; 3], weight: f64| -> f64 {
        let of = |sample: &Sample| sample.stage * best([most, weight], price(sample, c), sample.jerk)[1];
        samples.iter().map(of).sum()
    };
    let mut c = [0.0; 3];
    for rounded in ROUNDED {
        let weight = weight.max(rounded * size / most);
        for _ in 0..STEPS {
            let (mut gradient, mut matrix) = ([0.0; 3], [[0.0; 3]; 3]);
            for sample in samples {
                let [best, _] = best([most, weight], price(sample, &c), sample.jerk);
                let b = basis(sample);
                let curvature = if best.abs() < most { sample.stage / weight } else { 0.0 };
                for i in 0..3 {
                    gradient[i] += sample.stage * (best - sample.jerk) * b[i];
                    for j in 0..3 {
                        matrix[i][j] += curvature * b[i] * b[j];
                    }
                }
            }
            let Some(step) = newton_step(matrix, gradient) else { break };
            let before = sum(&c, weight);
            let tried = (0..HALVINGS).map(|k| {
                let part = 0.5_f64.powi(k as i32);
                std::array::from_fn(|i| c[i] + part * step[i])
            });
            match tried.into_iter().find(|tried| sum(tried, weight) < before) {
                Some(better) => c = better,
                None => break,
            }
        }
    }
    if sum(&c, weight) < sum(&[0.0; 3], weight) {
        // In powers of the time.
        let ([c_0, c_1, c_2], from) = ([c[0], c[1] / length, c[2] / (length * length)], ends[0]);
        return [c_0 - c_1 * from + c_2 * from * from, c_1 - 2.0 * c_2 * from, c_2];
    }
    [0.0; 3]
}

/// `-matrix^-1 gradient`; `None` for a matrix without size.
fn newton_step(mut matrix: [[f64; 3]; 3], gradient: [f64; 3]) -> Option<[f64; 3]> {
    let size = (0..3).fold(0.0, |most: f64, i| most.max(matrix[i][i]));
    (0..3).for_each(|i| matrix[i][i] += DAMPING * size);
    let mut flat = matrix.concat();
    let mut exchanges = [0; 3];
    let mut step = gradient.map(|entry| -entry);
    (size > 0.0 && lu::eliminate(&mut flat, 3, 3, &mut exchanges)).then(|| {
        lu::solve(&flat, 3, &exchanges, &mut step, 1);
        step
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of the gaps of a joint with other costates.
    fn gap(control: Control, samples: &[Sample], [c_0, c_1, c_2]: [f64; 3]) -> f64 {
        let price = |sample: &Sample| sample.price + c_0 + sample.time * (c_1 + sample.time * c_2);
        samples.iter().map(|sample| sample.stage * best(control, price(sample), sample.jerk)[1]).sum()
    }

    /// A jerk of 32 that changes its sign at 1/4 and 3/4, with a price that does so elsewhere: the quadratic
    /// that is closest vanishes at both, and leaves next to no gap.
    #[test]
    fn prices_change_their_sign_where_the_jerk_does() {
        let sample = |i: i32| {
            let time = (f64::from(i) + 0.5) / 400.0;
            let jerk = if (time - 0.5).abs() < 0.25 { -32.0 } else { 32.0 };
            let price = 0.2 * (time - 0.27) * (time - 0.76) + 3e-3 * time;
            Sample { time, stage: 2.5e-3, price, jerk }
        };
        let (samples, control) = ((0..400).map(sample).collect::<Vec<_>>(), [32.0, 0.0]);
        let found = closest(control, &samples);
        let (before, after) = (gap(control, &samples, [0.0; 3]), gap(control, &samples, found));
        assert!(before > 1e-3 && (-1e-15..1e-3 * before).contains(&after), "{before} {after}");
    }

    /// Where jerks cost something and the price is that of the jerk plus a quadratic, that is found.
    #[test]
    fn a_quadratic_in_the_price_is_taken_out() {
        let sample = |i: i32| {
            let time = 2.0 + f64::from(i) / 50.0;
            let jerk = (3.0 * time).sin();
            let price = 2.0 * jerk + 0.1 - 0.3 * time + 0.2 * time * time;
            Sample { time, stage: 0.02, price, jerk }
        };
        let (samples, control) = ((0..50).map(sample).collect::<Vec<_>>(), [5.0, 2.0]);
        let found = closest(control, &samples);
        assert!(gap(control, &samples, [0.0; 3]) > 1e-3, "nothing to find");
        assert!(gap(control, &samples, found) < 1e-12, "{found:?}");
    }

    /// A price that is off by 1e-6 sin(9 t) where the jerk is inside its limits of 10 costs
    /// `1/2 int (9e-6 cos)^2 / W` beside the curvature W = 4, and 1e-5 and more without it.
    #[test]
    fn small_prices_inside_of_limits_count_by_their_squares() {
        let stages = |curved: bool| {
            let mut stages = Stages::new(1);
            for i in (0..2000).rev() {
                let time = (f64::from(i) + 0.5) / 1000.0;
                // Behind 1 the jerk is at its limit, with a price.
                let (price, rate, jerk) = match time < 1.0 {
                    true => (1e-6 * (9.0 * time).sin(), 9e-6 * (9.0 * time).cos(), 0.0),
                    false => (1.0 + time, 1.0, 10.0),
                };
                stages.push(Stage {
                    piece: 0,
                    time,
                    weight: 1e-3,
                    slack: 0.0,
                    prices: vec![price],
                    jerks: vec![jerk],
                    rates: vec![rate],
                    curvature: if curved { vec![4.0] } else { Vec::new() },
                });
            }
            let mut gaps = [0.0];
            stages.settle(&[[10.0, 0.0]], |_| 0, &mut gaps);
            gaps[0]
        };
        assert!(stages(false) > 3e-6, "{}", stages(false));
        let exact = 0.125 * 81e-12 * (0.5 + 18_f64.sin() / 36.0);
        assert!(stages(true) < 1.1 * exact + 2e-9, "{} {exact}", stages(true));
    }
}
