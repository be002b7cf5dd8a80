//! The joints between two frames, and the pose of one frame seen from the other.
//!
//! Seen from its second frame, the first frame of a constraint is the tip of a chain: the joints from the
//! second frame inward to where the paths meet, with opposite axes, then outward to the first frame. Joints
//! that move both frames do not count. As in [`kinematics`](crate::kinematics), with the columns (w; c) of
//! the chain in axes of the second frame, s nearer to it than t,
//!
//! ```text
//! r_,s = c_s      r_,st = w_s x c_t      w_t,s = w_s x w_t      w_s,t = 0
//! ```

use crate::kinematics::{Kinematics, Seat};
use crate::matrix::filled;
use crate::robot::{Row, Tree, TreeFrame, scaled};
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// A joint of a chain, its coordinate, and the rate of the chain's joint at unit rate of the coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    joint: usize,
    pub coordinate: usize,
    /// The ratio of a joint that mimics another one, with the sign of the branch.
    rate: f64,
}

/// The chain from the second frame to the first one, and its columns.
#[derive(Clone, Debug)]
pub(super) struct Chain<S> {
    frames: [TreeFrame; 2],
    links: Vec<Link>,
    /// `(w; c)` at unit rate of the coordinate.
    columns: Vec<Motion<S>>,
    /// Squares of the sizes of their linear parts.
    sizes: Vec<S>,
    /// Position of the first frame.
    pub position: Vec3<S>,
    /// Its orientation, by rows.
    pub rotation: [Vec3<S>; 3],
}

impl<S: Scalar> Chain<S> {
    pub fn new(tree: &Tree, rows: &[Row], frames: [TreeFrame; 2]) -> Self {
        let [mut outward, mut inward] =
            frames.map(|TreeFrame { joint, .. }| tree.path(joint).collect::<Vec<usize>>());
        // Both end at the base: what they share moves both frames.
        while let (Some(a), Some(b)) = (outward.last(), inward.last())
            && a == b
        {
            outward.pop();
            inward.pop();
        }
        let link = |joint: usize, sign: f64| Link {
            joint,
            coordinate: rows[joint].coordinate,
            rate: sign * rows[joint].ratio,
        };
        let inward = inward.into_iter().map(|joint| link(joint, -1.0));
        let links: Vec<Link> =
            inward.chain(outward.into_iter().rev().map(|joint| link(joint, 1.0))).collect();
        Self {
            frames,
            columns: filled(Motion::zero(), links.len()),
            sizes: filled(S::zero(), links.len()),
            links,
            position: Vec3::zero(),
            rotation: [Vec3::zero(); 3],
        }
    }

    /// Takes pose and columns from placed links.
    pub fn place(&mut self, kinematics: &Kinematics<S>) {
        let [first, second]: [Seat<S>; 2] = self.frames.map(|frame| kinematics.seat(&frame));
        (self.position, self.rotation) = second.pose(&first);
        let columns = self.columns.iter_mut().zip(&mut self.sizes);
        for ((column, size), link) in columns.zip(&self.links) {
            let (seen, square) = kinematics.column_seen(link.joint, &second, self.position);
            let at_rate = |a: Vec3<S>| Vec3::from(a.to_array().map(|entry| scaled(link.rate, entry)));
            *column = Motion { angular: at_rate(seen.angular), linear: at_rate(seen.linear) };
            *size = scaled(link.rate * link.rate, square);
        }
    }

    /// Coordinates, and squares of the sizes of the angular and linear parts of their columns.
    pub fn sizes(&self) -> impl Iterator<Item = (usize, [S; 2])> + '_ {
        let turning = |column: &Motion<S>| column.angular.dot(column.angular);
        let columns = self.columns.iter().zip(&self.sizes);
        self.links
            .iter()
            .zip(columns)
            .map(move |(link, (column, &size))| (link.coordinate, [turning(column), size]))
    }

    /// Coordinates and columns, from the second frame on.
    pub fn columns(&self) -> impl Iterator<Item = (usize, Motion<S>)> + '_ {
        self.links.iter().zip(&self.columns).map(|(link, column)| (link.coordinate, *column))
    }

    /// The first and the second frame.
    pub fn frames(&self) -> [TreeFrame; 2] {
        self.frames
    }

    /// The coordinates.
    pub fn coordinates(&self) -> impl Iterator<Item = usize> + '_ {
        self.links.iter().map(|link| link.coordinate)
    }

    /// Calls for each pair s, t of joints, s not beyond t, once: with the coordinates, the power of the force
    /// that belongs to column s in the motion of column t, and whether both are one joint.
    pub fn for_pairs(&self, force: impl Fn(Motion<S>) -> Force<S>, mut of: impl FnMut([usize; 2], S, bool)) {
        for (s, (i, inner)) in self.columns().enumerate() {
            let force = force(inner);
            for (t, (j, outer)) in self.columns().enumerate().skip(s) {
                of([i, j], force.dot(outer), s == t);
            }
        }
    }
}
