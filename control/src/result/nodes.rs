//! A motion at the nodes of its mesh, and between them.

use crate::bvp::collocation::lobatto::Lobatto;
use costate::matrix::add_scaled;
use serde::{Deserialize, Serialize};

/// A solved extremal at the nodes of its mesh; at a switch two nodes have the same time.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Nodes {
    /// Times (s), rising.
    pub t: Vec<f64>,
    /// z = (x, y) at the nodes.
    pub z: Vec<Vec<f64>>,
    /// Controls.
    pub u: Vec<Vec<f64>>,
    /// H*.
    pub hamiltonian: Vec<f64>,
    pub(crate) interpolant: Option<Interpolant>,
}

/// The collocation polynomial: on each interval the polynomial of degree s that has the slopes `g(z)` at the
/// s points of Lobatto's quadrature.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Interpolant {
    points: usize,
    /// dz/dt at the nodes.
    pub slopes: Vec<Vec<f64>>,
    /// dz/dt at the inner points of each span; none for a switch.
    pub inner: Vec<Vec<Vec<f64>>>,
    /// Controls at the same points.
    pub controls: Vec<Vec<Vec<f64>>>,
}

/// An interval of a motion and a place in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The node at its left end.
    pub left: usize,
    /// The part of the interval before the place, from 0 to 1.
    pub part: f64,
    /// Duration of the interval (s).
    pub length: f64,
}

/// The interval that holds `t`; `None` for fewer than two nodes, or a time outside of the motion.
pub(crate) fn place(times: &[f64], t: f64) -> Option<Place> {
    let (&first, &last) = (times.first()?, times.last()?);
    if times.len() < 2 || !(first..=last).contains(&t) {
        return None;
    }
    let left = times.partition_point(|&node| node <= t).clamp(1, times.len() - 1) - 1;
    let length = times[left + 1] - times[left];
    let part = if length > 0.0 { (t - times[left]) / length } else { 0.0 };
    Some(Place { left, part, length })
}

impl Interpolant {
    pub fn new(points: usize) -> Self {
        Self { points, slopes: Vec::new(), inner: Vec::new(), controls: Vec::new() }
    }

    /// Whether it has numbers for this many nodes.
    pub fn fits(&self, nodes: usize) -> bool {
        let spans = [self.inner.len(), self.controls.len()];
        self.slopes.len() == nodes && spans.iter().all(|count| count + 1 == nodes)
    }

    /// z in the interval of `place`, from its value at the left end.
    pub fn values(&self, left: &[f64], place: Place) -> Vec<f64> {
        let (method, mut z) = (Lobatto::of(self.points), left.to_vec());
        for (j, slope) in self.slopes_of(place.left).enumerate() {
            add_scaled(&mut z, place.length * method.weight(j, place.part), slope);
        }
        z
    }

    /// dz/dt in the interval of `place`.
    pub fn derivative(&self, place: Place) -> Vec<f64> {
        let method = Lobatto::of(self.points);
        let mut rate = vec![0.0; self.slopes[place.left].len()];
        for (j, slope) in self.slopes_of(place.left).enumerate() {
            add_scaled(&mut rate, method.lagrange(j, place.part), slope);
        }
        rate
    }

    /// Controls in the interval of `place`, from those at its ends: the polynomial through all of its points.
    pub fn controls_at(&self, ends: [&[f64]; 2], place: Place) -> Vec<f64> {
        let method = Lobatto::of(self.points);
        let inner = self.controls[place.left].iter().map(Vec::as_slice);
        let mut u = vec![0.0; ends[0].len()];
        for (j, at) in std::iter::once(ends[0]).chain(inner).chain([ends[1]]).enumerate() {
            add_scaled(&mut u, method.lagrange(j, place.part), at);
        }
        u
    }

    fn slopes_of(&self, left: usize) -> impl Iterator<Item = &[f64]> {
        let inner = self.inner[left].iter().map(Vec::as_slice);
        std::iter::once(self.slopes[left].as_slice()).chain(inner).chain([self.slopes[left + 1].as_slice()])
    }
}

impl Nodes {
    /// z at time t (s), by the collocation polynomial; `None` outside of the motion.
    ///
    /// At a switch the value is that of the arc which begins there.
    pub fn at(&self, t: f64) -> Option<Vec<f64>> {
        let place = place(&self.t, t)?;
        let left = &self.z[place.left];
        match &self.interpolant {
            Some(interpolant) => Some(interpolant.values(left, place)),
            None => {
                let mut z = left.clone();
                let right = &self.z[place.left + 1];
                z.iter_mut().zip(right).for_each(|(z, right)| *z += place.part * (right - *z));
                Some(z)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// z = t^3 on two intervals: exact for four points.
    #[test]
    fn cubics_are_interpolated_exactly() {
        let method = Lobatto::of(4);
        let (t, cube) = (vec![0.0, 1.0, 3.0], |t: f64| vec![t.powi(3)]);
        let slope = |t: f64| vec![3.0 * t * t];
        let inner_times = |k: usize| [1, 2].map(|j| t[k] + (t[k + 1] - t[k]) * method.points[j]);
        let inner = |f: &dyn Fn(f64) -> Vec<f64>| (0..2).map(|k| inner_times(k).map(f).to_vec()).collect();
        let interpolant = Interpolant {
            points: 4,
            slopes: t.iter().map(|&t| slope(t)).collect(),
            inner: inner(&slope),
            controls: inner(&cube),
        };
        let z: Vec<_> = t.iter().map(|&t| cube(t)).collect();
        let nodes = Nodes { t, u: z.clone(), z, hamiltonian: vec![0.0; 3], interpolant: Some(interpolant) };
        for at in [0.0, 0.3, 1.0, 1.7, 3.0] {
            assert!((nodes.at(at).unwrap()[0] - cube(at)[0]).abs() < 1e-13, "{at}");
            let (place, interpolant) = (place(&nodes.t, at).unwrap(), nodes.interpolant.as_ref().unwrap());
            assert!((interpolant.derivative(place)[0] - slope(at)[0]).abs() < 1e-12, "{at}");
            let ends = [&nodes.u[place.left][..], &nodes.u[place.left + 1]];
            assert!((interpolant.controls_at(ends, place)[0] - cube(at)[0]).abs() < 1e-12, "{at}");
        }
        assert_eq!([nodes.at(-1e-9), nodes.at(3.1), nodes.at(f64::NAN)], [None, None, None]);
    }
}
