//! Positions at which tools are where they shall be.

pub(crate) mod branches;
pub(crate) mod slide;

use super::functions::{PathFunction, TaskFunctions};
use crate::constants::task::reach::{DAMPING, FAR, MOST_DAMPING, OTHERS, REACHED, STARTS, STEPS, STILL};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// The position that was found, and what is left.
#[derive(Clone, Debug)]
pub(crate) struct Reached {
    /// q, the given entries as they were.
    pub q: Vec<f64>,
    /// The row that is farthest off, and by how much (m, rad).
    pub worst: usize,
    pub miss: f64,
}

impl Reached {
    pub fn is_there(&self) -> bool {
        self.miss <= REACHED
    }
}

/// The search: damped Gauss-Newton steps in the free coordinates, cut to their limits.
struct Search<'a> {
    functions: &'a mut TaskFunctions,
    /// The free coordinates.
    free: &'a [usize],
    limits: &'a [[f64; 2]],
    /// Most steps of a descent.
    steps: usize,
    still: Vec<f64>,
    g: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
}

/// Looks for a position in the limits at which all rows have their values: from q first, then from seeded
/// ones; from the `first`-th of these at once, if that is not 0. What comes closest, if there is none.
pub(crate) fn reach(
    functions: &mut TaskFunctions,
    q: &[f64],
    free: &[usize],
    limits: &[[f64; 2]],
    first: usize,
) -> Reached {
    let mut search = Search::new(functions, free, limits);
    let mut best = Reached { q: q.to_vec(), worst: 0, miss: f64::INFINITY };
    for start in first..first + STARTS {
        if best.is_there() {
            break;
        }
        if start == 0 {
            best = search.descend(q.to_vec());
            continue;
        }
        let found = search.descend(seeded_position(start, q, free, limits));
        if found.miss < best.miss {
            best = found;
        }
    }
    best
}

/// A row that no free coordinate changes, neither at q nor at a position beside it, if there is one.
pub(crate) fn immovable(functions: &mut TaskFunctions, q: &[f64], free: &[usize]) -> Option<usize> {
    let (rows, width) = (functions.rows(), 2 * q.len());
    let (still, none) = (vec![0.0; q.len()], vec![0.0; rows]);
    let mut beside = q.to_vec();
    free.iter().zip(1..).for_each(|(&i, k)| beside[i] += 0.3 * f64::from(k).sqrt());
    let mut moved = vec![false; rows];
    for q in [q, &beside] {
        let (mut g, mut jacobian) = (vec![0.0; rows], vec![0.0; rows * width]);
        let mut hessian = vec![0.0; width * width];
        functions.contract(q, &still, &none, &mut g, &mut jacobian, &mut hessian).ok()?;
        for (moved, row) in moved.iter_mut().zip(jacobian.chunks_exact(width)) {
            *moved |= free.iter().any(|&i| row[i].abs() > STILL);
        }
    }
    moved.iter().position(|moved| !moved)
}

/// A position between limits, or within a half turn where there are none: multiples of the golden ratio,
/// which cover the range evenly.
fn seeded(start: usize, coordinate: usize, [low, high]: [f64; 2], near: f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_894_8;
    let part = ((start * (2 * coordinate + 1)) as f64 * RATIO + 0.37 * coordinate as f64).fract();
    let half_turn = std::f64::consts::PI;
    let low = low.max(near.min(high) - half_turn);
    let high = high.min(near.max(low) + half_turn);
    low + part * (high - low)
}

/// A position whose free coordinates are seeded.
fn seeded_position(start: usize, near: &[f64], free: &[usize], limits: &[[f64; 2]]) -> Vec<f64> {
    let mut q = near.to_vec();
    for &i in free {
        q[i] = seeded(start, i, limits[i], near[i]);
    }
    q
}

/// The same, near q: turned back by whole turns towards it, as far as limits and tools allow. If what is
/// found first from q itself is [`FAR`] from it, others are looked for, and the one to which the joints turn
/// least is taken.
pub(crate) fn reach_near(
    functions: &mut TaskFunctions,
    near: &[f64],
    free: &[usize],
    limits: &[[f64; 2]],
    first: usize,
) -> Reached {
    let found = reach(functions, near, free, limits, first);
    let mut search = Search::new(functions, free, limits);
    let mut best = search.turned_back(found, near);
    let far = |found: &Reached| free.iter().map(|&i| (found.q[i] - near[i]).abs()).fold(0.0, f64::max);
    if first > 0 || !best.is_there() || far(&best) <= FAR {
        return best;
    }
    for start in 1..=OTHERS {
        let found = search.descend(seeded_position(start, near, free, limits));
        let found = search.turned_back(found, near);
        let way = |found: &Reached| free.iter().map(|&i| (found.q[i] - near[i]).powi(2)).sum::<f64>();
        if found.is_there() && way(&found) < way(&best) {
            best = found;
        }
    }
    best
}

impl<'a> Search<'a> {
    fn new(functions: &'a mut TaskFunctions, free: &'a [usize], limits: &'a [[f64; 2]]) -> Self {
        let (rows, width) = (functions.rows(), 2 * limits.len());
        Self {
            still: vec![0.0; limits.len()],
            g: vec![0.0; rows],
            jacobian: vec![0.0; rows * width],
            hessian: vec![0.0; width * width],
            functions,
            free,
            limits,
            steps: STEPS,
        }
    }

    /// The same pose with each free coordinate within half a turn of that at `near`, or as close to it as its
    /// limits allow. A coordinate whose whole turns move the tool, of a prismatic joint or one with mimics,
    /// stays.
    pub fn turned_back(&mut self, found: Reached, near: &[f64]) -> Reached {
        let mut turned = found;
        for &i in self.free {
            let ([low, high], q) = (self.limits[i], turned.q[i]);
            let turns = |places: f64| (places / TAU).floor().max(0.0);
            let wanted = ((near[i] - q) / TAU).round();
            let turns = wanted.clamp(-turns(q - low), turns(high - q));
            if turns == 0.0 || turns.is_nan() {
                continue;
            }
            let mut other = turned.q.clone();
            other[i] += turns * TAU;
            let miss = self.values(&other).amax();
            if miss <= turned.miss.max(REACHED) {
                turned.q = other;
            }
        }
        turned
    }

    /// Descends from a position.
    fn descend(&mut self, mut q: Vec<f64>) -> Reached {
        for &i in self.free {
            q[i] = q[i].max(self.limits[i][0]).min(self.limits[i][1]);
        }
        let (mut damping, mut residuals) = (DAMPING, self.linearise(&q));
        for _ in 0..self.steps {
            if residuals.amax() <= 0.1 * REACHED || damping > MOST_DAMPING {
                break;
            }
            let Some(trial) = self.step(&q, &residuals, damping) else { break };
            let found = self.values(&trial);
            if found.norm() < residuals.norm() {
                q = trial;
                residuals = self.linearise(&q);
                damping *= 0.1;
            } else {
                damping = 10.0 * damping.max(DAMPING);
            }
        }
        let (worst, miss) = residuals
            .iter()
            .map(|r| r.abs())
            .enumerate()
            .fold((0, 0.0), |worst, (i, r)| if r > worst.1 || r.is_nan() { (i, r) } else { worst });
        Reached { q, worst, miss: if miss.is_nan() { f64::INFINITY } else { miss } }
    }

    /// `dq = -J' (J J' + damping)^-1 r` over the coordinates that may move: not those at a limit that the
    /// step would leave.
    fn step(&self, q: &[f64], residuals: &DVector<f64>, damping: f64) -> Option<Vec<f64>> {
        let (rows, width) = (residuals.len(), 2 * q.len());
        let mut moving = self.free.to_vec();
        for _ in 0..=self.free.len() {
            let jacobian = DMatrix::from_fn(rows, moving.len(), |r, k| self.jacobian[width * r + moving[k]]);
            let mut square = &jacobian * jacobian.transpose();
            (0..rows).for_each(|r| square[(r, r)] += damping);
            let step = -(jacobian.transpose() * square.cholesky()?.solve(residuals));
            let leaves = |k: usize| {
                let ([low, high], i) = (self.limits[moving[k]], moving[k]);
                (q[i] <= low && step[k] < 0.0) || (q[i] >= high && step[k] > 0.0)
            };
            let stay: Vec<usize> = (0..moving.len()).filter(|&k| !leaves(k)).map(|k| moving[k]).collect();
            if stay.len() == moving.len() {
                let mut trial = q.to_vec();
                for (&i, step) in moving.iter().zip(step.iter()) {
                    trial[i] = (q[i] + step).max(self.limits[i][0]).min(self.limits[i][1]);
                }
                return Some(trial);
            }
            moving = stay;
        }
        None
    }

    fn residuals(&self) -> DVector<f64> {
        let rows = self.functions.bounds().iter().zip(&self.g);
        DVector::from_iterator(self.g.len(), rows.map(|(row, g)| g - row.lower))
    }

    /// Residuals, infinite where q cannot be evaluated.
    fn values(&mut self, q: &[f64]) -> DVector<f64> {
        if self.functions.values(q, &self.still, &mut self.g).is_err() {
            self.g.fill(f64::INFINITY);
        }
        self.residuals()
    }

    /// The same with the Jacobian.
    fn linearise(&mut self, q: &[f64]) -> DVector<f64> {
        let Self { functions, still, g, jacobian, hessian, .. } = self;
        let none = vec![0.0; g.len()];
        if functions.contract(q, still, &none, g, jacobian, hessian).is_err() {
            g.fill(f64::INFINITY);
        }
        self.residuals()
    }
}

#[cfg(test)]
mod tests;
