//! The numbers of one joint in the axes of its moved frame.

use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Vec3};

/// A change of the entries of one joint, or their rates, with R and a of the joint:
///
/// $$ dr = R\\, d, \quad da = a \circ (w, s), \quad dp\_r = R\\, g, \quad
///    dp\_a = \tfrac{2}{|a|^2}\\, a \circ (c, k) $$
///
/// g and c are those of the momenta or rates themselves, and k is zero, where x has these. Costates by the
/// entries are in these components too: what each is multiplied by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Local<S> {
    pub d: Vec3<S>,
    pub w: Vec3<S>,
    pub s: S,
    pub g: Vec3<S>,
    pub c: Vec3<S>,
    pub k: S,
}

/// (linear, angular) of one joint in q, then in w, of 2n entries of the tangent space.
pub(crate) type Parts<S> = [Vec3<S>; 4];

/// Three entries.
pub(crate) fn vector<S: Scalar>(entries: &[S], at: usize) -> Vec3<S> {
    vector_of(|i| entries[i], at)
}

/// Three entries of a function.
pub(super) fn vector_of<S: Scalar>(entry: impl Fn(usize) -> S, at: usize) -> Vec3<S> {
    Vec3::new(entry(at), entry(at + 1), entry(at + 2))
}

/// Four entries of a function.
pub(super) fn quaternion_of<S: Scalar>(entry: impl Fn(usize) -> S, at: usize) -> Quaternion<S> {
    Quaternion::new([0, 1, 2, 3].map(|k| entry(at + k)))
}

/// `a o (vector, scalar)`.
pub(super) fn product<S: Scalar>(a: Quaternion<S>, vector: Vec3<S>, scalar: S) -> Quaternion<S> {
    a.then_after(Quaternion { vector, scalar })
}
