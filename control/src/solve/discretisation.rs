//! Equations on a mesh with values to begin from.

use crate::bvp::collocation::Collocation;
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::{Arcs, Clock, Timed};
use crate::bvp::{Failure, Solvable};
use crate::extremal::Extremal;

/// A boundary-value problem on a mesh, with values at its points; whether they solve it is not said.
pub(crate) struct Discretisation {
    pub equations: Collocation,
    pub clock: Clock,
    pub arcs: Arcs,
}

/// Everything of a [`Discretisation`] but the values.
pub(crate) struct Layout {
    pub clock: Clock,
    pub arcs: Arcs,
    pub mesh: Mesh,
    /// Lobatto points of an interval.
    pub points: usize,
}

impl Discretisation {
    /// With a guess of w at each (arc, scaled time on it).
    pub fn new(
        extremal: &mut dyn Extremal,
        layout: Layout,
        guess: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let Layout { clock, arcs, mesh, points } = layout;
        let timed = Timed::new(extremal, clock, arcs);
        let equations = Collocation::new(&timed, mesh, points, guess);
        let Timed { arcs, .. } = timed;
        Self { equations, clock, arcs }
    }

    /// The differential equation that it discretises.
    pub fn timed<'e>(&self, extremal: &'e mut (dyn Extremal + 'e)) -> Timed<'e> {
        Timed::new(extremal, self.clock, self.arcs.clone())
    }

    /// Evaluates the equations at the values; costs and polynomials need that.
    pub fn evaluated(mut self, extremal: &mut dyn Extremal) -> Result<Self, Failure> {
        let values = self.equations.current.clone();
        let mut timed = self.timed(extremal);
        self.equations.evaluate(&mut timed, &values)?;
        Ok(self)
    }

    /// Replaces the values between the nodes by the cubics that have the slopes of the equations at the
    /// nodes; leaves them where the equations cannot be evaluated.
    pub fn smooth_between_nodes(&mut self, extremal: &mut dyn Extremal) {
        let mut timed = self.timed(extremal);
        let (m, equations) = (self.equations.m, &mut self.equations);
        let mut slopes = [vec![0.0; m], vec![0.0; m]];
        let inner = equations.method.len() - 2;
        for (k, span) in equations.mesh.spans.iter().enumerate() {
            let Span::Interval { arc, length } = *span else { continue };
            let ends = equations.current.nodes[k * m..(k + 2) * m].split_at(m);
            let evaluated = [(ends.0, 0), (ends.1, 1)]
                .into_iter()
                .all(|(w, side)| timed.evaluate(w, arc, &mut slopes[side]).is_ok());
            if !evaluated {
                continue;
            }
            for j in 0..inner {
                let c = equations.method.points[j + 1];
                let at = (k * inner + j) * m;
                for (i, target) in equations.current.inner[at..at + m].iter_mut().enumerate() {
                    let chord = ends.1[i] - ends.0[i];
                    let (left, right) = (length * slopes[0][i] - chord, length * slopes[1][i] - chord);
                    *target = ends.0[i] + c * chord + c * (1.0 - c) * ((1.0 - c) * left - c * right);
                }
            }
        }
    }

    /// The same polynomials on another mesh.
    pub fn refine<E: Extremal + ?Sized>(&mut self, timed: &Timed<'_, E>, mesh: Mesh) {
        let equations = &self.equations;
        let points = equations.method.len();
        self.equations = Collocation::new(timed, mesh, points, |arc, s, w| equations.sample(arc, s, w));
    }

    /// Clock, arcs, mesh and points.
    pub fn layout(&self) -> Layout {
        Layout {
            clock: self.clock,
            arcs: self.arcs.clone(),
            mesh: self.equations.mesh.clone(),
            points: self.equations.method.len(),
        }
    }

    /// The same mesh and unknowns, extrapolated by `factor` times the change since `before`.
    pub fn predicted(&self, extremal: &mut dyn Extremal, change: Option<Change<'_>>) -> Self {
        let mut old = vec![0.0; self.equations.m];
        Self::new(extremal, self.layout(), |arc, s, w| {
            self.equations.sample(arc, s, w);
            if let Some(Change { since, factor }) = change {
                since.equations.sample(arc, s, &mut old);
                w.iter_mut().zip(&old).for_each(|(w, old)| *w += factor * (*w - old));
            }
        })
    }

    /// T (s).
    pub fn final_time(&self, extremal: &mut dyn Extremal) -> f64 {
        self.equations.final_time(&self.timed(extremal))
    }

    /// Cost and penalties.
    pub fn costs(&self, extremal: &mut dyn Extremal) -> (f64, f64) {
        self.equations.costs(&self.timed(extremal))
    }

    /// Cost and penalties together.
    pub fn total(&self, extremal: &mut dyn Extremal) -> f64 {
        let (cost, penalty) = self.costs(extremal);
        cost + penalty
    }

    /// Mean of H* over the nodes.
    pub fn mean_hamiltonian(&self) -> f64 {
        let rates = &self.equations.rates.nodes;
        rates.iter().map(|rate| rate.hamiltonian).sum::<f64>() / rates.len() as f64
    }

    /// Duration of each arc (s).
    pub fn durations(&self, z_len: usize) -> Vec<f64> {
        let (m, mesh) = (self.equations.m, &self.equations.mesh);
        let mut durations = vec![0.0; mesh.arcs()];
        for (k, span) in mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, .. } = *span {
                durations[arc] = match self.clock {
                    Clock::Fixed(time) => time,
                    _ => self.equations.current.nodes[k * m + z_len],
                };
            }
        }
        durations
    }

    /// w at a time (s), given the durations of the arcs.
    pub fn sample_time(&self, durations: &[f64], t: f64, w: &mut [f64]) {
        let mut start = 0.0;
        for (arc, &duration) in durations.iter().enumerate() {
            if t <= start + duration || arc + 1 == durations.len() {
                let s = if duration > 0.0 { ((t - start) / duration).clamp(0.0, 1.0) } else { 0.0 };
                self.equations.sample(arc, s, w);
                return;
            }
            start += duration;
        }
    }
}

/// What changed since an earlier solution, and how much of it is added once more.
#[derive(Clone, Copy)]
pub(crate) struct Change<'a> {
    pub since: &'a Discretisation,
    pub factor: f64,
}
