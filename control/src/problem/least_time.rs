//! Times that joints need at least for their ways, whatever the dynamics are.

use super::limits::JointLimits;
use super::{FinalTime, Problem};
use crate::constants::least_time as constants;

/// A joint that has too little time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TooShort {
    pub joint: usize,
    /// Whether its acceleration is what takes so long; else its rate.
    pub is_acceleration: bool,
    /// The limit, and by how much it must give for the time that is given.
    pub limit: f64,
    pub amount: f64,
    /// The least time (s).
    pub needed: f64,
}

impl Problem {
    /// The joint that needs the longest time, if that is longer than the one that is given: a proof that no
    /// motion keeps the limits. Only joints whose way is given count.
    ///
    /// With |v| <= V a way D takes |D| / V. With |a| <= A too, and given rates at both ends, the fastest
    /// motion accelerates to a peak, perhaps stays at V, and brakes.
    pub(crate) fn too_short(&self) -> Option<TooShort> {
        let FinalTime::Fixed(time) = self.time else { return None };
        // Vias make ways longer: the time of the shortest one is needed all the more.
        let ends = self.ends();
        let (start, end) = (&ends[0], &ends[ends.len() - 1]);
        let joint_limits = self.joint_limits();
        let short = |(joint, limits): (usize, &JointLimits)| {
            if start.q_free.contains(&joint) || end.q_free.contains(&joint) {
                return None;
            }
            let (way, rates) = (end.q[joint] - start.q[joint], [start.v[joint], end.v[joint]]);
            let rounding = f64::EPSILON * (start.q[joint].abs() + end.q[joint].abs());
            let free = start.v_free.contains(&joint) || end.v_free.contains(&joint);
            // Beyond rounding.
            let is_short = |needed: f64| needed > time * (1.0 + constants::ROUNDING_OF_TIMES);
            let by_rate = (way.abs() - rounding) / limits.v;
            if is_short(by_rate) {
                let (limit, amount) = (limits.v, way.abs() / time - limits.v);
                return Some(TooShort { joint, is_acceleration: false, limit, amount, needed: by_rate });
            }
            let needed = |most: f64| least([way, rounding], rates, limits.v, most);
            if free || limits.a.is_infinite() || !is_short(needed(limits.a)) {
                return None;
            }
            let enough = bisected(limits.a, |most| !is_short(needed(most)))?;
            Some(TooShort {
                joint,
                is_acceleration: true,
                limit: limits.a,
                amount: enough - limits.a,
                needed: needed(limits.a),
            })
        };
        let found = joint_limits.iter().enumerate().filter_map(short);
        found.max_by(|a, b| a.needed.total_cmp(&b.needed))
    }
}

/// The least time for a way, known to `rounding`, from one rate to another one, with |v| <= `fastest`, |a| <=
/// `most`.
fn least([way, rounding]: [f64; 2], [from, to]: [f64; 2], fastest: f64, most: f64) -> f64 {
    // The way of the change of the rates alone, and its size.
    let straight = 0.5 * (from + to) * (to - from).abs() / most;
    let squares = 0.5 * (from * from + to * to);
    let size = way.abs() + straight.abs() + squares / most;
    // On one side of it the motion must turn, which may take much longer: rounding proves nothing there.
    if (way - straight).abs() <= rounding + constants::ROUNDING_OF_WAYS * size {
        return ((to - from).abs() - f64::EPSILON * (from.abs() + to.abs())).max(0.0) / most;
    }
    let sign = if way > straight { 1.0 } else { -1.0 };
    let (way, from, to) = (sign * way, sign * from, sign * to);
    // No less than this, whatever is rounded.
    let off = most * rounding + 4.0 * f64::EPSILON * (most * way.abs() + squares);
    let peak = (most * way + squares - off).max(0.0).sqrt();
    if peak <= fastest {
        return (2.0 * peak - from - to) / most;
    }
    let ramps = (fastest * fastest - squares) / most;
    (2.0 * fastest - from - to) / most + (way - ramps) / fastest
}

/// About the least value that is enough, from one that is not; `None` if none is.
fn bisected(low: f64, is_enough: impl Fn(f64) -> bool) -> Option<f64> {
    let mut high = 2.0 * low;
    for _ in 0..200 {
        if is_enough(high) {
            break;
        }
        high *= 2.0;
    }
    if !is_enough(high) {
        return None;
    }
    let mut low = low;
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if is_enough(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    #[test]
    fn least_times_are_those_of_bang_bang_motions() {
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        let least = |way: f64, rates: [f64; 2], fastest: f64, most: f64| {
            let found = least([way, 0.0], rates, fastest, most);
            let mirrored = least([-way, 0.0], rates.map(|rate| -rate), fastest, most);
            assert_eq!(found, mirrored, "{way} {rates:?}");
            found
        };
        // To rest from rest: 2 sqrt(D / A); with a plateau D / V + V / A.
        close(least(3.0, [0.0; 2], INF, 2.0), 2.0 * (1.5_f64).sqrt());
        close(least(-3.0, [0.0; 2], 1.0, 2.0), 3.0 + 0.5);
        // Straight from 1 to 2; from -1 to -2, -2 to -1; a little farther than that it must turn.
        close(least(1.5, [1.0, 2.0], INF, 1.0), 1.0);
        close(least(-1.5, [-1.0, -2.0], INF, 1.0), 1.0);
        close(least(-1.5, [-2.0, -1.0], INF, 1.0), 1.0);
        assert!(least(-1.5 + 1e-6, [-1.0, -2.0], INF, 1.0) > 4.9);
        // From 2 to rest within half of the way that this takes: beyond the end and back.
        let (beyond, back) = (2.0, 1.0_f64);
        close(least(1.0, [2.0, 0.0], INF, 1.0), beyond + 2.0 * back.sqrt());
        // The same by integration of random motions: none is faster.
        let mut random = fastrand::Rng::with_seed(7);
        for _ in 0..200 {
            let (mut v, mut q, step) = (random.f64() - 0.5, 0.0, 1e-2);
            let first = v;
            for _ in 0..100 {
                let a = 2.0 * random.f64() - 1.0;
                q += v * step + 0.5 * a * step * step;
                v += a * step;
            }
            assert!(least(q, [first, v], INF, 1.0) <= 1.0 + 1e-12, "{q} {first} {v}");
        }
    }

    #[test]
    fn constant_accelerations_take_no_longer_than_they_do() {
        let mut random = fastrand::Rng::with_seed(11);
        for _ in 0..20_000 {
            let size = 10.0_f64.powf(12.0 * random.f64() - 6.0);
            let mut number = |size: f64| size * (2.0 * random.f64() - 1.0);
            let (first, a) = (number(size), number(1.0));
            let (time, from) = (10.0_f64.powf(number(3.0)), number(1e6));
            let to = from + (first + 0.5 * a * time) * time;
            let rates = [first, first + a * time];
            // Less acceleration than there is is no faster.
            let rounding = f64::EPSILON * (from.abs() + to.abs());
            let found = least([to - from, rounding], rates, INF, a.abs());
            assert!(found <= time * (1.0 + 1e-9), "{found} {time} {first} {a}");
        }
    }

    #[test]
    fn what_is_enough_is_found() {
        assert!((bisected(1.0, |x| x >= 5.25).unwrap() - 5.25).abs() < 1e-12);
        assert_eq!(bisected(1.0, |_| false), None);
    }
}
