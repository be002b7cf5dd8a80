//! Times that joints need at least for their ways, whatever the dynamics are: proofs that a fixed time is too
//! short, and first guesses of a free one.
//!
//! The limits of the other joints, of torques, tools and all else are left out. So no motion that keeps all
//! limits is faster, whatever is free takes as its value.

use super::limits::JointLimits;
use super::rounded::rounded;
use super::{BoundaryState, FinalTime, Problem};
use crate::constants::least_time as constants;
use costate::robot::{JointKind, printable};

/// A joint that has too little time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TooShort {
    pub joint: usize,
    /// The derivative of q whose limit is what takes so long: 1 for its rate, 2 for its acceleration, 3 for
    /// its jerk.
    pub order: usize,
    /// The limit, and by how much it must give for the time that is given.
    pub limit: f64,
    pub amount: f64,
    /// The least time and the one that is given (s).
    pub needed: f64,
    pub given: f64,
}

/// The way of a joint with what is given at its ends; `None` for what is free.
#[derive(Clone, Copy, Debug)]
struct Way {
    /// From start to end, and how much of it is rounding.
    length: f64,
    rounding: f64,
    rates: Option<[f64; 2]>,
    accelerations: Option<[f64; 2]>,
}

impl Way {
    /// Of a joint between two states; `None` unless both positions are given.
    fn of(joint: usize, [start, end]: [&BoundaryState; 2]) -> Option<Self> {
        if start.q_free.contains(&joint) || end.q_free.contains(&joint) {
            return None;
        }
        let rates_are_free = start.v_free.contains(&joint) || end.v_free.contains(&joint);
        let accelerations = start.a.as_ref().zip(end.a.as_ref()).map(|(from, to)| [from[joint], to[joint]]);
        Some(Self {
            length: end.q[joint] - start.q[joint],
            rounding: f64::EPSILON * (start.q[joint].abs() + end.q[joint].abs()),
            rates: (!rates_are_free).then(|| [start.v[joint], end.v[joint]]),
            accelerations,
        })
    }

    /// T >= |D| / V: with |v| <= V a way D takes no less.
    fn by_rate(&self, fastest: f64) -> f64 {
        ((self.length.abs() - self.rounding) / fastest).max(0.0)
    }

    /// With |a| <= A too, and given rates at both ends: the fastest motion accelerates to a peak, perhaps
    /// stays at V, and brakes.
    fn by_acceleration(&self, limits: &JointLimits) -> f64 {
        match self.rates {
            Some(rates) if limits.a.is_finite() => {
                least([self.length, self.rounding], rates, limits.v, limits.a)
            }
            _ => 0.0,
        }
    }

    /// With |j| <= J from rest to rest. If the accelerations at the ends are free, `D <= J T^3 / 12`: v
    /// vanishes at both ends, so `v(t) <= J t (T - t) / 2`, as v - J t (T - t) / 2 is convex. If they are
    /// zero, the motion of least time has seven pieces of constant jerk, with peaks of a and v at their
    /// limits or below (L. Biagiotti, C. Melchiorri, Trajectory planning for automatic machines and robots,
    /// 2008, section 3.4). With other rates nothing is claimed.
    fn by_jerk(&self, limits: &JointLimits) -> f64 {
        let (way, jerk) = (self.length.abs() - self.rounding, limits.jerk);
        if self.rates != Some([0.0; 2]) || jerk.is_infinite() || way <= 0.0 {
            return 0.0;
        }
        match self.accelerations {
            Some([0.0, 0.0]) => rest_to_rest(way, [limits.v, limits.a, jerk]),
            _ => (12.0 * way / jerk).cbrt(),
        }
    }

    /// The least of times that all three allow.
    fn time(&self, limits: &JointLimits) -> f64 {
        self.by_rate(limits.v).max(self.by_acceleration(limits)).max(self.by_jerk(limits))
    }
}

impl Problem {
    /// The joint that needs the longest time, if that is longer than the one that is given: a proof that no
    /// motion keeps the limits. Only joints whose way is given count.
    pub(crate) fn too_short(&self) -> Option<TooShort> {
        let FinalTime::Fixed(given) = self.time else { return None };
        // Vias make ways longer: the time of the shortest one is needed all the more.
        let ends = self.ends();
        let ends = [&ends[0], &ends[ends.len() - 1]];
        // Beyond rounding.
        let is_short = |needed: f64| needed > given * (1.0 + constants::ROUNDING_OF_TIMES);
        let short = |(joint, limits): (usize, &JointLimits)| {
            let way = Way::of(joint, ends)?;
            let of_order = |order: usize, limits: &JointLimits| match order {
                1 => way.by_rate(limits.v),
                2 => way.by_acceleration(limits),
                _ => way.by_jerk(limits),
            };
            let order = (1..=3).find(|&order| is_short(of_order(order, limits)))?;
            let limit = [limits.v, limits.a, limits.jerk][order - 1];
            let with = |most: f64| match order {
                1 => JointLimits { v: most, ..*limits },
                2 => JointLimits { a: most, ..*limits },
                _ => JointLimits { jerk: most, ..*limits },
            };
            let enough = bisected(limit, |most| !is_short(of_order(order, &with(most))))?;
            let (amount, needed) = (enough - limit, way.time(limits));
            Some(TooShort { joint, order, limit, amount, needed, given })
        };
        let limits = self.joint_limits();
        let found = limits.iter().enumerate().filter_map(short);
        // The first one of several that need as long.
        found.max_by(|a, b| a.needed.total_cmp(&b.needed).then(b.joint.cmp(&a.joint)))
    }

    /// A time (s) that the motion needs at least: the sum over phases of the longest of its joints, with the
    /// rates of vias as guesses only.
    pub(crate) fn shortest_time(&self) -> f64 {
        let (ends, limits) = (self.ends(), self.joint_limits());
        let phase = |ends: &[BoundaryState]| {
            let times = limits
                .iter()
                .enumerate()
                .filter_map(|(joint, limits)| Some(Way::of(joint, [&ends[0], &ends[1]])?.time(limits)));
            times.filter(|time| time.is_finite()).fold(0.0, f64::max)
        };
        ends.windows(2).map(phase).sum()
    }
}

impl TooShort {
    /// "rate", "acceleration" or "jerk", with its unit.
    pub fn kind(&self, joint: JointKind) -> (&'static str, &'static str) {
        let kind = ["rate", "acceleration", "jerk"][self.order - 1];
        let units = match joint {
            JointKind::Prismatic => ["m/s", "m/s^2", "m/s^3"],
            JointKind::Revolute => ["rad/s", "rad/s^2", "rad/s^3"],
        };
        (kind, units[self.order - 1])
    }

    /// The proof in words.
    pub fn proof(&self, problem: &Problem) -> String {
        let joint = problem.robot.independent_joints().nth(self.joint);
        let (name, kind) = joint.map_or((String::new(), JointKind::Revolute), |joint| {
            (printable(&joint.name).to_string(), joint.kind)
        });
        let (what, unit) = self.kind(kind);
        format!(
            "joint '{name}' needs {} s for its way at the least, with its limits of rates, accelerations and jerks, and \
             has {} s (its {what} limit is {} {unit})",
            rounded(self.needed),
            rounded(self.given),
            rounded(self.limit)
        )
    }
}

/// The fastest way from rest to a rate with no acceleration left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp {
    pub time: f64,
    pub way: f64,
}

impl Ramp {
    /// From rest without acceleration to a rate with |a| <= A, |j| <= J: the acceleration rises at J, perhaps
    /// stays at A, and falls at J. The mean rate is half of the last one.
    pub fn from_zero(rate: f64, [most, jerk]: [f64; 2]) -> Self {
        let time = match rate * jerk < most * most {
            true => 2.0 * (rate / jerk).sqrt(),
            false => most / jerk + rate / most,
        };
        Self { time, way: 0.5 * rate * time }
    }
}

/// The least time from rest to rest without accelerations at the ends, with |v| <= V, |a| <= A, |j| <= J;
/// with an infinite J accelerations jump there.
pub(crate) fn rest_to_rest(way: f64, [fastest, most, jerk]: [f64; 3]) -> f64 {
    if most.is_infinite() && jerk.is_infinite() {
        return way / fastest;
    }
    // Until V, and the way of both ramps.
    let ramp = Ramp::from_zero(fastest, [most, jerk]).time;
    if way >= fastest * ramp {
        return ramp + way / fastest;
    }
    let onset = most / jerk;
    match way < 2.0 * most * onset * onset {
        true => (32.0 * way / jerk).cbrt(),
        false => onset + (onset * onset + 4.0 * way / most).sqrt(),
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

    /// From rest to rest, and with free accelerations at the ends: closed forms, and no random motion of
    /// pieces of constant jerk is faster.
    #[test]
    fn least_times_with_jerks_are_those_of_seven_pieces() {
        let close =
            |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        close(rest_to_rest(20_000.0, [1.0, 2.7, 1.0]), 20_002.0);
        close(rest_to_rest(1.0, [INF, INF, 10.0]), 3.2_f64.cbrt());
        close(rest_to_rest(3.0, [1.0, 2.0, INF]), 3.0 + 0.5);
        close(rest_to_rest(3.0, [2.0, INF, INF]), 1.5);
        // Where one case ends the next one begins.
        for (fastest, most, jerk) in [(1.0, 2.0, 5.0), (3.0, 1.0, 2.0)] {
            for way in [1e-3_f64, 0.08, 0.5, 0.8, 2.0, 4.0, 10.5, 11.0] {
                let [less, more] =
                    [1.0 - 1e-9, 1.0 + 1e-9].map(|x| rest_to_rest(x * way, [fastest, most, jerk]));
                assert!(less < more && more - less < 1e-7 * more, "{way} {less} {more}");
            }
        }
        let mut random = fastrand::Rng::with_seed(5);
        for _ in 0..2000 {
            // A symmetric motion: ramps to a random peak, then back.
            let [a, b, c] = std::array::from_fn(|_| random.f64());
            let (jerk, rise, hold, slide) = (0.5 + a, b, c, random.f64());
            let (peak, ramp) = (jerk * rise, 2.0 * rise + hold);
            let fastest = peak * (rise + hold);
            let (way, time) = (fastest * (ramp + slide), 2.0 * ramp + slide);
            let (v, a) = (fastest * (1.0 + random.f64()), peak * (1.0 + random.f64()));
            let found = rest_to_rest(way, [v, a, jerk]);
            assert!(found <= time * (1.0 + 1e-12), "{found} {time}");
            let limits = [fastest, peak, jerk];
            assert!((rest_to_rest(way, limits) / time - 1.0).abs() < 1e-9, "{limits:?} {way} {time}");
        }
    }

    #[test]
    fn what_is_enough_is_found() {
        assert!((bisected(1.0, |x| x >= 5.25).unwrap() - 5.25).abs() < 1e-12);
        assert_eq!(bisected(1.0, |_| false), None);
    }
}
