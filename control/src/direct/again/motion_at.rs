//! The motion that was solved, at any time.

use super::resolve::Resolve;
use super::resolve_error::ResolveError;

impl Resolve {
    /// Duration of the motion (s); `None` before the first solve.
    pub fn final_time(&self) -> Option<f64> {
        let spline = &self.shown.spline;
        (spline.dof > 0).then(|| spline.duration())
    }

    /// Writes q, v, a at time t (s), 3n entries; those of the ends beyond them.
    ///
    /// # Errors
    /// [`ResolveError::NotSolved`] before the first solve, [`ResolveError::WrongLength`],
    /// [`ResolveError::NotATime`] for NaN.
    pub fn state_at(&self, t: f64, z: &mut [f64]) -> Result<(), ResolveError> {
        let (spline, expected) = (&self.shown.spline, 3 * self.dof());
        if spline.dof == 0 {
            return Err(ResolveError::NotSolved);
        }
        if z.len() != expected {
            return Err(ResolveError::WrongLength { what: "the state", expected, found: z.len() });
        }
        if t.is_nan() {
            return Err(ResolveError::NotATime);
        }
        let (k, x) = spline.mesh.place(spline.place_of(t));
        spline.in_interval(k, x, z);
        Ok(())
    }

    /// Writes the torques and forces at time t (s), n entries, cut to their limits.
    ///
    /// # Errors
    /// As [`state_at`](Self::state_at); [`ResolveError::Evaluation`] where the dynamics cannot be evaluated.
    pub fn torques_at(&mut self, t: f64, torques: &mut [f64]) -> Result<(), ResolveError> {
        let n = self.dof();
        if torques.len() != n {
            let found = torques.len();
            return Err(ResolveError::WrongLength { what: "the torques", expected: n, found });
        }
        let mut z = std::mem::take(&mut self.z);
        let state = self.state_at(t, &mut z);
        let found = state.and_then(|()| {
            let spline = &self.shown.spline;
            let phase = spline.mesh.phase(spline.mesh.place(spline.place_of(t)).0);
            let tau = self.models[phase].inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?;
            for ((to, tau), limits) in torques.iter_mut().zip(tau).zip(&self.limits) {
                *to = tau.clamp(limits.torque[0], limits.torque[1]);
            }
            Ok(())
        });
        self.z = z;
        found
    }
}
