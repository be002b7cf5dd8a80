//! The Jacobian of the extremals of a robot in Lagrangian coordinates.

use crate::extremal::differences::{Differenced, Differences};
use crate::extremal::hamiltonian::equations::Outputs;
use crate::extremal::hamiltonian::with_hamiltonian;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::{ControlLaw, HamiltonianTerms};
use costate::EvalError;
use costate::matrix::Block;

impl Differenced for LagrangianExtremal {
    fn differences(&mut self) -> &mut Differences {
        &mut self.differences
    }

    /// From f_x, and from the second derivatives if `hessian` is true.
    fn linearise_with(
        &mut self,
        hessian: bool,
        z: &[f64],
        law: ControlLaw<'_>,
        Outputs { g, jacobian }: Outputs<'_, f64>,
    ) -> Result<HamiltonianTerms, EvalError> {
        let l = self.prepare(z, law, true)?;
        let n = self.force.len();
        let m = 4 * n;
        let (q, v, y_q, y_v) = (&z[..n], &z[n..2 * n], &z[2 * n..3 * n], &z[3 * n..]);
        let (linear, hessian) = if hessian {
            let all = self.second.contract_forward_dynamics(q, v, &self.force, y_v)?;
            (all.forward_dynamics(), Some((all.xx(), all.uq())))
        } else {
            (self.second.first().linearise_forward_dynamics(q, v, &self.force)?, None)
        };
        g[..n].copy_from_slice(v);
        g[n..2 * n].copy_from_slice(linear.acceleration());
        g[2 * n..3 * n].fill(0.0);
        g[3 * n..].iter_mut().zip(y_q).for_each(|(g, y_q)| *g = -y_q);
        jacobian.fill(0.0);
        for i in 0..n {
            jacobian[i * m + n + i] = 1.0;
            jacobian[(3 * n + i) * m + 2 * n + i] = -1.0;
            let row = &linear.matrix().row(i)[..2 * n];
            jacobian[(n + i) * m..(n + i) * m + 2 * n].copy_from_slice(row);
            for (j, &entry) in row.iter().enumerate() {
                jacobian[(2 * n + j) * m + 3 * n + i] = -entry;
                g[2 * n + j] -= y_v[i] * entry;
            }
        }
        for i in 0..2 * n {
            let target = &mut jacobian[(2 * n + i) * m..(2 * n + i) * m + 2 * n];
            if let Some((xx, _)) = hessian {
                target.iter_mut().zip(xx.row(i)).for_each(|(target, &entry)| *target = -entry);
            }
            g[2 * n + i] += self.l_x[i];
            if self.penalties.any() {
                target[i] += self.l_xx[i];
            }
            if self.terms.any() {
                target
                    .iter_mut()
                    .zip(self.terms.hessian.row(i))
                    .for_each(|(target, &entry)| *target += entry);
            }
        }
        for k in 0..n {
            let weight = self.actuation.gain[k] * self.actuation.gain[k] * self.slopes[k];
            if weight != 0.0 {
                add_response(
                    jacobian,
                    weight,
                    linear.a_u().row(k),
                    hessian.map(|(_, uq): (_, Block<'_, _>)| uq.row(k)),
                );
            }
        }
        Ok(with_hamiltonian(z, g, l))
    }
}

/// Adds the response of one control, `weight (W_y, -W_x)' (W_x, W_y)` with W_x = (in_q, 0) and W_y = (0,
/// in_y).
fn add_response(jacobian: &mut [f64], weight: f64, in_y: &[f64], in_q: Option<&[f64]>) {
    let n = in_y.len();
    let m = 4 * n;
    for i in 0..n {
        let (to_v, to_y) = (&mut jacobian[(n + i) * m..(n + i + 1) * m], weight * in_y[i]);
        costate::matrix::add_scaled(&mut to_v[3 * n..], to_y, in_y);
        let Some(in_q) = in_q else { continue };
        costate::matrix::add_scaled(&mut to_v[..n], to_y, in_q);
        let (of_y, to_q) = (&mut jacobian[(2 * n + i) * m..(2 * n + i + 1) * m], -weight * in_q[i]);
        costate::matrix::add_scaled(&mut of_y[..n], to_q, in_q);
        costate::matrix::add_scaled(&mut of_y[3 * n..], to_q, in_y);
    }
}
