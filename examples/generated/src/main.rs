//! Runs code that `build.rs` generated; the tests compare it with the generic code of the library.

#[cfg(test)]
mod problems;

/// UR5: F, F_x and y'F_xx.
pub mod ur5 {
    include!(concat!(env!("OUT_DIR"), "/ur5_hamiltonian_y_f_xx.rs"));
}

/// Panda: F and F_x.
pub mod panda {
    include!(concat!(env!("OUT_DIR"), "/panda_hamiltonian_f_x.rs"));
}

/// Cart and pole: accelerations and their Jacobian, in (q, v).
pub mod cart_pole {
    include!(concat!(env!("OUT_DIR"), "/cart_pole_lagrangian_f_x.rs"));
}

/// A satellite with a floating base and an arm: accelerations and their Jacobian, in (q, v).
pub mod satellite {
    include!(concat!(env!("OUT_DIR"), "/satellite_lagrangian_f_x.rs"));

    /// y'F_xx d in (q, p).
    pub mod product {
        include!(concat!(env!("OUT_DIR"), "/satellite_hamiltonian_y_f_xx_d.rs"));
    }
}

/// Two-link arm: the extremals of least torque, with and without their Jacobian.
pub mod two_link {
    include!(concat!(env!("OUT_DIR"), "/two_link_pontryagin.rs"));

    /// z' alone.
    pub mod rate {
        include!(concat!(env!("OUT_DIR"), "/two_link_pontryagin_rate.rs"));
    }
}

fn main() {
    let (q, p, u) = ([0.3, -0.8, 1.1, 0.2, 0.5, -0.4], [1.0, 0.5, -0.2, 0.1, 0.0, 0.02], [0.0; 6]);
    let y: [f64; 12] = std::array::from_fn(|k| 1.0 - 0.1 * k as f64);
    let (mut f, mut f_x, mut y_f_xx) = ([0.0; 12], [0.0; 144], [0.0; 144]);
    ur5::ur5_hamiltonian_y_f_xx(&q, &p, &u, &y, &mut f, &mut f_x, &mut y_f_xx);
    let (mut z_t, mut l) = ([0.0; 8], [0.0; 2]);
    two_link::rate::two_link_pontryagin_rate(
        &[0.1, 0.2],
        &[1.0, 0.3],
        &[3.0, 2.0, 1.0, 0.5],
        &mut z_t,
        &mut l,
    );
    println!("Two-link arm: dz/dt = {z_t:.4?}");
    println!("UR5: dx/dt = {f:.4?}");
    println!("first row of F_x = {:.4?}", &f_x[..12]);
    println!("first row of y'F_xx = {:.4?}", &y_f_xx[..12]);
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests fail by panicking")]

    use super::{cart_pole, panda, problems, satellite, two_link, ur5};
    use costate::configuration::ConfigurationSpace;
    use costate::derivative::largest;
    use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
    use costate::lagrangian::Lagrangian;
    use costate::matrix::Block;
    use costate::num_dual::Dual64;
    use costate::robot::Robot;
    use costate_control::{
        BoundaryValueProblem, ControlLaw, GeneratedExtremal, JacobianRoute, Problem, RobotExtremal,
        SolverOptions, solve_extremal,
    };
    use std::array::from_fn;
    use std::path::{Path, PathBuf};

    fn robot(file: &str) -> Robot {
        Robot::from_file(format!("{}/../../robots/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap()
    }

    fn agree(found: &[f64], expected: &[f64]) {
        let differences: Vec<f64> = found.iter().zip(expected).map(|(a, b)| a - b).collect();
        assert_eq!(found.len(), expected.len());
        assert!(largest(&differences) <= 1e-12 * largest(expected), "{found:?} is not {expected:?}");
    }

    fn flat(block: Block<'_, f64>) -> Vec<f64> {
        block.iter_rows().flatten().copied().collect()
    }

    fn numbers<const N: usize>(state: usize, size: f64) -> [f64; N] {
        from_fn(|k| size * (1.0 + 3.7 * state as f64 + 1.3 * k as f64).sin())
    }

    #[test]
    fn second_derivatives_of_the_ur5_are_those_of_the_generic_code() {
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot("ur5.urdf"));
        for state in 0..20 {
            let (q, p, u): ([f64; 6], [f64; 6], [f64; 6]) =
                (numbers(state, 3.0), numbers(state + 1, 1.0), numbers(state + 2, 5.0));
            let y: [f64; 12] = numbers(state, 1.0);
            let (mut f, mut f_x, mut y_f_xx) = ([0.0; 12], [0.0; 144], [0.0; 144]);
            ur5::ur5_hamiltonian_y_f_xx(&q, &p, &u, &y, &mut f, &mut f_x, &mut y_f_xx);
            let all = second.contract(&q, &p, &u, &y).unwrap();
            agree(&f, all.linearisation().f());
            agree(&f_x, &flat(all.linearisation().matrix()));
            agree(&y_f_xx, &flat(all.matrix()));
        }
    }

    #[test]
    fn derivatives_of_the_panda_are_those_of_the_generic_code() {
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot("panda.urdf"));
        for state in 0..20 {
            let (q, p, u): ([f64; 7], [f64; 7], [f64; 7]) =
                (numbers(state, 3.0), numbers(state + 1, 1.0), numbers(state + 2, 5.0));
            let (mut f, mut f_x) = ([0.0; 14], [0.0; 196]);
            panda::panda_hamiltonian_f_x(&q, &p, &u, &mut f, &mut f_x);
            let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
            agree(&f, linear.f());
            agree(&f_x, &flat(linear.matrix()));
        }
    }

    #[test]
    fn accelerations_of_cart_and_pole_are_those_of_the_generic_code() {
        let mut lagrangian = Lagrangian::<f64>::new(&robot("cart_pole.toml"));
        for state in 0..20 {
            let (q, v, u): ([f64; 2], [f64; 2], [f64; 2]) =
                (numbers(state, 3.0), numbers(state + 1, 1.0), numbers(state + 2, 5.0));
            let (mut qdd, mut qdd_z) = ([0.0; 2], [0.0; 12]);
            cart_pole::cart_pole_lagrangian_f_x(&q, &v, &u, &mut qdd, &mut qdd_z);
            let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
            agree(&qdd, linear.acceleration());
            agree(&qdd_z, &flat(linear.matrix()));
        }
    }

    /// q has the position and quaternion of the base, shoulder and elbow; derivatives are by 8 coordinates.
    #[test]
    fn derivatives_of_a_floating_base_are_those_of_the_generic_code() {
        let robot = robot("../examples/problems/robots/satellite.toml");
        let (mut lagrangian, mut second) =
            (Lagrangian::<f64>::new(&robot), HamiltonianSecondOrder::<f64>::new(&robot));
        let space = ConfigurationSpace::new(&robot);
        for state in 0..20 {
            let mut q = [0.0; 9];
            space.integrate(&space.neutral(), &numbers::<8>(state, 2.0), &mut q).unwrap();
            let (v, u): ([f64; 8], [f64; 8]) = (numbers(state + 1, 1.0), numbers(state + 2, 5.0));
            let (mut qdd, mut qdd_z) = ([0.0; 8], [0.0; 192]);
            satellite::satellite_lagrangian_f_x(&q, &v, &u, &mut qdd, &mut qdd_z);
            let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
            agree(&qdd, linear.acceleration());
            agree(&qdd_z, &flat(linear.matrix()));
            let (y, d): ([f64; 16], [f64; 16]) = (numbers(state, 1.0), numbers(state + 3, 1.0));
            let mut product = [0.0; 16];
            satellite::product::satellite_hamiltonian_y_f_xx_d(&q, &v, &y, &d, &mut product);
            agree(&product, second.hessian_product(&q, &v, &y, &d).unwrap());
        }
    }

    /// Manutec r3: F for the scalars of the library.
    mod manutec_r3 {
        include!(concat!(env!("OUT_DIR"), "/manutec_r3_hamiltonian_f.rs"));
    }

    #[test]
    fn dual_numbers_through_generated_code_give_the_jacobian_of_the_generic_code() {
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot("manutec_r3.toml"));
        let x: [f64; 6] = numbers(3, 1.5);
        let u: [f64; 3] = numbers(1, 4.0);
        let linear = hamiltonian.linearise(&x[..3], &x[3..], &u).unwrap();
        let f_x = linear.matrix();
        for column in 0..6 {
            let seeded: [Dual64; 6] = from_fn(|k| Dual64::new(x[k], f64::from(u8::from(k == column))));
            let (q, p): ([Dual64; 3], [Dual64; 3]) = (from_fn(|k| seeded[k]), from_fn(|k| seeded[3 + k]));
            let mut f = [Dual64::new(0.0, 0.0); 6];
            manutec_r3::manutec_r3_hamiltonian_f(&q, &p, &u.map(Dual64::from), &mut f);
            agree(&f.map(|f| f.re), linear.f());
            let expected: Vec<f64> = (0..6).map(|row| f_x[(row, column)]).collect();
            agree(&f.map(|f| f.eps), &expected);
        }
    }

    /// Manutec r3: extremals with bounds and penalties.
    mod manutec_r3_extremals {
        include!(concat!(env!("OUT_DIR"), "/manutec_r3_pontryagin.rs"));

        pub mod rate {
            include!(concat!(env!("OUT_DIR"), "/manutec_r3_pontryagin_rate.rs"));
        }
    }

    fn robots() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots")
    }

    /// z', l and the Jacobian of z' by the library.
    fn of_the_library(problem: &Problem, z: &[f64]) -> (Vec<f64>, [f64; 2], Vec<f64>) {
        let mut extremal = RobotExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
        let (mut g, mut jacobian) = (vec![0.0; z.len()], vec![0.0; z.len() * z.len()]);
        let rate = extremal.linearise(z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
        (g, [rate.cost, rate.penalty], jacobian)
    }

    #[test]
    fn extremals_of_the_manutec_r3_are_those_of_the_library_on_both_sides_of_its_bounds() {
        let problem = problems::manutec_r3(&robots()).unwrap();
        let mut at_bound = [0; 2];
        for state in 0..40 {
            let (q, p): ([f64; 3], [f64; 3]) = (numbers(state, 1.5), numbers(state + 1, 20.0));
            let y: [f64; 6] = numbers(state + 2, 0.25);
            let (mut z_t, mut l, mut z_t_z) = ([0.0; 12], [0.0; 2], [0.0; 144]);
            manutec_r3_extremals::manutec_r3_pontryagin(&q, &p, &y, &mut z_t, &mut l, &mut z_t_z);
            let expected = of_the_library(&problem, &[&q[..], &p, &y].concat());
            agree(&z_t, &expected.0);
            agree(&l, &expected.1);
            agree(&z_t_z, &expected.2);
            let (mut rate, mut cost) = ([0.0; 12], [0.0; 2]);
            manutec_r3_extremals::rate::manutec_r3_pontryagin_rate(&q, &p, &y, &mut rate, &mut cost);
            agree(&rate, &expected.0);
            agree(&cost, &expected.1);
            for i in 0..3 {
                at_bound[usize::from(z_t_z[(3 + i) * 12 + 9 + i] == 0.0)] += 1;
            }
            assert!(l[1] > 0.0, "penalties are at work");
        }
        assert!(at_bound[0] > 10 && at_bound[1] > 10, "{at_bound:?} inside and at a bound");
    }

    /// The four parts of z of the two-link arm.
    fn parts(z: &[f64]) -> ([f64; 2], [f64; 2], [f64; 4]) {
        (from_fn(|i| z[i]), from_fn(|i| z[2 + i]), from_fn(|i| z[4 + i]))
    }

    #[test]
    fn the_solver_runs_on_compiled_extremals() {
        let problem = problems::two_link(&robots()).unwrap();
        let mut extremal = GeneratedExtremal::new(
            &problem,
            |z, z_t, l| {
                let (q, p, y) = parts(z);
                let (z_t, l) = (z_t.try_into().unwrap(), l.try_into().unwrap());
                two_link::rate::two_link_pontryagin_rate(&q, &p, &y, z_t, l);
            },
            |z, z_t, l, z_t_z| {
                let (q, p, y) = parts(z);
                let (z_t, l) = (z_t.try_into().unwrap(), l.try_into().unwrap());
                two_link::two_link_pontryagin(&q, &p, &y, z_t, l, z_t_z.try_into().unwrap());
            },
        )
        .unwrap();
        let guess = |s: f64, z: &mut [f64]| {
            z[..2].iter_mut().zip(&problem.end.q).for_each(|(z, q)| *z = q * s * s * (3.0 - 2.0 * s));
        };
        let options = SolverOptions::default().with_tolerance(1e-9);
        let motion = solve_extremal(&mut extremal, problem.time, &options, guess);
        assert!(motion.motion.status.is_converged(), "{}", motion.motion.status);
        assert!((motion.motion.cost - 145.131_137_54).abs() < 1e-7, "{}", motion.motion.cost);
    }

    /// What the sine and cosine of generated code differ by from those of the standard library, in units of
    /// the last place.
    #[test]
    fn sine_and_cosine_are_right_to_two_units_in_the_last_place() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let near = (-70_000..70_000).map(|k| f64::from(k) * quarter + 1e-9 * f64::from(k % 7));
        let spread = (0..400_000).map(|k| 120_000.0 * (f64::from(k) / 200_000.0 - 1.0).powi(3));
        let special = [0.0, -0.0, 1e-300, 1e22, f64::INFINITY, f64::NAN, 99_999.999, 0.5 * quarter];
        for x in near.chain(spread).chain(special) {
            let (s, c) = ur5::Number::sin_cos(x);
            for (found, expected) in [(s, x.sin()), (c, x.cos())] {
                let unit = expected.abs().next_up() - expected.abs();
                let same = found.is_nan() && expected.is_nan();
                assert!(same || (found - expected).abs() <= 2.0 * unit, "at {x}: {found} is not {expected}");
            }
        }
    }
}
