//! Limits of which a motion does not show whether they are active, and what they make of its gains.
//!
//! On the central path slack and multiplier of a limit have a product that is nearly zero. Where a motion
//! only just touches a limit both are nearly zero themselves. States that are off to one side then lead to a
//! motion that keeps the limit for a while, those to the other to one that does not reach it: the control has
//! two one-sided derivatives, and that of the barrier lies between them.
//!
//! Where a motion touches a limit of positions, of a tool or a clearance for an instant, with an impulse of
//! its multiplier, the instant moves with the state, which the points of a mesh do not follow: the gains
//! before it are not known.

use super::feedback::Feedback;
use super::resolve::{Resolve, named};
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::Limited;
use crate::direct::outcome::named::Coordinates;
use costate::EvalError;

/// Least ratio of multiplier and slack, both without unit, of a limit that is touched: derivatives take the
/// part r / (1 + r) of a limit with the ratio r as kept.
const TOUCHED: f64 = 0.01;
/// Largest multiplier, without unit, of a limit that is only touched, in powers of its product mu with the
/// slack: cube roots for a limit of the state, square roots for one of the control. The slack s of one of the
/// state is a parabola in time, the multiplier mu / s has the integral `pi mu / sqrt(s)` but for its scale,
/// which moves the motion away by about s: `s^(3/2)` is about mu, and the multiplier `mu^(1/3)`. One of the
/// control moves the control at its own time: the multiplier is about s. Where a limit is kept its multiplier
/// does not depend on mu.
const ONLY_TOUCHED: f64 = 5.0;
/// By this factor the slack of an undecided limit is changed, so that it counts as active or not for certain.
const DECISIVE: f64 = 1e8;

/// An entry of a limit that is undecided, and where on the mesh it is.
#[derive(Clone, Copy, Debug)]
struct Undecided {
    at: usize,
    s: f64,
}

/// A limit of positions is touched for an instant, or for so short a time that the mesh does not tell both
/// ends of it apart, where it is kept over less than so many intervals.
const INSTANT: f64 = 4.0;

impl<D> Interior<D> {
    /// The entries of limits of positions that are kept for an instant.
    fn instants(&self, sides: &[Vec<Undecided>]) -> Vec<Undecided> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let is_active = |entry: &Undecided| self.is_active(entry.at);
        let is_instant = |touch: &&[Undecided]| {
            let [Some(first), Some(last)] = [touch.first(), touch.last()] else { return false };
            let side = barrier.side(first.at);
            let is_of_position = matches!(side.limited, Limited::Position | Limited::Task);
            let width = mesh.width(mesh.place(first.s).0);
            is_active(first) && is_of_position && !side.is_equation && last.s - first.s < INSTANT * width
        };
        let touches = sides.iter().flat_map(|side| side.chunk_by(|a, b| is_active(a) == is_active(b)));
        touches.filter(is_instant).flatten().copied().collect()
    }

    /// The entries of all limits along the motion, for each of them in the order of time; those of rows at
    /// ends alone.
    fn entries_of_sides(&self) -> Vec<Vec<Undecided>> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let at_node = |k: usize| barrier.at_node(k).map(move |at| (at, mesh.nodes[k]));
        let at_point = |p: usize| barrier.at_point(p).map(move |at| (at, mesh.point(p).0));
        let at_gauss_point = |p: usize| barrier.at_gauss_point(p).map(move |at| (at, mesh.gauss_point(p).0));
        let mut sides = vec![Vec::new(); barrier.all_sides().count()];
        let points = (0..mesh.points()).flat_map(at_point);
        let nodes = (0..mesh.nodes.len()).flat_map(at_node);
        for (at, s) in points.chain(nodes).chain((0..mesh.gauss_points()).flat_map(at_gauss_point)) {
            if let Some(side) = barrier.side_index(at) {
                sides[side].push(Undecided { at, s });
            }
        }
        sides.iter_mut().for_each(|side| side.sort_by(|a, b| a.s.total_cmp(&b.s)));
        sides.extend(barrier.at_ends().map(|at| vec![Undecided { at, s: barrier.end_of(at) as f64 }]));
        sides
    }

    /// The entries of limits that are touched, and nowhere near there active for certain. Next to an arc at a
    /// limit there are such entries at its ends too, where multiplier and slack begin; these move with the
    /// arc, and the derivative exists.
    fn undecided(&self, sides: &[Vec<Undecided>]) -> Vec<Undecided> {
        let (mesh, barrier) = (&self.spline.mesh, &self.barrier);
        let mut found = Vec::new();
        for side in sides {
            let is_touched = |entry: &Undecided| self.activity(entry.at) > TOUCHED;
            let touches =
                side.chunk_by(|a, b| is_touched(a) == is_touched(b)).filter(|all| is_touched(&all[0]));
            let is_kept = |entry: &Undecided| {
                let [multiplier, slack] = self.without_unit(entry.at);
                let mu = multiplier * slack;
                let is_control = barrier.side(entry.at).limited.jumps(mesh.shape);
                multiplier > ONLY_TOUCHED * if is_control { mu.sqrt() } else { mu.cbrt() }
            };
            found.extend(touches.filter(|touch| !touch.iter().any(is_kept)).flatten().copied());
        }
        found
    }
}

/// Gains of a motion with its undecided limits kept, and with them left out.
pub(crate) struct OneSided {
    undecided: Vec<Undecided>,
    instants: Vec<Undecided>,
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
        for (side, factor) in sides.iter_mut().zip([1.0 / DECISIVE, DECISIVE]) {
            undecided.iter().for_each(|entry| motion.interior.barrier.slack[entry.at] *= factor);
            *side = motion.feedback()?.cloned();
            motion.interior.barrier.slack.clone_from(&slacks);
        }
        motion.feedback()?;
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
        let name = |entry: &Undecided| named(&motion.interior, barrier.side(entry.at), &coordinates);
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
