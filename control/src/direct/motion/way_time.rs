//! Least times of single joints between two states, by which positions at an end are ranked.

use crate::constants::direct::NEGLIGIBLE_WAY;
use crate::problem::BoundaryState;
use crate::problem::least_time::{self, Ramp};
use crate::problem::limits::JointLimits;

/// The least time of the slowest joint (s):
///
/// $$ T \ge \max_i t_i, \qquad
///    t_i = \min \{ t : |\dot q_i| \le V_i, |\ddot q_i| \le A_i, |\dddot q_i| \le J_i \} $$
///
/// from the state before to `q` in the place of the position after. No motion that keeps the limits of its
/// joints is faster, whatever the dynamics are.
pub(crate) fn least_time([from, to]: [&BoundaryState; 2], q: &[f64], limits: &[JointLimits]) -> f64 {
    let of = |(i, limits): (usize, &JointLimits)| {
        let way = (q[i] - from.q[i]).abs();
        let by_rate = if limits.v.is_finite() { way / limits.v } else { 0.0 };
        let rests = |end: &BoundaryState| end.v[i] == 0.0 && !end.v_free.contains(&i);
        if !(rests(from) && rests(to)) || way <= NEGLIGIBLE_WAY {
            return by_rate;
        }
        // A given acceleration other than zero may help.
        let from_zero = |end: &BoundaryState| end.a.as_ref().is_some_and(|a| a[i] == 0.0);
        rest_to_rest(way, limits, [from_zero(from), from_zero(to)])
    };
    limits.iter().enumerate().map(of).fold(0.0, f64::max)
}

/// The least time for a way from rest to rest: a ramp up to the largest rate that the way has room for, the
/// rest of the way at that rate, and a ramp down. `from_zero` says at which ends the acceleration is zero; it
/// is free at the others.
fn rest_to_rest(way: f64, limits: &JointLimits, from_zero: [bool; 2]) -> f64 {
    let JointLimits { v, a, jerk, .. } = *limits;
    if jerk.is_infinite() || from_zero == [true; 2] {
        return least_time::rest_to_rest(way, [v, a, jerk]);
    }
    let ramps = |rate: f64| from_zero.map(|zero| ramp(rate, limits, zero));
    let room = |rate: f64| ramps(rate).iter().map(|ramp| ramp.way).sum::<f64>() <= way;
    let mut rate = limits.v;
    if !(rate.is_finite() && room(rate)) {
        // A rate with which ramps take all of the way, if there is one.
        let mut low = 0.0;
        let mut high = if rate.is_finite() { rate } else { way };
        while room(high) && high < f64::MAX / 4.0 {
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if room(middle) { low = middle } else { high = middle }
        }
        rate = low;
    }
    if rate <= 0.0 {
        return 0.0;
    }
    let ramps = ramps(rate);
    let [time, used] = ramps.iter().fold([0.0; 2], |[t, d], ramp| [t + ramp.time, d + ramp.way]);
    time + (way - used).max(0.0) / rate
}

/// With |a| <= A, |j| <= J. Where the first acceleration is free, it is the one from which it falls to zero.
fn ramp(rate: f64, limits: &JointLimits, from_zero: bool) -> Ramp {
    let JointLimits { a: most, jerk, .. } = *limits;
    if from_zero {
        return Ramp::from_zero(rate, [most, jerk]);
    }
    if 2.0 * rate * jerk <= most * most {
        let time = (2.0 * rate / jerk).sqrt();
        return Ramp { time, way: 2.0 / 3.0 * rate * time };
    }
    let falls = most / jerk;
    let before = rate / most - 0.5 * falls;
    let way = 0.5 * most * before * before + (rate - jerk * falls * falls / 6.0) * falls;
    Ramp { time: before + falls, way }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    fn limits(v: f64, a: f64, jerk: f64) -> JointLimits {
        JointLimits {
            q: [-INF, INF],
            v,
            a,
            torque: [-INF, INF],
            jerk,
            torque_rate: INF,
            power: INF,
            speeds: [INF; 2],
        }
    }

    fn close(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn least_times_from_rest_to_rest_are_those_of_closed_forms() {
        let time = |way: f64, v: f64, a: f64, jerk: f64, zero: bool| {
            rest_to_rest(way, &limits(v, a, jerk), [zero; 2])
        };
        // Accelerations that jump: 2 sqrt(D/A), D/V + V/A.
        close(time(3.0, INF, 2.0, INF, true), 2.0 * 1.5_f64.sqrt());
        close(time(3.0, 1.0, 2.0, INF, false), 3.5);
        // From zero acceleration: (32 D/J)^(1/3), and D/V + 2 sqrt(V/J).
        close(time(2.0, INF, INF, 1.0, true), 4.0);
        close(time(5.0, 1.0, INF, 4.0, true), 5.0 + 1.0);
        // D/V + V/A + A/J.
        close(time(10.0, 2.0, 1.0, 2.0, true), 5.0 + 2.0 + 0.5);
        // The acceleration falls all along: (12 D/J)^(1/3).
        close(time(18.0, INF, INF, 1.0, false), 6.0);
        // Ramps with two thirds of V t_r: 2 t_r + (D - 4/3 V t_r)/V with t_r = sqrt(2 V/J).
        close(time(5.0, 1.0, INF, 2.0, false), 2.0 + 5.0 - 4.0 / 3.0);
        // A ramp of a free acceleration beyond A: before at A for V/A - A/(2J), then A/J.
        let found = ramp(2.0, &limits(INF, 1.0, 2.0), false);
        close(found.time, 2.0 - 0.25 + 0.5);
        close(found.way, 0.5 * 1.75 * 1.75 + 1.75 * 0.5 + 0.5 * 0.25 - 2.0 * 0.125 / 6.0);
    }

    #[test]
    fn joints_without_limits_take_no_time() {
        assert!(rest_to_rest(1.0, &limits(INF, INF, INF), [true; 2]) < 1e-300);
        let from = BoundaryState::fixed(&[0.0, 0.0], &[0.0, 0.5]);
        let to = BoundaryState::fixed(&[0.0, 0.0], &[0.0, 0.0]);
        let all = [limits(INF, INF, 1.0), limits(2.0, INF, 1.0)];
        // The second one moves at its start, so that only its largest rate says anything.
        close(least_time([&from, &to], &[0.0, 3.0], &all), 1.5);
        close(least_time([&from, &to], &[18.0, 3.0], &all), 6.0);
        let zero = from.clone().with_a(&[0.0, 0.0]);
        assert!(least_time([&zero, &to], &[18.0, 3.0], &all) > 6.0);
    }
}
