//! Methods of automatic differentiation that `costate bench` leaves out: F from H, other chunks, vectors of
//! second derivatives.

use crate::cases::Case;
use crate::names::{FIRST, FUNCTION, SECOND};
use crate::routes::{Candidate, Failure};
use costate::derivative::{Function, Jacobian, PhaseVelocity};
use costate::hamiltonian::Hamiltonian;
use costate::num_dual::{Dual2SVec64, Dual64};
use std::hint::black_box;

/// `F = (H_p, u - H_q)`, one dual number at a time: the robots here have no friction.
pub const GRADIENT: &str = "gradient of H by dual numbers";

/// F by the gradient of H; F_x by dual numbers with 1, 2, 4, 8 derivatives; y'F_xx by `Dual2SVec` where its
/// size is compiled in: n = 2, 6, 7.
pub fn candidates<'a>(case: &'a Case, list: &mut Vec<Candidate<'a>>) {
    gradient(case, list);
    chunk::<1>("dual numbers, 1 at once", case, list);
    chunk::<2>("dual numbers, 2 at once", case, list);
    chunk::<4>("dual numbers, 4 at once", case, list);
    chunk::<8>("dual numbers, 8 at once", case, list);
    match case.robot.dof() {
        2 => whole::<4>(case, list),
        6 => whole::<12>(case, list),
        7 => whole::<14>(case, list),
        _ => (),
    }
}

fn gradient<'a>(case: &'a Case, list: &mut Vec<Candidate<'a>>) {
    let n = case.robot.dof();
    let mut hamiltonian = Hamiltonian::<Dual64>::new(&case.robot);
    let mut x: Vec<Dual64> = case.state.x.iter().map(|&x| x.into()).collect();
    let mut f = vec![0.0; 2 * n];
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        for k in 0..2 * n {
            x[k].eps = 1.0;
            let (q, p) = black_box(&x).split_at(n);
            let energy = hamiltonian.energy(q, p)?;
            let slope = (energy.kinetic + energy.potential).eps;
            x[k].eps = 0.0;
            if k < n {
                f[n + k] = case.state.u[k] - slope;
            } else {
                f[k - n] = slope;
            }
        }
        black_box(&f);
        if let Some(to) = to {
            to.extend(&f);
        }
        Ok(())
    };
    list.push(Candidate { quantity: FUNCTION, route: GRADIENT, work: Box::new(work) });
}

fn chunk<'a, const C: usize>(route: &'static str, case: &'a Case, list: &mut Vec<Candidate<'a>>) {
    let mut jacobian = Jacobian::<_, C>::chunked(PhaseVelocity::new(&case.robot).under(&case.state.u));
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        let jacobian = jacobian.linearise(black_box(&case.state.x))?.jacobian.view();
        black_box(jacobian[(0, 0)]);
        if let Some(to) = to {
            jacobian.iter_rows().for_each(|row| to.extend(row));
        }
        Ok(())
    };
    list.push(Candidate { quantity: FIRST, route, work: Box::new(work) });
}

/// One pass through F, each number with its gradient and Hessian, N = 2n; contracted with y after it.
fn whole<'a, const N: usize>(case: &'a Case, list: &mut Vec<Candidate<'a>>) {
    let function = PhaseVelocity::new(&case.robot).under(&case.state.u);
    let mut workspace = function.workspace::<Dual2SVec64<N>>();
    let zero = Dual2SVec64::<N>::from_re(0.0);
    let (mut x, mut f) = ([zero; N], [zero; N]);
    let work = move |to: Option<&mut Vec<f64>>| -> Result<(), Failure> {
        for (i, (lifted, &x)) in x.iter_mut().zip(black_box(&case.state.x)).enumerate() {
            *lifted = Dual2SVec64::from_re(x).derivative(i);
        }
        function.evaluate(&mut workspace, &x, &mut f)?;
        let mut hessian = [[0.0; N]; N];
        for (f, y) in f.iter().zip(&case.state.y) {
            let Some(second) = &f.v2.0 else { continue };
            for (i, row) in hessian.iter_mut().enumerate() {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry += y * second[(i, j)]);
            }
        }
        black_box(&hessian);
        if let Some(to) = to {
            to.extend(hessian.as_flattened());
        }
        Ok(())
    };
    list.push(Candidate {
        quantity: SECOND,
        route: "Dual2SVec, all at once, through F",
        work: Box::new(work),
    });
}
