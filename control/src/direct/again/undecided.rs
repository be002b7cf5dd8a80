//! Limits of which a motion does not show whether they are active, and what they make of its gains.
//!
//! On the central path slack and multiplier of a limit have a product that is nearly zero. Where a motion
//! only just touches a limit both are nearly zero themselves. States that are off to one side then lead to a
//! motion that keeps the limit for a while, those to the other to one that does not reach it: the control has
//! two one-sided derivatives, and that of the barrier lies between them.
//!
//! A limit of positions, of a tool or a clearance that is kept for an instant is a [touch](super::touches).
//! One that is kept for so short a time that the mesh does not tell its two ends apart is neither that nor an
//! arc: the gains before it are not known.

use super::feedback::Feedback;
use super::resolve::{Resolve, named};
use super::touches::Entry;
use crate::direct::interior::iterate::Interior;
use crate::direct::outcome::named::Coordinates;
use costate::EvalError;

/// By this factor the slack of an undecided limit is changed, so that it counts as active or not for certain.
const DECISIVE: f64 = 1e8;

/// A limit of positions is kept for too short a time to be an arc over less than so many intervals.
const INSTANT: f64 = 4.0;

impl<D> Interior<D> {
    /// The entries of limits of positions that are kept for too short a time.
    fn instants(&self, sides: &[Vec<Entry>]) -> Vec<Entry> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let is_active = |entry: &Entry| self.is_active(entry.at);
        let is_instant = |touch: &&[Entry]| {
            let [Some(first), Some(last)] = [touch.first(), touch.last()] else { return false };
            let side = barrier.side(first.at);
            let width = mesh.width(mesh.place(first.s).0);
            is_active(first) && self.is_of_positions(side) && last.s - first.s < INSTANT * width
        };
        let touches = sides.iter().flat_map(|side| side.chunk_by(|a, b| is_active(a) == is_active(b)));
        touches.filter(is_instant).flatten().copied().collect()
    }

    /// The entries of limits that are touched, and nowhere near there active for certain. Next to an arc at a
    /// limit there are such entries at its ends too, where multiplier and slack begin; these move with the
    /// arc, and the derivative exists.
    fn undecided(&self, sides: &[Vec<Entry>]) -> Vec<Entry> {
        let mut found = Vec::new();
        for side in sides {
            let is_touched = |entry: &Entry| self.is_touched(entry.at);
            let touches =
                side.chunk_by(|a, b| is_touched(a) == is_touched(b)).filter(|all| is_touched(&all[0]));
            let is_kept = |entry: &Entry| self.is_surely_kept(entry.at);
            found.extend(touches.filter(|touch| !touch.iter().any(is_kept)).flatten().copied());
        }
        found
    }
}

/// Gains of a motion with its undecided limits kept, and with them left out.
pub(crate) struct OneSided {
    undecided: Vec<Entry>,
    instants: Vec<Entry>,
    /// `None` where no strict minimum is left.
    sides: [Option<Feedback>; 2],
    gains: [Vec<f64>; 2],
}

impl OneSided {
    /// `None` where no limit of the motion is undecided or touched for an instant.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub fn of(motion: &mut Resolve) -> Result<Option<Self>, EvalError> {
        let sides = motion.interior.entries_of_sides();
        let (undecided, instants) = (motion.interior.undecided(&sides), motion.interior.instants(&sides));
        if undecided.is_empty() && instants.is_empty() {
            return Ok(None);
        }
        let slacks = motion.interior.barrier.slack.clone();
        let mut sides = [None, None];
        // Without an undecided limit both are the same.
        let of_sides = if undecided.is_empty() { 0 } else { 2 };
        for (side, factor) in sides.iter_mut().zip([1.0 / DECISIVE, DECISIVE]).take(of_sides) {
            undecided.iter().for_each(|entry| motion.interior.barrier.slack[entry.at] *= factor);
            *side = motion.feedback()?.cloned();
            motion.interior.barrier.slack.clone_from(&slacks);
        }
        motion.factorised = false;
        let spline = &motion.interior.spline;
        let gains = [vec![0.0; spline.dof * spline.node()], vec![0.0; spline.dof * spline.node()]];
        Ok(Some(Self { undecided, instants, sides, gains }))
    }

    /// Names of the limits that are touched for an instant at a time of the motion, or later; and of those
    /// that are undecided, unless gains to either side differ by no more than this part of the largest entry
    /// for q, v or a.
    pub fn names(&mut self, motion: &Resolve, t: f64, part: f64) -> Vec<String> {
        let differ = self.differ([motion.interior.spline.dof, motion.interior.spline.node()], t, part);
        let undecided = self.undecided.iter().filter(|_| differ);
        let (spline, barrier) = (&motion.interior.spline, &motion.interior.barrier);
        let (k, _) = spline.mesh.place(spline.place_of(t));
        let coordinates = Coordinates::of(&motion.problem);
        let later = undecided.chain(&self.instants).filter(|entry| entry.s >= spline.mesh.nodes[k]);
        let name = |entry: &Entry| named(&motion.interior, barrier.side(entry.at), &coordinates);
        let mut names: Vec<_> = later.map(name).collect();
        names.sort();
        names.dedup();
        names
    }

    /// Whether the gains, n x m, to either side differ, or one of them does not exist.
    fn differ(&mut self, [n, m]: [usize; 2], t: f64, part: f64) -> bool {
        for (side, gain) in self.sides.iter().zip(&mut self.gains) {
            if !side.as_ref().is_some_and(|side| side.gain(t, gain)) {
                return true;
            }
        }
        let [kept, left] = &self.gains;
        (0..m).step_by(n).any(|first| {
            let entries = (0..n).flat_map(|i| m * i + first..m * i + first + n);
            let [mut off, mut size] = [0.0_f64; 2];
            for at in entries {
                off = off.max((kept[at] - left[at]).abs());
                size = size.max(kept[at].abs()).max(left[at].abs());
            }
            off > part * size
        })
    }
}
