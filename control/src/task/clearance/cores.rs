//! Closest places of the cores of two bodies: a point, a segment, a box.
//!
//! A sphere is a point with a radius, a capsule a segment with a radius. Half the squared distance of two
//! cores is an extremal value,
//!
//! $$ \varphi = \min\_{0 \le s, t \le 1} \tfrac12 |p(s) - r(t)|^2 + \tfrac{\rho}{2} \left[ (s - \tfrac12)^2 +
//!    (t - \tfrac12)^2 \right] - \tfrac{\rho}{4} $$
//!
//! Without $\rho$ the closest places of two parallel segments are not unique, and the distance has a kink
//! there. With it the minimum is unique, continuous in the poses, and the distance is never overestimated.

use nalgebra::{Matrix3, Vector3};

type V = Vector3<f64>;

/// A point, or a segment from the first to the second point; in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Core {
    pub from: V,
    /// The second point less the first; zero for a point.
    pub way: V,
    pub is_segment: bool,
}

impl Core {
    pub fn at(&self, s: f64) -> V {
        self.from + self.way * s
    }
}

/// A box: the rotation of its axes to the world, its centre, half of its sizes.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::task) struct CoreBox {
    pub axes: Matrix3<f64>,
    pub centre: V,
    pub half: V,
}

/// Where the distance of two cores is taken, and what its derivatives need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Closest {
    /// phi.
    pub half_square: f64,
    /// From the place on the second core to that on the first; its length is the distance.
    pub d: V,
    /// Directions in which moving one against the other changes the square of the distance; zero for those in
    /// which a face of a box is flat.
    pub metric: [V; 3],
    /// s, t.
    pub places: [f64; 2],
    /// Whether s, t are strictly inside of their ranges: then they move with the poses.
    pub free: [bool; 2],
    /// Second derivatives of the sum by (s, s), (s, t), (t, t).
    pub second: [f64; 3],
}

impl Closest {
    /// Of points and segments.
    pub fn of(a: &Core, b: &Core, rounding: f64) -> Self {
        let rho = if a.is_segment && b.is_segment { rounding } else { 0.0 };
        let apart = a.from - b.from;
        let (ss, st, tt) = (a.way.norm_squared() + rho, -a.way.dot(&b.way), b.way.norm_squared() + rho);
        let (linear_s, linear_t) = (apart.dot(&a.way) - 0.5 * rho, -apart.dot(&b.way) - 0.5 * rho);
        let best_s = |t: f64| if a.is_segment { (-(linear_s + st * t) / ss).clamp(0.0, 1.0) } else { 0.0 };
        let best_t = |s: f64| if b.is_segment { (-(linear_t + st * s) / tt).clamp(0.0, 1.0) } else { 0.0 };
        let inside = |x: f64| 0.0 < x && x < 1.0;
        let determinant = ss * tt - st * st;
        let s = (st * linear_t - tt * linear_s) / determinant;
        let t = (st * linear_s - ss * linear_t) / determinant;
        let places = if a.is_segment && b.is_segment && inside(s) && inside(t) {
            [s, t]
        } else {
            // On the boundary: the best place on each side.
            let value =
                |[s, t]: [f64; 2]| (0.5 * ss * s + st * t + linear_s) * s + (0.5 * tt * t + linear_t) * t;
            let sides = [[0.0, best_t(0.0)], [1.0, best_t(1.0)], [best_s(0.0), 0.0], [best_s(1.0), 1.0]];
            let allowed = |[s, t]: [f64; 2]| (a.is_segment || s == 0.0) && (b.is_segment || t == 0.0);
            let least = |best: [f64; 2], side: [f64; 2]| if value(side) < value(best) { side } else { best };
            sides.into_iter().filter(|&side| allowed(side)).fold([0.0, best_t(0.0)], least)
        };
        let [s, t] = places;
        let d = a.at(s) - b.at(t);
        let off_middle = (s - 0.5) * (s - 0.5) + (t - 0.5) * (t - 0.5);
        Self {
            half_square: 0.5 * d.norm_squared() + 0.5 * rho * (off_middle - 0.5),
            d,
            metric: [V::x(), V::y(), V::z()],
            places,
            free: [a.is_segment && inside(s), b.is_segment && inside(t)],
            second: [ss, st, tt],
        }
    }

    /// Of a point or segment and a box: s minimises
    /// `1/2 sum_k max(|y_k(s)| - h_k, 0)^2 + rho/2 (s - 1/2)^2 - rho/8`, y in the axes of the box.
    pub fn to_box(a: &Core, other: &CoreBox, rounding: f64) -> Self {
        let rho = if a.is_segment { rounding } else { 0.0 };
        let y = other.axes.tr_mul(&(a.from - other.centre));
        let u = other.axes.tr_mul(&a.way);
        let excess = |s: f64| (y + u * s).zip_map(&other.half, |y, h| y - y.clamp(-h, h));
        let slope = |s: f64| excess(s).dot(&u) + rho * (s - 0.5);
        let s = if a.is_segment { root(slope, &y, &u, &other.half) } else { 0.0 };
        let outside = excess(s);
        let mut metric = [V::zeros(); 3];
        let mut ss = rho;
        for k in 0..3 {
            if outside[k] != 0.0 {
                metric[k] = other.axes.column(k).into_owned();
                ss += u[k] * u[k];
            }
        }
        Self {
            half_square: 0.5 * outside.norm_squared() + 0.5 * rho * ((s - 0.5) * (s - 0.5) - 0.25),
            d: other.axes * outside,
            metric,
            places: [s, 0.0],
            free: [a.is_segment && 0.0 < s && s < 1.0, false],
            second: [ss, 0.0, 1.0],
        }
    }
}

/// Where an increasing, piecewise linear slope vanishes in [0, 1], or the end where it comes closest to that.
/// Its corners are where a coordinate `y_k + s u_k` passes `+-h_k`.
fn root(slope: impl Fn(f64) -> f64, y: &V, u: &V, half: &V) -> f64 {
    let (mut low, mut high) = ([0.0, slope(0.0)], [1.0, slope(1.0)]);
    if low[1] >= 0.0 {
        return 0.0;
    }
    if high[1] <= 0.0 {
        return 1.0;
    }
    for k in 0..3 {
        for side in [-half[k], half[k]] {
            let s = (side - y[k]) / u[k];
            // Not between the ends where u_k = 0.
            if low[0] < s && s < high[0] {
                let value = slope(s);
                *(if value < 0.0 { &mut low } else { &mut high }) = [s, value];
            }
        }
    }
    // Linear between the two; the slope grows there.
    (low[0] - low[1] * (high[0] - low[0]) / (high[1] - low[1])).clamp(low[0], high[0])
}

impl CoreBox {
    /// How deep a point is inside, negative, and the outward normal of the nearest face; `None` outside.
    pub fn depth(&self, x: &V) -> Option<(f64, V)> {
        let y = self.axes.tr_mul(&(x - self.centre));
        let beyond = y.zip_map(&self.half, |y, h| y.abs() - h);
        let k = beyond.imax();
        let normal = || self.axes.column(k) * y[k].signum();
        (beyond[k] < 0.0).then(|| (beyond[k], normal()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    const ROUNDING: f64 = 1e-6;

    fn random(rng: &mut fastrand::Rng) -> V {
        V::from_fn(|_, _| rng.f64() * 2.0 - 1.0)
    }

    fn core(from: V, to: Option<V>) -> Core {
        Core { from, way: to.map_or(V::zeros(), |to| to - from), is_segment: to.is_some() }
    }

    /// The least distance over a grid, refined around its best place.
    fn searched(distance: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut middle, mut width) = ([0.5, 0.5], 0.5);
        let mut best = f64::INFINITY;
        for _ in 0..60 {
            let around = middle;
            for i in -4..=4 {
                for j in -4..=4 {
                    let at = [i, j].map(f64::from);
                    let place = [0, 1].map(|k| (around[k] + width * at[k] / 4.0).clamp(0.0, 1.0));
                    let found = distance(place[0], place[1]);
                    if found < best {
                        (best, middle) = (found, place);
                    }
                }
            }
            width *= 0.6;
        }
        best
    }

    #[test]
    fn distances_are_the_least_over_both_cores() {
        let mut rng = fastrand::Rng::with_seed(1);
        for k in 0..400 {
            let [p, q, r, w] = [(); 4].map(|()| random(&mut rng));
            let a = core(p, (k % 2 == 0).then_some(q));
            let b = core(r, (k % 3 == 0).then_some(w));
            let found = Closest::of(&a, &b, ROUNDING);
            let least = searched(|s, t| (a.at(s) - b.at(t)).norm());
            let distance = (2.0 * found.half_square).sqrt();
            let lower =
                if a.is_segment && b.is_segment { (least * least - 0.5 * ROUNDING).sqrt() } else { least };
            assert!((lower - 1e-9..least + 1e-9).contains(&distance), "{k}: {distance} for {least}");
        }
    }

    #[test]
    fn distances_from_boxes_are_the_least() {
        let mut rng = fastrand::Rng::with_seed(2);
        for k in 0..400 {
            let [p, q, turn, centre] = [(); 4].map(|()| random(&mut rng) * 2.0);
            let axes = *Rotation3::from_scaled_axis(turn).matrix();
            let half = random(&mut rng).abs() + V::repeat(0.1);
            let other = CoreBox { axes, centre, half };
            let a = core(p, (k % 2 == 0).then_some(q));
            let found = Closest::to_box(&a, &other, ROUNDING);
            let outside = |x: V| {
                let y = axes.tr_mul(&(x - centre));
                y.zip_map(&half, |y, h| (y.abs() - h).max(0.0)).norm()
            };
            let least = searched(|s, _| outside(a.at(s)));
            let square = 2.0 * found.half_square;
            assert!(
                square <= least * least + 1e-9 && square >= least * least - 0.25 * ROUNDING - 1e-9,
                "{k}"
            );
        }
    }

    /// Parallel, crossing and touching segments, and segments along the face of a box or inside of it.
    #[test]
    fn special_places_are_finite() {
        let ends = [V::zeros(), V::x(), V::new(0.5, 0.0, 0.0), V::y(), V::new(2.0, 0.0, 0.0), V::z()];
        let finite = |found: &Closest| {
            let [ss, st, tt] = found.second;
            let determinant = ss * tt - st * st;
            assert!(found.half_square.is_finite() && found.places.iter().all(|s| (0.0..=1.0).contains(s)));
            assert!(found.free != [true, true] || determinant > 0.0);
        };
        let other = CoreBox { axes: Matrix3::identity(), centre: V::zeros(), half: V::new(1.0, 0.5, 0.1) };
        for p in ends {
            for q in ends.into_iter().filter(|q| *q != p) {
                for r in ends {
                    finite(&Closest::of(&core(p, Some(q)), &core(r, None), ROUNDING));
                    for w in ends.into_iter().filter(|w| *w != r) {
                        finite(&Closest::of(&core(p, Some(q)), &core(r, Some(w)), ROUNDING));
                    }
                }
                finite(&Closest::to_box(&core(p, Some(q)), &other, ROUNDING));
            }
            finite(&Closest::to_box(&core(p, None), &other, ROUNDING));
        }
        let (depth, normal) = other.depth(&V::new(0.2, -0.45, 0.0)).unwrap();
        assert!((depth + 0.05).abs() < 1e-15 && normal == -V::y());
        assert_eq!(other.depth(&V::new(0.2, 0.0, 0.11)), None);
    }
}
