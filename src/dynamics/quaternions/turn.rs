//! One floating or spherical joint as plain numbers: its entries and the axes of its moved frame.

use super::local::{Local, Parts, product, quaternion_of, vector, vector_of};
use crate::robot::{FreeJoint, FreeKind, Robot};
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Rotation, Vec3};

/// What the second half of x holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SecondHalf {
    /// Momenta or rates of the tangent space, n entries.
    Tangent,
    /// Momenta conjugate to the entries of q, nq entries.
    Conjugate,
}

impl SecondHalf {
    /// Whether it holds momenta conjugate to the entries of q.
    pub fn is_conjugate(self) -> bool {
        self == Self::Conjugate
    }

    /// Its number of entries.
    pub fn length(self, robot: &Robot) -> usize {
        if self.is_conjugate() { robot.nq() } else { robot.dof() }
    }
}

/// The momenta of a joint that those conjugate to its entries stand for:
///
/// $$ p\_r = R\\, p\_v, \qquad p\_a = \tfrac{2}{|a|^2}\\, a \circ (\pi, \sigma) $$
#[derive(Clone, Copy, Debug)]
pub(crate) struct Momenta<S> {
    /// p_v, of the translation.
    pub linear: Vec3<S>,
    /// pi, of the rotation.
    pub angular: Vec3<S>,
    /// sigma, along a, on which no motion depends.
    pub along: S,
}

/// Where the entries of one joint are, and the axes of its moved frame.
#[derive(Clone, Debug)]
pub(crate) struct Turn<S> {
    /// Its first entries of q, of v, and of the second half of x (an index of x).
    pub position: usize,
    pub coordinate: usize,
    pub momentum: usize,
    /// Whether it moves too.
    pub slides: bool,
    pub rotation: Rotation<S>,
    /// a, and a/|a|^2.
    a: Quaternion<S>,
    by_square: Quaternion<S>,
    /// Where x has conjugate momenta.
    pub momenta: Option<Momenta<S>>,
}

impl<S: Scalar> Turn<S> {
    pub fn new(joint: &FreeJoint, nq: usize, second: SecondHalf) -> Self {
        let (zero, none) = (Vec3::zero(), Quaternion::new([S::zero(); 4]));
        let momenta = Momenta { linear: zero, angular: zero, along: S::zero() };
        Self {
            position: joint.position,
            coordinate: joint.coordinate,
            momentum: nq + if second.is_conjugate() { joint.position } else { joint.coordinate },
            slides: joint.kind == FreeKind::Floating,
            rotation: Rotation { rows: [zero; 3] },
            a: none,
            by_square: none,
            momenta: second.is_conjugate().then_some(momenta),
        }
    }

    /// Its first entry of the quaternion, and its first angular coordinate.
    pub fn quaternion(&self) -> usize {
        self.position + self.slides_count()
    }

    pub fn angular(&self) -> usize {
        self.coordinate + self.slides_count()
    }

    /// The first entry of the second half that belongs to the rotation.
    fn angular_momentum(&self) -> usize {
        self.momentum + self.slides_count()
    }

    fn slides_count(&self) -> usize {
        if self.slides { 3 } else { 0 }
    }

    /// The entries of x in which the tangent space is not linear.
    pub fn entries(&self) -> impl Iterator<Item = usize> + use<S> {
        let count = if self.momenta.is_some() { self.slides_count() + 4 } else { 0 };
        (self.position..self.quaternion() + 4).chain(self.momentum..self.momentum + count)
    }

    /// (linear, angular) in q and w of 2n entries.
    pub fn parts(&self, entry: impl Fn(usize) -> S, n: usize) -> Parts<S> {
        let linear = |first: usize| {
            if self.slides { vector_of(&entry, first + self.coordinate) } else { Vec3::zero() }
        };
        let angular = |first: usize| vector_of(&entry, first + self.angular());
        [linear(0), angular(0), linear(n), angular(n)]
    }

    /// Puts these as entries of 2n of the tangent space.
    pub fn put_parts(&self, parts: Parts<S>, n: usize, mut put: impl FnMut(usize, S)) {
        for (first, [linear, angular]) in [(0, [parts[0], parts[1]]), (n, [parts[2], parts[3]])] {
            if self.slides {
                each(first + self.coordinate, linear.to_array(), &mut put);
            }
            each(first + self.angular(), angular.to_array(), &mut put);
        }
    }

    /// Takes x; writes r and `a/|a|` to q, and the momenta or rates to w.
    pub fn set(&mut self, x: &[S], q: &mut [S], w: &mut [S]) {
        let at = self.quaternion();
        q[self.position..at].copy_from_slice(&x[self.position..at]);
        let unit = self.orient(quaternion_of(|i| x[i], at));
        q[at..at + 4].copy_from_slice(&unit.to_array());
        let value = self.momenta_at(|i| x[i]);
        self.momenta = self.momenta.map(|_| value);
        if self.slides {
            w[self.coordinate..self.coordinate + 3].copy_from_slice(&value.linear.to_array());
        }
        let angular = self.angular();
        w[angular..angular + 3].copy_from_slice(&value.angular.to_array());
    }

    /// Takes q, whose quaternion has any length, and w; writes x.
    pub fn lift(&mut self, [q, w]: [&[S]; 2], x: &mut [S]) {
        let place = self.position..self.quaternion() + 4;
        self.orient(quaternion_of(|i| q[i], self.quaternion()));
        x[place.clone()].copy_from_slice(&q[place]);
        let linear = if self.slides { vector(w, self.coordinate) } else { Vec3::zero() };
        let value = Momenta { linear, angular: vector(w, self.angular()), along: S::zero() };
        self.momenta = self.momenta.map(|_| value);
        self.put_momenta(value, |i, entry| x[i] = entry);
    }

    /// Takes the axes of a, and returns a/|a|.
    fn orient(&mut self, a: Quaternion<S>) -> Quaternion<S> {
        let (by_length, unit) = (a.length().recip(), a.unit());
        self.a = a;
        self.by_square = Quaternion::new(unit.to_array().map(|entry| entry * by_length));
        self.rotation = unit.rotation();
        unit
    }

    /// A change of x in the axes of the frame, from its entries.
    pub fn local(&self, entry: impl Fn(usize) -> S) -> Local<S> {
        let d = if self.slides { self.rotation.undo(vector_of(&entry, self.position)) } else { Vec3::zero() };
        let turned = self.by_square.conjugate().then_after(quaternion_of(&entry, self.quaternion()));
        let Momenta { linear: g, angular: c, along: k } = self.momenta_at(entry);
        Local { d, w: turned.vector, s: turned.scalar, g, c, k }
    }

    /// The entries of a change.
    pub fn put(&self, change: &Local<S>, mut put: impl FnMut(usize, S)) {
        if self.slides {
            each(self.position, self.rotation.apply(change.d).to_array(), &mut put);
        }
        each(self.quaternion(), product(self.a, change.w, change.s).to_array(), &mut put);
        self.put_momenta(Momenta { linear: change.g, angular: change.c, along: change.k }, put);
    }

    /// A costate of x in the axes of the frame, from its entries.
    pub fn local_costate(&self, y: impl Fn(usize) -> S) -> Local<S> {
        let d = if self.slides { self.rotation.undo(vector_of(&y, self.position)) } else { Vec3::zero() };
        let turned = self.a.conjugate().then_after(quaternion_of(&y, self.quaternion()));
        let linear = if self.slides { vector_of(&y, self.momentum) } else { Vec3::zero() };
        let (g, c, k) = if self.momenta.is_some() {
            let of_a = self.by_square.conjugate().then_after(quaternion_of(&y, self.angular_momentum()));
            (self.rotation.undo(linear), of_a.vector.times(2.0), of_a.scalar.times(2.0))
        } else {
            (linear, vector_of(&y, self.angular_momentum()), S::zero())
        };
        Local { d, w: turned.vector, s: turned.scalar, g, c, k }
    }

    /// The entries of a costate.
    pub fn put_costate(&self, y: &Local<S>, to: &mut [S]) {
        let mut put = |i: usize, entry: S| to[i] = entry;
        if self.slides {
            each(self.position, self.rotation.apply(y.d).to_array(), &mut put);
        }
        each(self.quaternion(), product(self.by_square, y.w, y.s).to_array(), &mut put);
        let (linear, angular) = (self.momentum, self.angular_momentum());
        if self.momenta.is_some() {
            if self.slides {
                each(linear, self.rotation.apply(y.g).to_array(), &mut put);
            }
            each(angular, product(self.a, y.c.times(0.5), y.k.times(0.5)).to_array(), put);
        } else {
            if self.slides {
                each(linear, y.g.to_array(), &mut put);
            }
            each(angular, y.c.to_array(), put);
        }
    }

    /// The second half of x, or a change of it, in the axes of the frame.
    fn momenta_at(&self, entry: impl Fn(usize) -> S) -> Momenta<S> {
        let linear = if self.slides { vector_of(&entry, self.momentum) } else { Vec3::zero() };
        let first = self.angular_momentum();
        if self.momenta.is_none() {
            return Momenta { linear, angular: vector_of(entry, first), along: S::zero() };
        }
        let of_a = self.a.conjugate().then_after(quaternion_of(entry, first));
        let (angular, along) = (of_a.vector.times(0.5), of_a.scalar.times(0.5));
        Momenta { linear: self.rotation.undo(linear), angular, along }
    }

    /// Its entries.
    pub fn put_momenta(&self, value: Momenta<S>, mut put: impl FnMut(usize, S)) {
        let first = self.angular_momentum();
        if self.momenta.is_none() {
            if self.slides {
                each(self.momentum, value.linear.to_array(), &mut put);
            }
            each(first, value.angular.to_array(), put);
            return;
        }
        if self.slides {
            each(self.momentum, self.rotation.apply(value.linear).to_array(), &mut put);
        }
        let of_a = product(self.by_square, value.angular.times(2.0), value.along.times(2.0));
        each(first, of_a.to_array(), put);
    }
}

/// Puts entries from index `at` on.
fn each<S, const N: usize>(at: usize, entries: [S; N], mut put: impl FnMut(usize, S)) {
    for (k, entry) in entries.into_iter().enumerate() {
        put(at + k, entry);
    }
}
