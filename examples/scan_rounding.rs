//! Temporary: ratios of differences to bounds over many random robots.
use costate::derivative::{RoundingBounds, Routes};
use costate::hamiltonian::{Hamiltonian, SecondOrder};
use costate::robot::{Friction, JointSpec, LinkInertia, LoadOptions, Placement, Robot, Spring};
use costate::step::StepRoutes;
use fastrand::Rng;
use nalgebra::Matrix3;
use std::collections::BTreeMap;

fn random(rng: &mut Rng, most: usize) -> Robot {
    let n = 1 + rng.usize(..most);
    let family = rng.usize(..6);
    let spread = match family {
        0 | 1 | 5 => 0.0,
        2 => 2.0,
        3 => 6.0,
        _ => 4.0,
    };
    let mut b = Robot::builder("r");
    if rng.usize(..4) == 0 {
        b = b.gravity([0.0; 3]);
    }
    let mut u = |r: f64| r * (2.0 * rng.f64() - 1.0);
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut prismatics = 0;
    for i in 0..n {
        let special = u(1.0) > 0.0;
        let angles =
            if special { [0, 1, 2].map(|_| quarter * (u(2.5).round())) } else { [u(3.1), u(3.1), u(3.1)] };
        let xyz = if u(1.0) > 0.5 { [0.0; 3] } else { [u(0.6), u(0.6), u(0.6)] };
        let pris = (family != 5 && u(1.0) > 0.2 && prismatics < 3) || (family == 5 && (i % 3 != 2));
        if pris {
            prismatics += 1;
        }
        let mut s =
            if pris { JointSpec::prismatic(format!("j{i}")) } else { JointSpec::revolute(format!("j{i}")) };
        let axis = if special || family == 5 {
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][i % 3]
        } else {
            [u(1.0), u(1.0), u(1.0) + 1.5]
        };
        let placed = if family == 5 && i % 3 != 0 {
            Placement::from_xyz_rpy([0.0; 3], [0.0; 3])
        } else {
            Placement::from_xyz_rpy(xyz, angles)
        };
        s = s.placed(placed).axis(axis);
        if u(1.0) > 0.6 {
            s = s.armature(u(0.5).abs());
        }
        if u(1.0) > 0.6 {
            s = s.spring(Spring { stiffness: 10.0 + u(9.0), rest: u(1.0) });
        }
        if u(1.0) > 0.6 {
            s = s.friction(Friction {
                viscous: 1.0 + u(1.0),
                coulomb: 1.0 + u(1.0),
                coulomb_velocity: 0.6 + u(0.4),
            });
        }
        let massless = (family == 5 && i % 3 != 2 && i + 1 < n) || (family != 5 && u(1.0) > 0.7 && i + 1 < n);
        if !massless {
            let m = 10f64.powf(u(spread)) * (2.0 + u(1.8));
            let r = [0, 1, 2].map(|_| 0.25 + u(0.15)).map(|r| r * r);
            let t = Placement::from_xyz_rpy([0.0; 3], [u(3.0), u(3.0), u(3.0)]).rotation;
            let p =
                Matrix3::from_diagonal(&nalgebra::Vector3::new(r[1] + r[2], r[0] + r[2], r[0] + r[1])) * m;
            s = s.carrying(LinkInertia::about_com(m, [u(0.3), u(0.3), u(0.3)], t * p * t.transpose()));
        }
        if i > 0 {
            let parent = if u(1.0) > 0.4 && !(family == 5 && i % 3 != 0) {
                (u(0.5) + 0.5) * i as f64
            } else {
                (i - 1) as f64
            };
            s = s.on(format!("j{}", (parent as usize).min(i - 1)));
        }
        b = b.joint(s);
    }
    b.build().unwrap_or_else(|_| random(rng, most))
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let (count, seed, most): (usize, u64, usize) =
        (arguments[1].parse().unwrap(), arguments[2].parse().unwrap(), arguments[3].parse().unwrap());
    let files: Vec<Robot> = arguments[4..]
        .iter()
        .map(|f| Robot::from_file_with(f, LoadOptions { friction: true, ..LoadOptions::default() }).unwrap())
        .collect();
    let mut rng = Rng::with_seed(seed);
    let mut worst: BTreeMap<String, Vec<(f64, f64, f64, u64)>> = BTreeMap::new();
    let (mut done, mut refused) = (0, 0);
    for k in 0..count {
        let now = rng.get_seed();
        let robot = if files.is_empty() { random(&mut rng, most) } else { files[k % files.len()].clone() };
        let n = robot.len();
        let (mut routes, mut steps) = (Routes::new(&robot), StepRoutes::new(&robot));
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        for _ in 0..5 {
            let mut many = |k: usize, r: f64| (0..k).map(|_| r * (2.0 * rng.f64() - 1.0)).collect::<Vec<_>>();
            let (mut q, v, u, y) = (many(n, 3.14), many(n, 1.5), many(n, 2.0), many(2 * n, 1.0));
            match rng.usize(..6) {
                0 => q.fill(0.0),
                1 => {
                    let t = 10f64.powf(-6.0 * rng.f64());
                    q.iter_mut().for_each(|q| *q = std::f64::consts::FRAC_PI_2 * (*q).round() + t * *q)
                }
                _ => {}
            }
            let Ok(p) = hamiltonian.momentum(&q, &v) else { continue };
            let x = [q.clone(), p.to_vec()].concat();
            if let Ok(bounds) = RoundingBounds::new(&robot).at(&x, &u, &y) {
                let mut second = SecondOrder::<f64>::new(&robot);
                if let Ok(all) = second.contracted_hessian(&q, &x[n..], &u, &y) {
                    for (name, m, b) in [
                        ("F_x", all.linearisation().matrix().to_nalgebra(), &bounds.f_x),
                        ("y'F_xx", all.matrix().to_nalgebra(), &bounds.y_f_xx),
                    ] {
                        for (r, c) in [(0, 0), (0, n), (n, 0), (n, n)] {
                            let block = m.view((r, c), (n, n)).into_owned();
                            let (i, j) = block.iamax_full();
                            if block[(i, j)] != 0.0 {
                                let seen = b.error[(r + i, c + j)] * f64::EPSILON / 2.0 / block[(i, j)].abs();
                                worst
                                    .entry(format!("zz detect {name} {} {}", r / n, c / n))
                                    .or_default()
                                    .push((seen * 1e12, seen, 0.0, now));
                            }
                        }
                    }
                }
            }
            let Ok(mut report) = routes.compare(&x, &u, &y) else {
                refused += 1;
                continue;
            };
            let _ = steps.compare(&x, &u, 1e-3, &y, &mut report.figures);
            done += 1;
            for f in &report.figures {
                if f.difference == 0.0 {
                    continue;
                }
                worst.entry(format!("{} | {}", f.quantity, f.route)).or_default().push((
                    f.ratio(),
                    f.difference,
                    report.condition,
                    now,
                ));
            }
        }
    }
    println!("{done} states, {refused} refused");
    for (name, mut all) in worst {
        let bad = all.iter().filter(|a| !a.0.is_finite()).count();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let at = |part: f64| all[((all.len() - 1) as f64 * part) as usize].0;
        println!(
            "{name:46} worst {:8.2} 1% {:7.3} median {:7.3} bad {bad}   top: {:?}",
            at(0.0),
            at(0.01),
            at(0.5),
            all.iter()
                .take(2)
                .map(|a| format!("{:.1e} cond {:.0e} seed {}", a.1, a.2, a.3))
                .collect::<Vec<_>>()
        );
    }
}
