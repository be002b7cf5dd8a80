//! What solving again can begin at beside the last iterate: the last motion that was solved, the first guess.

use super::resolved::ResolveStatus;
use crate::direct::interior::figures::Figures;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::spline::Spline;
use crate::direct::solve::prepare::Dynamics;

/// A motion with its slacks and multipliers.
#[derive(Clone, Debug, Default)]
pub(super) struct Place {
    pub spline: Spline,
    slack: Vec<f64>,
    multiplier: Vec<f64>,
    mu: f64,
    stiffness: f64,
    pub figures: Figures,
}

impl Place {
    /// Takes an iterate; allocates only the first time.
    pub fn take(&mut self, iterate: &Interior<Dynamics>) {
        self.spline.copy_from(&iterate.spline);
        self.slack.clone_from(&iterate.barrier.slack);
        self.multiplier.clone_from(&iterate.barrier.multiplier);
        (self.mu, self.stiffness) = (iterate.mu, iterate.barrier.stiffness);
        self.figures = iterate.figures;
    }

    /// Makes it the iterate. The number of steps goes on.
    pub fn put(&self, iterate: &mut Interior<Dynamics>) {
        iterate.spline.copy_from(&self.spline);
        iterate.barrier.slack.clone_from(&self.slack);
        iterate.barrier.multiplier.clone_from(&self.multiplier);
        (iterate.mu, iterate.barrier.stiffness) = (self.mu, self.stiffness);
        let iterations = iterate.figures.iterations;
        iterate.figures = Figures { iterations, ..self.figures };
    }
}

/// What a solve can begin at beside the last iterate.
#[derive(Clone, Debug, Default)]
pub(super) struct Recovery {
    /// The first guess.
    guess: Spline,
    /// The unknowns at the ends of phases for which it was made.
    ends: Vec<Vec<f64>>,
    /// How far those at the ends of a phase are off.
    changes: [Vec<f64>; 2],
    pub solved: Place,
    pub is_solved: bool,
    /// The time since it was solved (s).
    pub late: f64,
    /// An iterate, while it is compared with the solved motion.
    pub other: Place,
    /// Solves without progress, and those that could not be evaluated, one after the other.
    pub failures: usize,
    /// Whether the last solve began at the first guess after another one had failed.
    pub was_guess: bool,
    /// Whether the last solve ended before it was solved, and not by failing.
    pub unfinished: bool,
    /// Whether there is room for the iterates of all later solves.
    pub has_room: bool,
}

impl Recovery {
    pub fn new(guess: &Spline, ends: &[Vec<f64>]) -> Self {
        let ends = ends.to_vec();
        let changes = [guess.dof; 2].map(|n| vec![0.0; n]);
        Self { guess: guess.clone(), ends, changes, ..Self::default() }
    }

    /// Time went on by `dt` (s).
    pub fn advance(&mut self, dt: f64) {
        self.late += dt;
    }

    /// A solve ended like this at this iterate, or with an error.
    pub fn note(&mut self, status: Option<ResolveStatus>, iterate: &Interior<Dynamics>) {
        self.unfinished = false;
        match status {
            Some(ResolveStatus::Solved) => {
                self.solved.take(iterate);
                (self.is_solved, self.late, self.failures) = (true, 0.0, 0);
            }
            Some(ResolveStatus::NoProgress) | None => self.failures += 1,
            Some(_) => (self.unfinished, self.failures) = (true, 0),
        }
    }

    /// Puts the first guess into the iterate, moved along with its ends: between those of a phase by what is
    /// linear between their changes. Times stay where one is given, since time goes on.
    pub fn put_guess(&mut self, iterate: &mut Interior<Dynamics>, states: &[Vec<f64>]) {
        let (n, spline) = (self.guess.dof, &mut iterate.spline);
        spline.unknowns.clone_from(&self.guess.unknowns);
        if !iterate.ends.times.is_given_after(0) {
            spline.times.clone_from(&self.guess.times);
        }
        let node = spline.node();
        for phase in 0..spline.mesh.phases() {
            for (end, change) in (phase..).zip(&mut self.changes) {
                for (i, change) in change.iter_mut().enumerate() {
                    let given = iterate.ends.given[end][i];
                    *change = if given { states[end][i] - self.ends[end][i] } else { 0.0 };
                }
            }
            let [first, last] = [phase, phase + 1].map(|end| spline.mesh.ends()[end]);
            for k in first + 1..last {
                let part = spline.mesh.nodes[k] - phase as f64;
                let (q, rates) = spline.unknowns[node * k..][..2 * n].split_at_mut(n);
                for (i, (q, rate)) in q.iter_mut().zip(rates).enumerate() {
                    let [a, b] = [self.changes[0][i], self.changes[1][i]];
                    *q += a + part * (b - a);
                    *rate += b - a;
                }
            }
        }
    }
}
