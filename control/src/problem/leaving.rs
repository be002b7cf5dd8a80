//! Ends at which no motion keeps a limit, or no motion is optimal.

use super::end_error::{EndError, Leads};
use super::error::ProblemError;
use super::key::Key;
use super::{BoundaryState, Problem};
use crate::constants::task::AWAY;

/// A quantity at an end, with its limits and its derivatives.
struct Given {
    value: f64,
    limits: [f64; 2],
    /// Its first derivative.
    slope: f64,
    /// Its second one, if that is given too.
    curve: Option<f64>,
}

/// Which derivative leads beyond a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Slope,
    Curve,
}

impl Problem {
    /// Whether positions and rates that are given at a limit stay within it beside that end.
    ///
    /// # Errors
    /// [`ProblemError::End`] with the joint.
    pub(super) fn check_leaving(&self) -> Result<(), ProblemError> {
        let (limits, ends, time) = (self.joint_limits(), self.ends(), self.time.value());
        for (number, end) in ends.iter().enumerate() {
            let sides = [number > 0, number + 1 < ends.len()];
            let [_, key_v, key_a] = self.keys_of_end(number);
            for (j, limits) in limits.iter().enumerate() {
                let BoundaryState { q, v, a, q_free, v_free } = end;
                let a = a.as_ref().map(|a| a[j]);
                let refuse = |key, leads, limit, slope| {
                    let cause = EndError::Leaves { joint: self.name(j), leads, limit, slope };
                    Err(ProblemError::End { key, cause })
                };
                if v_free.contains(&j) {
                    continue;
                }
                let position = Given { value: q[j], limits: limits.q, slope: v[j], curve: a };
                if !q_free.contains(&j) {
                    match (position.leaves(sides, time), a) {
                        (Some(Order::Slope), _) => return refuse(key_v, Leads::PositionByRate, q[j], v[j]),
                        (Some(Order::Curve), Some(a)) => {
                            return refuse(key_a, Leads::PositionByAcceleration, q[j], a);
                        }
                        _ => {}
                    }
                }
                let Some(slope) = a else { continue };
                let rate = Given { value: v[j], limits: [-limits.v, limits.v], slope, curve: None };
                if rate.leaves(sides, time).is_some() {
                    return refuse(key_a, Leads::RateByAcceleration, v[j], slope);
                }
            }
        }
        Ok(())
    }

    /// Whether a jump of the accelerations beside an end where they are given is limited or costs anything.
    ///
    /// A jump da is free of both if da_j = 0 for the joints with a jerk that matters, and (M da)_i = 0 for
    /// those with a rate of their torque that does. With fewer than n of these conditions there is one.
    ///
    /// # Errors
    /// [`ProblemError::End`] with the first joint without any of them.
    pub(super) fn check_accelerations(&self) -> Result<(), ProblemError> {
        let given = [(&self.start, Key::START_A), (&self.end, Key::END_A)];
        let Some((_, key)) = given.into_iter().find(|(end, _)| end.a.is_some()) else { return Ok(()) };
        let limited =
            |list: &Option<Vec<f64>>, j: usize| list.as_ref().is_some_and(|list| list[j].is_finite());
        let costs = |list: &Option<Vec<f64>>, j: usize| list.as_ref().is_some_and(|list| list[j] > 0.0);
        let jerk = |j: usize| limited(&self.limits.jerk_max, j) || costs(&self.cost.jerk, j);
        let rate = |j: usize| limited(&self.limits.torque_rate_max, j) || costs(&self.cost.torque_rate, j);
        let n = self.robot.dof();
        let conditions = (0..n).map(|j| usize::from(jerk(j)) + usize::from(rate(j))).sum::<usize>();
        let alone = (0..n).find(|&j| !jerk(j) && !rate(j)).filter(|_| conditions < n);
        alone.map_or(Ok(()), |joint| {
            let cause = EndError::AccelerationJumps { joint: self.name(joint) };
            Err(ProblemError::End { key, cause })
        })
    }
}

impl Given {
    /// What leads beyond the limits before this end or after it: `sides` says on which of them the motion is.
    /// Derivatives count that would cross a part of the limits within `time` (s).
    fn leaves(&self, [before, after]: [bool; 2], time: f64) -> Option<Order> {
        let [low, high] = self.limits;
        let range = high - low;
        let size = AWAY * if range.is_finite() { range } else { self.value.abs().max(1.0) };
        [(low, -1.0), (high, 1.0)].into_iter().find_map(|(limit, outwards)| {
            let slope = outwards * self.slope * time;
            let curve = self.curve.map_or(0.0, |curve| outwards * curve * time * time);
            match self.value == limit {
                true if (after && slope > size) || (before && slope < -size) => Some(Order::Slope),
                true if slope.abs() <= size && curve > size => Some(Order::Curve),
                _ => None,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Given, Order};

    #[test]
    fn what_leads_beyond_a_limit_depends_on_the_side_of_the_motion() {
        const SLOPE: Option<Order> = Some(Order::Slope);
        const CURVE: Option<Order> = Some(Order::Curve);
        let at = |value, slope, curve| Given { value, limits: [-1.0, 2.0], slope, curve };
        let (start, end, via) = ([false, true], [true, false], [true, true]);
        for (given, sides, leaves) in [
            (at(2.0, 0.5, None), start, SLOPE),
            (at(2.0, -0.5, None), start, None),
            (at(2.0, 0.5, None), end, None),
            (at(2.0, -0.5, None), end, SLOPE),
            (at(-1.0, -0.5, None), start, SLOPE),
            (at(-1.0, -0.5, None), end, None),
            (at(2.0, 0.5, None), via, SLOPE),
            (at(2.0, -0.5, None), via, SLOPE),
            (at(1.9, 0.5, Some(9.0)), start, None),
            (at(2.0, 0.0, None), via, None),
            (at(2.0, 1e-12, None), start, None),
            (at(2.0, 0.0, Some(1.0)), end, CURVE),
            (at(2.0, 0.0, Some(-1.0)), start, None),
            (at(-1.0, 0.0, Some(-1.0)), start, CURVE),
        ] {
            let Given { value, slope, curve, .. } = given;
            assert_eq!(given.leaves(sides, 1.0), leaves, "{value} {slope} {curve:?} {sides:?}");
        }
    }
}
