//! Orientations over time.

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// A curve through orientations that are given at times, C1, with angular velocities of zero at both ends;
/// before and after them it holds the orientations there.
///
/// Between two knots $R = R\_a E\_1 E\_2 E\_3$ with $E\_k = \exp(\beta\_k \hat w\_k)$, where
///
/// $$ \beta\_1 = 1 - (1 - x)^3, \quad \beta\_2 = 3 x^2 - 2 x^3, \quad \beta\_3 = x^3 $$
///
/// and w_1, w_3 are a third of the interval times the angular velocities at its ends, in axes of the frame.
/// M.-J. Kim, M.-S. Kim, S. Y. Shin, SIGGRAPH 1995.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Turns {
    times: Vec<f64>,
    knots: Vec<Rotation3<f64>>,
    /// w_1, w_2, w_3 of each interval.
    vectors: Vec<[Vector3<f64>; 3]>,
    /// Angular velocities at the knots.
    velocities: Vec<Vector3<f64>>,
}

/// An orientation with its angular velocity and the derivative of that, both in axes of the frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub rotation: Rotation3<f64>,
    pub velocity: Vector3<f64>,
    pub acceleration: Vector3<f64>,
}

/// The rotation vector, exact for small angles.
pub(super) fn log(rotation: &Rotation3<f64>) -> Vector3<f64> {
    UnitQuaternion::from_rotation_matrix(rotation).scaled_axis()
}

impl Turns {
    /// Through these orientations.
    pub fn new(times: &[f64], knots: &[Rotation3<f64>]) -> Self {
        let mut turns = Self::default();
        turns.set(times, knots);
        turns
    }

    /// Times of the knots.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Takes other knots; allocates only if there are more than ever before.
    pub fn set(&mut self, times: &[f64], knots: &[Rotation3<f64>]) {
        self.times.clear();
        self.times.extend_from_slice(times);
        self.knots.clear();
        self.knots.extend_from_slice(knots);
        self.velocities.clear();
        self.velocities.resize(knots.len(), Vector3::zeros());
        let mean = |i: usize| log(&(knots[i].inverse() * knots[i + 1])) / (times[i + 1] - times[i]);
        for i in 1..knots.len().saturating_sub(1) {
            let (g, h) = (times[i] - times[i - 1], times[i + 1] - times[i]);
            self.velocities[i] = (mean(i - 1) * h + mean(i) * g) / (g + h);
        }
        self.vectors.clear();
        for i in 0..knots.len() - 1 {
            let third = (times[i + 1] - times[i]) / 3.0;
            let (first, last) = (self.velocities[i] * third, self.velocities[i + 1] * third);
            let back = |w: Vector3<f64>| Rotation3::from_scaled_axis(-w);
            let middle = log(&(back(first) * knots[i].inverse() * knots[i + 1] * back(last)));
            self.vectors.push([first, middle, last]);
        }
    }

    /// At a time.
    pub fn at(&self, time: f64) -> Turn {
        let last = self.times.len() - 1;
        if time < self.times[0] || time >= self.times[last] {
            let rotation = self.knots[if time < self.times[0] { 0 } else { last }];
            return Turn { rotation, velocity: Vector3::zeros(), acceleration: Vector3::zeros() };
        }
        let i = self.times.partition_point(|&knot| knot <= time) - 1;
        let h = self.times[i + 1] - self.times[i];
        let x = (time - self.times[i]) / h;
        let y = 1.0 - x;
        let values = [1.0 - y * y * y, x * x * (3.0 - 2.0 * x), x * x * x];
        let slopes = [3.0 * y * y, 6.0 * x * y, 3.0 * x * x];
        let bends = [-6.0 * y, 6.0 - 12.0 * x, 6.0 * x];
        let mut turn =
            Turn { rotation: self.knots[i], velocity: Vector3::zeros(), acceleration: Vector3::zeros() };
        for (k, w) in self.vectors[i].iter().enumerate() {
            let factor = Rotation3::from_scaled_axis(w * values[k]);
            let own = w * (slopes[k] / h);
            // In axes that turn with the factor.
            let carried = factor.inverse() * turn.velocity;
            turn.acceleration =
                factor.inverse() * turn.acceleration - own.cross(&carried) + w * (bends[k] / (h * h));
            turn.velocity = carried + own;
            turn.rotation *= factor;
        }
        turn
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns() -> Turns {
        let knots = [[0.0; 3], [0.5, -1.0, 2.0], [-1.0, 0.3, 1.2], [-1.0, 0.3, 1.3]];
        let knots = knots.map(|[r, p, y]| Rotation3::from_euler_angles(r, p, y));
        Turns::new(&[0.1, 0.6, 1.5, 1.7], &knots)
    }

    #[test]
    fn knots_are_met_and_velocities_do_not_jump() {
        let turns = turns();
        for (&time, knot) in turns.times.iter().zip(&turns.knots) {
            for time in [time - 1e-9, time] {
                assert!(log(&(turns.at(time).rotation.inverse() * knot)).norm() < 1e-7, "{time}");
            }
            let jump = turns.at(time).velocity - turns.at(time - 1e-9).velocity;
            assert!(jump.norm() < 1e-6, "{time}: {jump}");
        }
        assert!(turns.at(0.0).velocity.norm() == 0.0 && turns.at(2.0).velocity.norm() == 0.0);
        assert!(turns.at(0.6).velocity.norm() > 0.5);
    }

    #[test]
    fn velocities_are_those_by_differences() {
        let (turns, step) = (turns(), 1e-5);
        for time in [0.1 + 2.0 * step, 0.3, 0.59, 0.61, 1.0, 1.6] {
            let [below, at, above] = [time - step, time, time + step].map(|time| turns.at(time));
            let difference = log(&(below.rotation.inverse() * above.rotation)) / (2.0 * step);
            assert!((difference - at.velocity).norm() < 1e-7, "{time}");
            // Components in axes of the frame: no further term.
            let difference = (above.velocity - below.velocity) / (2.0 * step);
            assert!((difference - at.acceleration).norm() < 1e-7, "{time}");
        }
    }
}
