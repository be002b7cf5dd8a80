//! The canonical equations of the maximised Hamiltonian of a robot, for any scalar.

use crate::extremal::actuation::Control;
use crate::extremal::penalty::Penalties;
use crate::extremal::user_terms::UserTerms;
use crate::problem::Problem;
use crate::problem::running_cost::ExtremalScalar;
use costate::EvalError;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::scalar::Scalar;

/// $z' = (F + (0, B u), -F_x^\top y + l_x)$ and its Jacobian for given controls and slopes.
/// [`RobotExtremal`](crate::RobotExtremal) evaluates them; generated code is recorded from them.
#[derive(Clone, Debug)]
pub(crate) struct Equations<S: Scalar> {
    pub second: HamiltonianSecondOrder<S>,
    pub penalties: Penalties,
    pub terms: UserTerms<S>,
    /// b_i.
    pub gain: Vec<f64>,
    /// c_t.
    pub time_cost: f64,
    /// B u.
    pub force: Vec<S>,
    /// d(B u) / d y_p.
    pub slopes: Vec<S>,
    /// `(y_q - l_v, y_p)`.
    pub shifted: Vec<S>,
    pub l_q: Vec<S>,
    /// Second derivatives of the penalties on positions and rates.
    pub curvatures: [Vec<S>; 2],
    /// One row of `l_vz E`.
    pub pull: Vec<S>,
}

/// What a linearisation writes: z' (4n) and its Jacobian (4n x 4n).
pub(crate) struct Outputs<'a, S> {
    pub g: &'a mut [S],
    pub jacobian: &'a mut [S],
}

/// The running cost l.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Running<S> {
    /// Without penalties.
    pub cost: S,
    /// Penalties.
    pub penalty: S,
    /// Cost that only a relaxed problem has.
    pub smoothing: S,
}

impl<S: ExtremalScalar> Equations<S> {
    /// The equations of a problem, with derivatives from an existing workspace.
    pub fn new(problem: &Problem, second: HamiltonianSecondOrder<S>) -> Self {
        let n = problem.robot.dof();
        let zeros = vec![S::zero(); n];
        Self {
            second,
            penalties: Penalties::new(n, problem.penalty.as_ref()),
            terms: UserTerms::new(n, &problem.terms),
            gain: problem.gain.clone(),
            time_cost: problem.cost.time,
            force: zeros.clone(),
            slopes: zeros.clone(),
            shifted: vec![S::zero(); 2 * n],
            l_q: zeros.clone(),
            curvatures: [zeros.clone(), zeros],
            pull: vec![S::zero(); 2 * n],
        }
    }

    /// Forces, l and its derivatives in (q, v), and the shifted costate at z.
    fn prepare(
        &mut self,
        z: &[S],
        control: impl Fn(usize, S) -> Control<S>,
        curvature: bool,
    ) -> Result<Running<S>, EvalError> {
        let n = self.force.len();
        let (x, y) = z.split_at(2 * n);
        let mut l = Running { cost: S::from_f64(self.time_cost), penalty: S::zero(), smoothing: S::zero() };
        self.shifted.copy_from_slice(y);
        self.l_q.fill(S::zero());
        for i in 0..n {
            let (gain, control) = (self.gain[i], control(i, y[n + i]));
            self.force[i] = control.u.times(gain);
            self.slopes[i] = control.slope.times(gain * gain);
            l.cost += control.cost;
            l.smoothing += control.smoothing;
        }
        if self.penalties.any() {
            for (i, &q) in x[..n].iter().enumerate() {
                let term = self.penalties.position(i, q);
                l.penalty += term.value;
                (self.l_q[i], self.curvatures[0][i]) = (term.first, term.second);
            }
        }
        if self.terms.any() || self.penalties.limit_rates() {
            let (q, p) = x.split_at(n);
            let v = self.second.first().velocity(q, p)?;
            if self.penalties.limit_rates() {
                for (i, &v) in v.iter().enumerate() {
                    let term = self.penalties.rate(i, v);
                    l.penalty += term.value;
                    self.shifted[i] -= term.first;
                    self.curvatures[1][i] = term.second;
                }
            }
            if self.terms.any() {
                if curvature {
                    self.terms.second(q, v)
                } else {
                    self.terms.first(q, v)
                }
                l.cost += self.terms.value;
                for (i, (&l_q, &l_v)) in self.terms.gradient.iter().zip(&self.terms.gradient[n..]).enumerate()
                {
                    self.l_q[i] += l_q;
                    self.shifted[i] -= l_v;
                }
            }
        }
        Ok(l)
    }

    /// z', 4n.
    pub fn evaluate(
        &mut self,
        z: &[S],
        control: impl Fn(usize, S) -> Control<S>,
        g: &mut [S],
    ) -> Result<Running<S>, EvalError> {
        let n = self.force.len();
        let l = self.prepare(z, control, false)?;
        let adjoint = self.second.first().adjoint(&z[..n], &z[n..2 * n], &self.force, &self.shifted)?;
        g[..2 * n].copy_from_slice(adjoint.f);
        g[2 * n..].iter_mut().zip(adjoint.y_f_x).for_each(|(g, &product)| *g = -product);
        g[2 * n..3 * n].iter_mut().zip(&self.l_q).for_each(|(g, &l_q)| *g += l_q);
        Ok(l)
    }

    /// z' and its Jacobian, 4n x 4n, with the blocks y'F_xx if `hessian` is true.
    pub fn linearise(
        &mut self,
        z: &[S],
        control: impl Fn(usize, S) -> Control<S>,
        hessian: bool,
        Outputs { g, jacobian }: Outputs<'_, S>,
    ) -> Result<Running<S>, EvalError> {
        let l = self.prepare(z, control, true)?;
        let n = self.force.len();
        let m = 4 * n;
        let (q, p) = z[..2 * n].split_at(n);
        let (linear, hessian) = if hessian {
            let all = self.second.contract(q, p, &self.force, &self.shifted)?;
            (all.linearisation(), Some(all.matrix()))
        } else {
            (self.second.first().linearise(q, p, &self.force)?, None)
        };
        let f_x = linear.matrix();
        g[..2 * n].copy_from_slice(linear.f());
        g[2 * n..].fill(S::zero());
        jacobian.fill(S::zero());
        for i in 0..2 * n {
            let row = f_x.row(i);
            jacobian[i * m..i * m + 2 * n].copy_from_slice(row);
            for (j, &entry) in row.iter().enumerate() {
                jacobian[(2 * n + j) * m + 2 * n + i] = -entry;
                g[2 * n + j] -= self.shifted[i] * entry;
            }
            if let Some(hessian) = hessian {
                let target = &mut jacobian[(2 * n + i) * m..(2 * n + i) * m + 2 * n];
                target.iter_mut().zip(hessian.row(i)).for_each(|(target, &entry)| *target = -entry);
            }
        }
        for i in 0..n {
            jacobian[(n + i) * m + 3 * n + i] = self.slopes[i];
            g[2 * n + i] += self.l_q[i];
        }
        let velocities = (0..n).map(|k| f_x.row(k));
        let curvature =
            Curvature { penalties: &self.penalties, of_penalties: &self.curvatures, terms: &self.terms };
        curvature.add(velocities, &mut self.pull, jacobian);
        Ok(l)
    }
}

/// `l_zz`, z = (q, v).
struct Curvature<'a, S: Scalar> {
    penalties: &'a Penalties,
    of_penalties: &'a [Vec<S>; 2],
    terms: &'a UserTerms<S>,
}

impl<S: ExtremalScalar> Curvature<'_, S> {
    /// Adds `E' l_zz E`, `E = [ 1 0 ; V ]`, to the rows of y_q and y_p and the columns of q and p; V row by
    /// row.
    fn add<'v>(&self, velocities: impl Iterator<Item = &'v [S]> + Clone, pull: &mut [S], jacobian: &mut [S]) {
        let n = pull.len() / 2;
        let row = |i: usize| (2 * n + i) * 4 * n..(2 * n + i) * 4 * n + 2 * n;
        if self.penalties.any() {
            for i in 0..n {
                jacobian[row(i).start + i] += self.of_penalties[0][i];
            }
        }
        for (k, v_x) in velocities.clone().enumerate() {
            // Row k of l_vq + l_vv V.
            pull.fill(S::zero());
            if self.penalties.limit_rate(k) {
                costate::matrix::add_scaled(pull, self.of_penalties[1][k], v_x);
            }
            if self.terms.any() {
                let of_v = self.terms.hessian.row(n + k);
                pull.iter_mut().zip(&of_v[..n]).for_each(|(pull, &entry)| *pull += entry);
                for (&entry, v_x) in of_v[n..].iter().zip(velocities.clone()) {
                    costate::matrix::add_scaled(pull, entry, v_x);
                }
                for i in 0..n {
                    let entry = self.terms.hessian[(i, n + k)];
                    costate::matrix::add_scaled(&mut jacobian[row(i)], entry, v_x);
                }
            } else if !self.penalties.limit_rate(k) {
                continue;
            }
            for (i, &entry) in v_x.iter().enumerate() {
                costate::matrix::add_scaled(&mut jacobian[row(i)], entry, pull);
            }
        }
        if self.terms.any() {
            for i in 0..n {
                let target = &mut jacobian[row(i)];
                target
                    .iter_mut()
                    .zip(&self.terms.hessian.row(i)[..n])
                    .for_each(|(target, &entry)| *target += entry);
            }
        }
    }
}
