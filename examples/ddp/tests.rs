//! Against dense algebra, an adjoint sweep of its own, and finite differences.

mod linear;

use costate::dynamics::Cost;
use costate::step::Step;
use linear::{STAGES, START, dense, linear};
use nalgebra::{DVector, dmatrix, dvector};

use super::problem::{Curvature, Failure, Options, Problem, Solution, Status};
use super::{box_qp, compare, problems};

const BOTH: [Curvature; 2] = [Curvature::Exact, Curvature::GaussNewton];

fn options(curvature: Curvature) -> Options {
    Options { curvature, iterations: 300, tolerance: 1e-12 }
}

#[test]
fn one_iteration_solves_a_linear_quadratic_problem() {
    let expected = dense();
    for curvature in BOTH {
        let (mut problem, u) = linear(0..0);
        let solution = problem.solve(&START, &u, &options(curvature)).unwrap();
        assert_eq!((solution.status, solution.log.len(), solution.log[0].alpha), (Status::Converged, 2, 1.0));
        for (k, u) in solution.trajectory.u.iter().enumerate() {
            assert!(
                (u - expected.rows(2 * k, 2)).amax() < 1e-12 * expected.amax(),
                "{curvature:?}, stage {k}"
            );
        }
        let derivatives = match curvature {
            Curvature::Exact => [0, 2 * STAGES],
            Curvature::GaussNewton => [2 * STAGES, 0],
        };
        assert_eq!([solution.count.linearisations, solution.count.contractions], derivatives);
        assert_eq!(solution.count.advances, 2 * STAGES);
    }
}

#[test]
fn a_step_that_fails_in_the_line_search_is_shortened() {
    for curvature in BOTH {
        let expected = dense();
        // The first roll-out takes the first calls; the whole step fails in its third stage.
        let (mut problem, u) = linear(STAGES + 2..STAGES + 3);
        let solution = problem.solve(&START, &u, &options(curvature)).unwrap();
        assert_eq!((solution.log[0].alpha, solution.log[0].roll_outs), (0.5, 2));
        assert_eq!((solution.status, solution.log.len()), (Status::Converged, 3));
        assert!((&solution.trajectory.u[0] - expected.rows(0, 2)).amax() < 1e-12 * expected.amax());
    }
}

#[test]
fn searches_end_with_a_status_and_failures_with_a_reason() {
    let (mut problem, u) = linear(STAGES..usize::MAX);
    let stuck = problem.solve(&START, &u, &options(Curvature::Exact)).unwrap();
    assert_eq!((stuck.status, &stuck.trajectory.u), (Status::Stuck, &u));

    let mut arm = problems::large_motion().unwrap();
    let few = Options { iterations: 3, ..options(Curvature::Exact) };
    let few = arm.problem.solve(&arm.x, &arm.u, &few).unwrap();
    assert_eq!((few.status, few.log.len()), (Status::Iterations, 4));

    let (mut problem, mut u) = linear(2..3);
    let failure = problem.solve(&START, &u, &options(Curvature::Exact)).unwrap_err();
    assert!(matches!(failure, Failure::Evaluation { stage: 2, .. }), "{failure}");
    assert_eq!(failure.to_string(), "stage 2: refused");
    u[1][0] = f64::NAN;
    let (mut problem, _) = linear(0..0);
    let failure = problem.solve(&START, &u, &options(Curvature::Exact)).unwrap_err();
    assert!(matches!(failure, Failure::NotFinite { stage: 1 }), "{failure}");
    let failure = problem.solve(&START[..2], &u, &options(Curvature::Exact)).unwrap_err();
    assert!(matches!(failure, Failure::WrongLength { what: "x", expected: 3, found: 2 }), "{failure}");
    problem.lower[1] = f64::NAN;
    let failure = problem.solve(&START, &u, &options(Curvature::Exact)).unwrap_err();
    assert!(matches!(failure, Failure::Bounds { control: 1, .. }), "{failure}");
}

#[test]
fn exact_ddp_ends_quadratically_and_ilqr_linearly() {
    let [exact, twin] = BOTH.map(|curvature| {
        let mut arm = problems::large_motion().unwrap();
        arm.problem.solve(&arm.x, &arm.u, &options(curvature)).unwrap()
    });
    assert_eq!([exact.status, twin.status], [Status::Converged; 2]);
    assert!((exact.trajectory.cost - twin.trajectory.cost).abs() < 1e-12 * exact.trajectory.cost);
    assert!(compare::order(&exact).unwrap() > 1.7, "{:?}", compare::order(&exact));

    // Quadratic: g_k / g_{k-1}^2 is bounded while g falls by many digits at once. No regularisation is left.
    let tail = &exact.log[exact.log.len() - 4..];
    for two in tail[..3].windows(2) {
        let [before, after] = [two[0].gradient, two[1].gradient];
        assert!(after < 1e3 * before * before && after < 1e-2 * before, "{before:e} -> {after:e}");
        assert_eq!((two[0].share, two[0].mu, two[0].alpha), (1.0, 0.0, 1.0));
    }
    // Linear: one and the same ratio, whole steps, down to rounding.
    let ratios: Vec<f64> = twin.log.windows(2).map(|two| two[1].gradient / two[0].gradient).collect();
    let tail: Vec<f64> = (0..ratios.len())
        .filter(|&k| (1e-10..1e-4).contains(&twin.log[k].gradient))
        .map(|k| ratios[k])
        .collect();
    let [low, high] =
        [f64::min as fn(f64, f64) -> f64, f64::max].map(|f| tail.iter().copied().reduce(f).unwrap());
    assert!(tail.len() > 8 && low > 0.3 && high < 1.05 * low, "{tail:?}");
}

/// The cost of controls, clamped by nobody.
fn cost<P: Step<f64>, L: Cost<f64>, T: Cost<f64>>(
    p: &mut Problem<P, L, T>,
    x: &[f64],
    u: &[DVector<f64>],
) -> f64 {
    let (mut x, mut sum) = (x.to_vec(), 0.0);
    for u in u {
        sum += p.h * p.running.evaluate(&x, u.as_slice()).unwrap();
        x = p.step.evaluate(&x, u.as_slice(), p.h).unwrap().to_vec();
    }
    sum + p.terminal.evaluate(&x, &[]).unwrap()
}

/// Its gradient by an adjoint sweep along a trajectory.
fn gradient<P: Step<f64>, L: Cost<f64>, T: Cost<f64>>(
    p: &mut Problem<P, L, T>,
    s: &Solution,
) -> Vec<DVector<f64>> {
    let (x, u) = (&s.trajectory.x, &s.trajectory.u);
    let mut y = DVector::from_column_slice(p.terminal.gradient(x[u.len()].as_slice(), &[]).unwrap().x);
    let mut gradient = vec![DVector::zeros(0); u.len()];
    for k in (0..u.len()).rev() {
        let (x, u) = (x[k].as_slice(), u[k].as_slice());
        let l = p.running.gradient(x, u).unwrap();
        let [l_x, l_u] = [l.x, l.u].map(|part| p.h * DVector::from_column_slice(part));
        let step = p.step.linearise(x, u, p.h).unwrap();
        gradient[k] = l_u + step.phi_u.as_nalgebra().tr_mul(&y);
        y = l_x + step.phi_x.as_nalgebra().tr_mul(&y);
    }
    gradient
}

#[test]
fn solutions_with_bounds_are_local_minima_that_satisfy_the_first_order_conditions() {
    for curvature in BOTH {
        let mut arm = problems::large_motion_with_bounds().unwrap();
        let solution = arm.problem.solve(&arm.x, &arm.u, &options(curvature)).unwrap();
        assert_eq!(solution.status, Status::Converged);
        let (u, best) = (&solution.trajectory.u, solution.trajectory.cost);
        let p = &mut arm.problem;
        assert!((cost(p, &arm.x, u) - best).abs() < 1e-13 * best);

        let gradient = gradient(p, &solution);
        let largest = gradient.iter().map(DVector::amax).fold(0.0, f64::max);
        let mut held = [0, 0];
        for (u, gradient) in u.iter().zip(&gradient) {
            for (&u, &gradient) in u.iter().zip(gradient) {
                assert!((-4.0..=4.0).contains(&u));
                match u {
                    -4.0 => assert!(gradient > -1e-10 * largest),
                    4.0 => assert!(gradient < 1e-10 * largest),
                    _ => assert!(gradient.abs() < 1e-10 * largest),
                }
                held[0] += usize::from(u == -4.0);
                held[1] += usize::from(u == 4.0);
            }
        }
        assert!(held[0] > 20 && held[1] > 20, "the bounds bind: {held:?}");

        // Central finite differences of the cost, good to about ten digits of the cost over the step.
        for k in [0, 17, 50, 83, 99] {
            let at = |off: f64, p: &mut _| {
                let mut u = u.clone();
                u[k][k % 2] += off;
                cost(p, &arm.x, &u)
            };
            let slope = (at(1e-4, p) - at(-1e-4, p)) / 2e-4;
            assert!((slope - gradient[k][k % 2]).abs() < 1e-7 * largest, "stage {k}");
        }

        let mut random = fastrand::Rng::with_seed(1);
        for sample in 0..60 {
            let size = [1.0, 0.1, 1e-2, 1e-3][sample % 4];
            // Half of the perturbations are one bump of a control, the others noise in all of them.
            let (control, centre) = (random.usize(..2), 100.0 * random.f64());
            let sign = if random.bool() { size } else { -size };
            let mut other = u.clone();
            for (k, u) in other.iter_mut().enumerate() {
                for i in 0..2 {
                    let bump =
                        (-(k as f64 - centre).powi(2) / 50.0).exp() * f64::from(u8::from(i == control));
                    let off = if sample < 30 { sign * bump } else { size * (2.0 * random.f64() - 1.0) };
                    u[i] = (u[i] + off).clamp(-4.0, 4.0);
                }
            }
            let risen = cost(p, &arm.x, &other) - best;
            assert!(risen > -1e-12 * best, "sample {sample} of size {size}: {risen:e}");
        }
    }
}

#[test]
fn small_programmes_with_bounds() {
    let h = dmatrix![2.0, 1.2, 0.0; 1.2, 1.0, 0.1; 0.0, 0.1, 0.5];
    let mut random = fastrand::Rng::with_seed(2);
    for _ in 0..200 {
        let g = DVector::from_fn(3, |_, _| 4.0 * random.f64() - 2.0);
        let lower = DVector::from_fn(3, |_, _| if random.bool() { 0.0 } else { -random.f64() });
        let upper = DVector::from_fn(3, |_, _| random.f64());
        let minimum = box_qp::minimise(&h, &g, [&lower, &upper]).unwrap();
        let gradient = &g + &h * &minimum.d;
        for i in 0..3 {
            assert!(lower[i] <= minimum.d[i] && minimum.d[i] <= upper[i]);
            let free = minimum.free.contains(&i);
            assert!(!free || gradient[i].abs() < 1e-13);
            assert!(free || (gradient[i] > 0.0 && minimum.d[i] == lower[i]) || minimum.d[i] == upper[i]);
        }
    }
    let (h, wide) = (dmatrix![1.0, 0.0; 0.0, -1.0], dvector![9.0, 9.0]);
    assert!(box_qp::minimise(&h, &dvector![0.1, 0.0], [&-&wide, &wide]).is_err());
    // A held component may have negative curvature.
    let at_bound = dvector![9.0, 0.0];
    let minimum = box_qp::minimise(&h, &dvector![0.1, -1.0], [&-&wide, &at_bound]).unwrap();
    assert_eq!(minimum.free, [0]);
    assert_eq!(minimum.d, dvector![-0.1, 0.0]);
}
