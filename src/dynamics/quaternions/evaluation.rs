//! f, f_x and y'f_xx of a robot with quaternions as plain states.

use super::bend::Bend;
use super::{Places, QuaternionDynamics, TangentModel};
use crate::dynamics::{Contraction, Dynamics, Linearisation, Structure};
use crate::error::{EvalError, check_length};
use crate::matrix::{Block, Matrix, add_scaled};
use crate::scalar::Scalar;

/// What the columns of B do on momenta or rates, by the last n rows of F_tau.
fn drive<S: Scalar>(f_tau: Block<'_, S>, actuation: &Matrix<S>, driven: &mut Matrix<S>) {
    let n = f_tau.columns();
    for i in 0..n {
        let row = driven.row_mut(i);
        row.fill(S::zero());
        for (k, &by_tau) in f_tau.row(n + i).iter().enumerate() {
            add_scaled(row, by_tau, actuation.row(k));
        }
    }
}

impl<S: Scalar, M: TangentModel<S>> Dynamics<S> for QuaternionDynamics<S, M> {
    type Error = EvalError;

    fn states(&self) -> usize {
        self.f.len()
    }

    fn controls(&self) -> usize {
        self.actuation.columns()
    }

    fn structure(&self) -> Structure {
        self.structure
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.set(x, u)?;
        let Self { model, plain, turns, q, w, tau, f, .. } = self;
        Places { plain, turns }.rate(model.rate(q, w, tau)?, f);
        Ok(&self.f)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.set(x, u)?;
        let Self { model, plain, turns, q, w, tau, f, f_x, f_u, slopes, actuation, driven, .. } = self;
        let of_tangent = model.linear(q, w, tau)?;
        let places = Places { plain, turns };
        places.rate(of_tangent.f, f);
        for (i, row) in of_tangent.f_x.iter_rows().enumerate() {
            places.spread(row, slopes.row_mut(i));
        }
        places.jacobian(of_tangent.f, slopes, f_x);
        if !M::structure(self.nq).constant_f_u {
            drive(of_tangent.f_u, actuation, driven);
        }
        if !self.structure.constant_f_u {
            places.drive(driven, f_u);
        }
        Ok(Linearisation { f, f_x: f_x.view(), f_u: f_u.view() })
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        self.set(x, u)?;
        check_length("y", y, x.len())?;
        let Self {
            model, nq, structure, plain, turns, q, w, tau, f, f_x, y_f_xx, l, pull, slopes, half, ..
        } = self;
        let (actuation, driven) = (&self.actuation, &mut self.driven);
        let (f_u, y_f_uq) = (&mut self.f_u, &mut self.y_f_uq);
        let places = Places { plain, turns };
        places.costate(y, l);
        let all = model.second(q, w, tau, l)?;
        let of_tangent = all.first;
        let rate = of_tangent.f;
        places.rate(rate, f);
        // Rows of y_f_xx are space for one of the tangent space here.
        if let Some(by_tau) = all.ux {
            drive(of_tangent.f_u, actuation, driven);
            let n = by_tau.rows();
            for j in 0..y_f_uq.rows() {
                pull.fill(S::zero());
                for (k, row) in by_tau.iter_rows().enumerate() {
                    add_scaled(&mut pull[..n], actuation[(k, j)], row);
                }
                places.spread(pull, y_f_xx.row_mut(0));
                y_f_uq.row_mut(j).copy_from_slice(&y_f_xx.row(0)[..*nq]);
            }
        }
        if !structure.constant_f_u {
            places.drive(driven, f_u);
        }
        pull.fill(S::zero());
        for (i, row) in of_tangent.f_x.iter_rows().enumerate() {
            places.spread(row, slopes.row_mut(i));
            add_scaled(pull, l[i], row);
        }
        places.jacobian(rate, slopes, f_x);
        // The Hessian of the tangent space from both sides.
        for (i, row) in all.xx.iter_rows().enumerate() {
            places.spread(row, y_f_xx.row_mut(0));
            for c in 0..half.rows() {
                half[(c, i)] = y_f_xx[(0, c)];
            }
        }
        for c in 0..half.rows() {
            places.spread(half.row(c), y_f_xx.row_mut(c));
        }
        let bend = Bend { y, pull, rate, slopes };
        for turn in &*turns {
            bend.add(turn, y_f_xx);
            bend.drive(turn, actuation, y_f_uq);
        }
        let first = Linearisation { f, f_x: f_x.view(), f_u: f_u.view() };
        let ux = (y_f_uq.columns() > 0).then(|| y_f_uq.view());
        Ok(Contraction { first, xx: y_f_xx.view(), ux, uu: None })
    }
}
