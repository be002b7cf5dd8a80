//! One row: the clearance of two cores with its derivatives.

use super::cores::{Closest, Core, CoreBox};
use super::pair::{Other, Pair};
use crate::constants::task::{DEPTHS, PARALLEL};
use crate::task::placed::{Hessian, Placed};
use nalgebra::Vector3;
use std::f64::consts::SQRT_2;

/// `c(phi) = sqrt2 sqrt(2 phi + R^2) - 2 R` and its first two derivatives.
pub(super) fn clearance(half_square: f64, radius: f64) -> [f64; 3] {
    let square = 2.0 * half_square + radius * radius;
    let root = square.sqrt();
    let first = SQRT_2 / root;
    [SQRT_2 * root - 2.0 * radius, first, -first / square]
}

/// The closest places of a core and what it keeps away from.
pub(super) fn closest(core: &Core, other: &Other, cores: &[Core], radius: f64) -> Closest {
    let rounding = PARALLEL * radius * radius;
    match other {
        Other::Body(b) => Closest::of(core, &cores[*b], rounding),
        Other::Box(other) => Closest::to_box(core, other, rounding),
        // A half-space has rows of its own.
        Other::HalfSpace { .. } => Closest::of(core, core, rounding),
    }
}

/// The points of a core whose depths inside of a box count.
fn points(core: &Core) -> impl Iterator<Item = Vector3<f64>> {
    let count = if core.is_segment { DEPTHS } else { 1 };
    (0..count).map(move |k| core.at(k as f64 / (DEPTHS - 1) as f64))
}

/// The depths with their normals, each with its share of the mean.
fn depths(core: &Core, other: &CoreBox) -> impl Iterator<Item = (Vector3<f64>, f64, Vector3<f64>)> {
    let share = if core.is_segment { 1.0 / DEPTHS as f64 } else { 1.0 };
    points(core).filter_map(move |x| {
        let (depth, normal) = other.depth(&x)?;
        Some((x, share * depth, normal * share))
    })
}

/// The mean depth of a core inside of a box, negative; 0 outside and for other bodies.
pub(super) fn depth(core: &Core, other: &Other) -> f64 {
    match other {
        Other::Box(other) => depths(core, other).map(|(_, depth, _)| depth).sum(),
        Other::Body(_) | Other::HalfSpace { .. } => 0.0,
    }
}

/// The row of one pair; its value.
///
/// With the rows D of the change of the vector d between the closest places, and those S of the conditions
/// `phi_s = phi_t = 0`, at fixed places,
///
/// ```text
/// phi_q = d'D       phi_qq = D'D + d . d_qq - S' Y^-1 S       Y second derivatives by (s, t)
/// c_qq = c' phi_qq + c'' phi_q' phi_q
/// ```
pub(super) fn contract_distance(
    pair: &Pair,
    cores: &[Core],
    moved: &mut [[f64; 6]],
    placed: &mut Placed,
    w: f64,
    gradient: &mut [f64],
    hessian: &mut Hessian<'_>,
) -> f64 {
    let core = &cores[pair.body];
    let found = closest(core, &pair.other, cores, pair.radius);
    let other = if let Other::Body(b) = pair.other { Some(&cores[b]) } else { None };
    let [value, first, second] = clearance(found.half_square, pair.radius);
    fill_moved(pair, [Some(core), other], &found, placed, moved);
    for (place, &i) in pair.coordinates.iter().enumerate() {
        let a = moved[i];
        gradient[i] = first * a[5];
        for &j in &pair.coordinates[place..] {
            let b = moved[j];
            let metric = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] - a[3] * b[3] - a[4] * b[4];
            let entry = w * (first * metric + second * a[5] * b[5]);
            hessian.add(i, j, entry);
            if i != j {
                hessian.add(j, i, entry);
            }
        }
    }
    let sides = [(Some(core), 0, w * first), (other, 1, -w * first)];
    for (core, side, weight) in sides {
        let Some(core) = core else { continue };
        let path = &pair.paths[side];
        placed.see_point(path, &core.at(found.places[side]));
        placed.add_second(path, &(found.d * weight), None, hessian);
    }
    if let Other::Box(other) = &pair.other {
        for (x, _, normal) in depths(core, other) {
            placed.see_point(&pair.paths[0], &x);
            placed.add_gradient(&pair.paths[0], &normal, gradient);
            placed.add_second(&pair.paths[0], &(normal * w), None, hessian);
        }
    }
    value + depth(core, &pair.other)
}

/// For each coordinate of a pair: D in the directions of the metric; `L^-1 S` for `Y = L L'`; phi_q.
fn fill_moved(
    pair: &Pair,
    cores: [Option<&Core>; 2],
    found: &Closest,
    placed: &Placed,
    moved: &mut [[f64; 6]],
) {
    let Closest { d, metric, places, free, second: [ss, st, tt], .. } = *found;
    for &i in &pair.coordinates {
        moved[i] = [0.0; 6];
    }
    let [u, v] = cores.map(|core| core.map_or_else(Vector3::zeros, |core| core.way));
    let ways = metric.map(|direction| [direction.dot(&u), direction.dot(&v)]);
    for (side, core) in cores.into_iter().enumerate() {
        let Some(core) = core else { continue };
        let x = core.at(places[side]);
        for &j in &pair.paths[side] {
            let (at, ratio) = placed.coordinate(j);
            let ratio = if side == 0 { ratio } else { -ratio };
            let change = placed.point(j, &x) * ratio;
            let entries = &mut moved[at];
            // phi_s = d . u and phi_t = -d . v change with d, and with the way of this core.
            entries[3 + side] += ratio * d.dot(&placed.turned(j, &core.way));
            for k in 0..3 {
                let part = metric[k].dot(&change);
                entries[k] += part;
                entries[3] += part * ways[k][0];
                entries[4] -= part * ways[k][1];
            }
        }
    }
    let [of_s, of_both] = if free[0] { [ss.sqrt().recip(), st / ss] } else { [0.0; 2] };
    let of_t = if free[1] { (tt - of_both * st).max(f64::MIN_POSITIVE).sqrt().recip() } else { 0.0 };
    let along = metric.map(|direction| direction.dot(&d));
    for &i in &pair.coordinates {
        let [x, y, z, s, t, _] = moved[i];
        let slope = x * along[0] + y * along[1] + z * along[2];
        moved[i] = [x, y, z, of_s * s, of_t * (t - of_both * s), slope];
    }
}
