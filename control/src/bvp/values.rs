//! Values at the points of a mesh.

/// Values at all nodes and inner points of a mesh.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    /// m for each node.
    pub nodes: Vec<f64>,
    /// (s - 2) m for each span; those of a switch are not used.
    pub inner: Vec<f64>,
    /// Position on the way of a continuation, from 0 to 1; 0 where there is none.
    pub position: f64,
}

impl Values {
    pub fn zeros(nodes: usize, m: usize, points: usize) -> Self {
        Self { nodes: vec![0.0; nodes * m], inner: vec![0.0; (nodes - 1) * (points - 2) * m], position: 0.0 }
    }

    /// `self = a + factor scale b`, componentwise with the scales of the m components.
    pub fn set_sum(&mut self, a: &Self, factor: f64, scale: &[f64], b: &Self) {
        let pairs = [(&mut self.nodes, &a.nodes, &b.nodes), (&mut self.inner, &a.inner, &b.inner)];
        for (target, a, b) in pairs {
            for (i, target) in target.iter_mut().enumerate() {
                *target = a[i] + factor * scale[i % scale.len()] * b[i];
            }
        }
        self.position = a.position + factor * b.position;
    }

    /// Root mean square of `self + factor other`, and the position as much as all others together.
    pub fn norm_of_sum(&self, factor: f64, other: &Self) -> f64 {
        let pairs = self.nodes.iter().zip(&other.nodes).chain(self.inner.iter().zip(&other.inner));
        let sum: f64 = pairs.map(|(a, b)| (a + factor * b).powi(2)).sum();
        let mean = sum / (self.nodes.len() + self.inner.len()) as f64;
        (mean + (self.position + factor * other.position).powi(2)).sqrt()
    }

    /// Root mean square.
    pub fn norm(&self) -> f64 {
        self.norm_of_sum(0.0, self)
    }
}
