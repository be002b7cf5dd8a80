//! The mesh of a trajectory, from its times.

use crate::constants::checks::mesh_nodes::{MIDDLE, SAME};
use crate::result::trajectory::Trajectory;

impl Trajectory {
    /// The nodes of its mesh: phase p is `[p, p + 1]`. Of motions that neither shape of the direct method
    /// has, all times are nodes. `None` if a phase takes no time.
    pub(crate) fn mesh_nodes(&self) -> Option<Vec<f64>> {
        let mut nodes = vec![0.0];
        for (phase, rows) in self.phases().enumerate() {
            let t = self.t.get(rows)?;
            let (first, last) = (*t.first()?, *t.last()?);
            if last.is_nan() || last <= first {
                return None;
            }
            // With jumps at the nodes every fifth row ends an interval, and the next one stands at its time;
            // without, every fourth one does.
            let is_node: fn(usize) -> bool = match (has_intervals(t, 5, 5), has_intervals(t, 4, 5)) {
                (true, _) => |k| k % 5 == 4,
                (_, true) => |k| k % 4 == 0,
                _ => |_| true,
            };
            for k in (1..t.len()).filter(|&k| is_node(k)) {
                let part = (t[k] - first) / (last - first);
                if phase as f64 + part > nodes[nodes.len() - 1] + SAME {
                    nodes.push(phase as f64 + part);
                }
            }
            *nodes.last_mut()? = (phase + 1) as f64;
        }
        Some(nodes)
    }

    /// Whether its rows are those of a motion of the direct method whose accelerations are continuous.
    pub(crate) fn has_continuous_accelerations(&self) -> bool {
        let fits = |t: &[f64]| has_intervals(t, 4, 5) && !has_intervals(t, 5, 5);
        !self.t.is_empty() && self.phases().all(|rows| self.t.get(rows).is_some_and(fits))
    }
}

/// Whether intervals of `rows` times, one every `stride`, fill a phase, each with a time in its middle.
fn has_intervals(t: &[f64], stride: usize, rows: usize) -> bool {
    let shared = rows - stride;
    let starts = (0..t.len().saturating_sub(shared)).step_by(stride);
    t.len() % stride == shared
        && starts.map(|k| &t[k..k + rows]).all(|t| {
            let (width, middle) = (t[rows - 1] - t[0], (t[rows - 1] + t[0]) / 2.0);
            width > 0.0 && (t[rows / 2] - middle).abs() <= MIDDLE * width
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory(t: Vec<f64>, via_times: Vec<f64>) -> Trajectory {
        let rows = vec![Vec::new(); t.len()];
        Trajectory::from_rows(t, std::array::from_fn(|_| rows.clone())).with_via_times(via_times)
    }

    /// Times of intervals between these ends: at both ends and at places between them.
    fn times(ends: &[f64], places: &[f64]) -> Vec<f64> {
        let of =
            |ends: &[f64]| -> Vec<f64> { places.iter().map(|x| ends[0] + x * (ends[1] - ends[0])).collect() };
        ends.windows(2).flat_map(of).collect()
    }

    fn close(found: Option<Vec<f64>>, expected: &[f64]) {
        let found = found.unwrap();
        assert_eq!(found.len(), expected.len(), "{found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn motions_of_the_direct_method_have_its_nodes() {
        let gauss = [0.0, 0.1127, 0.5, 0.8873, 1.0];
        let (first, second) = (times(&[0.5, 0.6, 1.0], &gauss), times(&[1.0, 2.0, 3.0, 5.0], &gauss));
        let expected = [0.0, 0.2, 1.0, 1.25, 1.5, 2.0];
        close(trajectory(first.clone(), Vec::new()).mesh_nodes(), &expected[..3]);
        close(trajectory([first.clone(), second].concat(), vec![1.0]).mesh_nodes(), &expected);
        let mut smooth = times(&[0.0, 1.0, 1.5, 4.0], &[0.0, 0.1727, 0.5, 0.8273]);
        smooth.push(4.0);
        assert!(trajectory(smooth.clone(), Vec::new()).has_continuous_accelerations());
        assert!(!trajectory(first.clone(), Vec::new()).has_continuous_accelerations());
        assert!(!trajectory(Vec::new(), Vec::new()).has_continuous_accelerations());
        close(trajectory(smooth, Vec::new()).mesh_nodes(), &[0.0, 0.25, 0.375, 1.0]);
    }

    #[test]
    fn all_times_of_other_motions_are_nodes() {
        let uneven = vec![0.0, 0.1, 0.2, 0.5, 1.0, 1.0, 1.2, 1.5, 1.6, 2.0];
        let expected = [0.0, 0.05, 0.1, 0.25, 0.5, 0.6, 0.75, 0.8, 1.0];
        close(trajectory(uneven, Vec::new()).mesh_nodes(), &expected);
        assert!(trajectory(vec![1.0, 1.0], Vec::new()).mesh_nodes().is_none());
        assert!(trajectory(vec![0.0, f64::NAN], Vec::new()).mesh_nodes().is_none());
        assert!(trajectory(Vec::new(), Vec::new()).mesh_nodes().is_none());
    }
}
