//! A motion to begin with.

/// Values over time, straight lines between them.
#[derive(Clone, Debug)]
pub(super) struct Guess {
    pub t: Vec<f64>,
    pub x: Vec<Vec<f64>>,
    pub u: Vec<Vec<f64>>,
}

impl Guess {
    /// (x, u) at `s` in [0, 1] of its time.
    pub fn at(&self, s: f64, out: &mut [f64]) {
        let last = self.t.len() - 1;
        let t = self.t[0] + s * (self.t[last] - self.t[0]);
        let after = self.t.partition_point(|&time| time < t).clamp(1, last);
        let part = ((t - self.t[after - 1]) / (self.t[after] - self.t[after - 1])).clamp(0.0, 1.0);
        let (x, u) = out.split_at_mut(self.x[0].len());
        for (out, values) in [(x, &self.x), (u, &self.u)] {
            for (out, (a, b)) in out.iter_mut().zip(values[after - 1].iter().zip(&values[after])) {
                *out = a + part * (b - a);
            }
        }
    }
}
