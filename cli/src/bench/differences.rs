//! Central differences at the state that is timed.

use super::state::{Failure, State};
use costate::configuration::ConfigurationSpace;
use costate::robot::Robot;

/// Central differences: column j is `(g(z + h e_j) - g(z - h e_j)) / 2h`.
///
/// z is x = (q, p), or with quaternions (d, p) for q (+) d.
pub struct Differences {
    n: usize,
    /// q (+) d, where it differs from q + d.
    moved: Option<(ConfigurationSpace, Vec<f64>)>,
    z: Vec<f64>,
    columns: Vec<f64>,
}

/// About the cube root of the rounding error of f64, where truncation and rounding errors are about equal.
const STEP: f64 = 6e-6;

impl Differences {
    pub fn new(robot: &Robot) -> Self {
        let (n, space) = (robot.dof(), ConfigurationSpace::new(robot));
        let moved = (!robot.free_joints().is_empty()).then(|| (space, vec![0.0; robot.nq()]));
        Self { n, moved, z: vec![0.0; 2 * n], columns: vec![0.0; 4 * n * n] }
    }

    /// `add_to([q, p], sign, column)` adds `sign g(q, p)` to the column.
    pub fn of(
        &mut self,
        state: &State,
        mut add_to: impl FnMut([&[f64]; 2], f64, &mut [f64]) -> Result<(), Failure>,
    ) -> Result<&[f64], Failure> {
        let Self { n, moved, z, columns } = self;
        for (j, column) in columns.chunks_mut(2 * *n).enumerate() {
            column.fill(0.0);
            for sign in [1.0, -1.0] {
                z.copy_from_slice(&state.z);
                z[j] += sign * STEP;
                let (mut q, p) = z.split_at(*n);
                if let Some((space, to)) = moved {
                    space.integrate(&state.q, q, to)?;
                    q = to;
                }
                add_to([q, p], sign * 0.5 / STEP, column)?;
            }
        }
        Ok(columns)
    }
}
