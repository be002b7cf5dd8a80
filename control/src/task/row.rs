//! What holds for a row.

use std::f64::consts::SQRT_2;

/// How names of clearances begin.
pub(crate) const CLEARANCE: &str = "clearance of ";

/// What holds for a row: `lower <= g <= upper`, an equation where both are one number.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub lower: f64,
    pub upper: f64,
    /// The unit of violations: a length, an angle or a speed at which the row matters.
    pub range: f64,
    /// What it is, for messages: "clearance of 'forearm' from 'post'".
    pub name: String,
    /// Unit of what a user means by it.
    pub unit: &'static str,
    pub measure: Measure,
    pub subject: Subject,
}

/// Under what reports tell a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subject {
    /// A tool, a clearance, a gait.
    Task,
    /// A force of the ground on a foot.
    GroundForce,
    /// The impulse of a landing on a foot.
    LandingImpulse,
}

/// How g is made from what a user means, a length, an angle or a speed x; close to its bound both change
/// alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measure {
    /// x.
    Plain,
    /// `x^2 / (2 s)`, at most s / 2.
    Square(f64),
    /// `(1 - cos x) / sin s`, at most that of x = s.
    Angle(f64),
    /// `sqrt2 sqrt((x + R)^2 + R^2) - 2 R` of the distance x between surfaces; where the cores meet, that of
    /// x = -R and a depth.
    Clearance(f64),
}

impl Row {
    /// The same number on both sides.
    pub fn equal(value: f64, range: f64, unit: &'static str, name: String) -> Self {
        let (measure, subject) = (Measure::Plain, Subject::Task);
        Self { lower: value, upper: value, range, name, unit, measure, subject }
    }

    /// A row of which x is at most s, for [`Measure::Square`] and [`Measure::Angle`].
    pub fn at_most(measure: Measure, unit: &'static str, name: String) -> Self {
        let (upper, range) = match measure {
            Measure::Square(s) => (0.5 * s, s),
            Measure::Angle(s) => ((0.5 * s).tan(), s),
            Measure::Plain | Measure::Clearance(_) => (0.0, 1.0),
        };
        Self { lower: f64::NEG_INFINITY, upper, range, name, unit, measure, subject: Subject::Task }
    }

    /// A clearance, which is not negative. R is the sum of the radii; 0 for a clearance that is a distance.
    pub fn clearance(radius: f64, is_distance: bool, name: String) -> Self {
        let range = if radius > 0.0 { radius } else { 1.0 };
        let measure = if is_distance { Measure::Plain } else { Measure::Clearance(radius) };
        Self { lower: 0.0, upper: f64::INFINITY, range, name, unit: "m", measure, subject: Subject::Task }
    }

    /// How far a value is outside, in units of g; 0 inside.
    pub fn violation(&self, g: f64) -> f64 {
        (self.lower - g).max(g - self.upper).max(0.0)
    }

    /// How far a value is outside (m, rad, m/s); 0 inside.
    pub fn excess(&self, g: f64) -> f64 {
        let violation = self.violation(g);
        if violation <= 0.0 {
            return violation;
        }
        match self.measure {
            Measure::Plain => violation,
            Measure::Square(s) => (2.0 * s * g).sqrt() - s,
            Measure::Angle(s) => (1.0 - g * s.sin()).clamp(-1.0, 1.0).acos() - s,
            Measure::Clearance(radius) => {
                // Below this the cores meet.
                let deep = (SQRT_2 - 2.0) * radius;
                let root = (0.5 * (g.max(deep) + 2.0 * radius).powi(2) - radius * radius).max(0.0).sqrt();
                radius - root + (deep - g).max(0.0)
            }
        }
    }

    /// Whether both bounds are one number.
    pub fn is_equation(&self) -> bool {
        self.lower == self.upper
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_excess_is_in_metres_radians_and_metres_a_second() {
        let name = String::new;
        let square = Row::at_most(Measure::Square(0.3), "m", name());
        assert!((square.excess(0.5 * 0.5 / 0.6) - 0.2).abs() < 1e-15);
        let angle = Row::at_most(Measure::Angle(0.3), "rad", name());
        assert!((angle.excess((1.0 - 0.7_f64.cos()) / 0.3_f64.sin()) - 0.4).abs() < 1e-14);
        assert!(angle.excess(1e3) > 2.8, "beyond a half turn there is nothing");
        let clearance = Row::clearance(0.2, false, name());
        let c = |distance: f64| SQRT_2 * (distance + 0.2).hypot(0.2) - 0.4;
        for depth in [1e-6, 0.05, 0.2] {
            assert!((clearance.excess(c(-depth)) - depth).abs() < 2e-8, "{depth}");
        }
        assert!((clearance.excess(c(-0.2) - 0.03) - 0.23).abs() < 2e-8);
        for (row, inside) in [(&square, 0.15), (&angle, 0.1), (&clearance, 0.0)] {
            assert!(row.excess(inside) == 0.0 && !row.is_equation());
        }
        assert_eq!(Row::equal(2.0, 1.0, "m", name()).excess(1.5), 0.5);
    }
}
