//! Bounded controls and relaxations of any model.

use crate::extremal::actuation::Switching;
use crate::extremal::dynamics::DynamicsExtremal;
use crate::extremal::dynamics::response::eval_error;
use crate::extremal::{BoundedControls, ControlLaw, ControlRange, Homotopy, Relaxation, SideChange};
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};
use costate::matrix::add_scaled;

impl<D: Dynamics<f64>, C: Cost<f64>> BoundedControls for DynamicsExtremal<D, C> {
    fn controls(&self) -> usize {
        self.u.len()
    }

    fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) {
        if self.set_pull(z).is_err() {
            self.pull.fill(f64::NAN);
        }
        u.iter_mut().enumerate().for_each(|(i, u)| *u = self.actuation.unbounded(i, self.pull[i]));
    }

    fn controls_at(&mut self, z: &[f64], law: ControlLaw<'_>, u: &mut [f64]) {
        match self.set_controls(z, law) {
            Ok(_) => u.copy_from_slice(&self.u),
            Err(_) => u.fill(f64::NAN),
        }
    }

    fn bounds(&self, control: usize) -> ControlRange {
        self.actuation.reached_bounds(self.relaxable.original(), control)
    }

    /// $w_i - r_i u_i$ at the bound.
    fn switching(&mut self, control: usize, change: SideChange, z: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        if self.set_pull(z).is_err() {
            return f64::NAN;
        }
        let Switching { value, slope } = self.actuation.switching(control, change, self.pull[control]);
        let (x, y) = z.split_at(self.l_x.len());
        let Ok(all) = self.model.contract(x, &self.u, y) else { return f64::NAN };
        self.response.set(&all, control);
        let (in_x, in_y) = gradient.split_at_mut(x.len());
        add_scaled(in_x, slope, &self.response.in_x);
        add_scaled(in_y, slope, &self.response.in_y);
        value
    }

    fn state_rate(&mut self, x: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
        f.copy_from_slice(self.model.linearise(x, u).map_err(eval_error)?.f);
        Ok(())
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> Homotopy for DynamicsExtremal<D, C> {
    fn relaxation(&self) -> Relaxation {
        self.relaxable.current()
    }

    fn set_relaxation(&mut self, relaxation: Relaxation) {
        self.ends.set_goal(relaxation.goal);
        self.relaxable.relax_actuation(relaxation, &mut self.actuation);
    }

    fn easiest(&self) -> Relaxation {
        self.relaxable.easiest()
    }
}
