//! Motions on other meshes, and what is continuous at nodes.

use super::{Mesh, Shape, Spline};

/// Random motions of two joints: one phase, and two of different times.
fn motions(shape: Shape) -> [(Spline, Vec<f64>); 2] {
    let mut random = fastrand::Rng::with_seed(3);
    let mut motion = |nodes: Vec<f64>, times: Vec<f64>, finer: Vec<f64>| {
        let mesh = Mesh::new(nodes, shape);
        let size = Spline::size(2, mesh.intervals(), shape);
        let unknowns = (0..size).map(|_| random.f64() - 0.5).collect();
        (Spline { dof: 2, mesh, unknowns, times, ..Spline::default() }, finer)
    };
    [
        motion(vec![0.0, 0.3, 0.4, 1.0], vec![1.7], vec![0.0, 0.1, 0.3, 0.35, 0.4, 0.9, 1.0]),
        motion(
            vec![0.0, 0.6, 1.0, 1.5, 1.75, 2.0],
            vec![1.7, 0.6],
            vec![0.0, 0.1, 0.6, 1.0, 1.25, 1.5, 1.75, 2.0],
        ),
    ]
}

fn sample(spline: &Spline, s: f64, z: &mut [f64]) {
    let (k, x) = spline.mesh.place(s);
    spline.in_interval(k, x, z);
}

#[test]
fn a_finer_mesh_carries_the_same_motion() {
    for shape in [Shape::Quartic, Shape::Quintic] {
        for (spline, nodes) in motions(shape) {
            let finer = spline.on_nodes(nodes);
            let phases = spline.mesh.phases() as f64;
            let (mut found, mut expected) = ([0.0; 8], [0.0; 8]);
            for i in 0..=50 {
                let s = phases * f64::from(i) / 50.0;
                sample(&finer, s, &mut found);
                sample(&spline, s, &mut expected);
                let size = expected.iter().fold(1.0, |most: f64, z| most.max(z.abs()));
                assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11 * size), "{s}");
                assert!((spline.place_of(spline.time_at(s)) - s).abs() < 1e-14);
            }
            let mut z = vec![0.0; 6 * spline.mesh.points()];
            spline.evaluate(&mut z);
            let mut sum = 0.0;
            for p in 0..spline.mesh.points() {
                let (k, j) = spline.mesh.interval_of(p);
                spline.in_interval(k, shape.places()[j], &mut expected[..6]);
                assert!(z[6 * p..6 * p + 6].iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11));
                sum += spline.weight(p);
            }
            assert!((sum - spline.duration()).abs() < 1e-14);
            let points: Vec<usize> =
                (0..spline.mesh.phases()).flat_map(|phase| spline.mesh.points_of_phase(phase)).collect();
            assert_eq!(points, (0..spline.mesh.points()).collect::<Vec<_>>());
        }
    }
}

#[test]
fn rates_do_not_jump_nor_accelerations_of_quintics() {
    for (shape, orders) in [(Shape::Quartic, 2), (Shape::Quintic, 3)] {
        for (spline, _) in motions(shape) {
            for k in 0..spline.mesh.intervals() - 1 {
                let (mut left, mut right) = ([0.0; 6], [0.0; 6]);
                spline.in_interval(k, 1.0, &mut left);
                spline.in_interval(k + 1, 0.0, &mut right);
                let pairs = left.iter().zip(&right).take(2 * orders);
                assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-12), "{left:?} {right:?}");
            }
        }
    }
}

#[test]
fn coefficients_are_those_of_the_motion() {
    for shape in [Shape::Quartic, Shape::Quintic] {
        for (spline, _) in motions(shape) {
            let (mut coefficients, mut z) = (Vec::new(), [0.0; 6]);
            for k in 0..spline.mesh.intervals() {
                let count = spline.coefficients(k, &mut coefficients);
                for x in [0.0, 0.3, 1.0] {
                    spline.in_interval(k, x, &mut z);
                    for (own, q) in coefficients.chunks_exact(count).zip(&z) {
                        let value = own.iter().rev().fold(0.0, |sum, c| sum * x + c);
                        assert!((value - q).abs() < 1e-13, "{shape:?} {k} {x}: {value} {q}");
                    }
                }
            }
        }
    }
}

/// Bases over differences have the same values with the right node at F x + d, whatever orders are
/// differences; with all of them, derivatives above that of an unknown of the left node are exactly zero.
#[test]
fn bases_of_differences_are_those_of_unknowns() {
    for shape in [Shape::Quartic, Shape::Quintic] {
        for (mut spline, _) in motions(shape) {
            let (order, inner, nodes) = (shape.node(), shape.inner(), spline.mesh.nodes.len());
            for orders in [[true; 3], [false, true, true], [false, true, false], [false; 3]] {
                spline.differences = vec![orders; nodes];
                for (k, j) in (0..nodes - 1).flat_map(|k| (0..shape.places().len()).map(move |j| (k, j))) {
                    let (known, own) = (spline.basis(k, j), spline.basis_of_changes(k, j));
                    let Some(flow) = spline.flow(k) else {
                        assert!(orders == [false; 3] && known == own);
                        continue;
                    };
                    for (derivative, (known, own)) in known.rows.iter().zip(&own.rows).enumerate() {
                        let size = known.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
                        for m in 0..order {
                            let led: f64 = (0..order).map(|i| known[inner + order + i] * flow[i][m]).sum();
                            assert!((known[inner + m] + led - own[inner + m]).abs() < 1e-13 * size);
                            assert!(orders != [true; 3] || derivative <= m || own[inner + m] == 0.0);
                        }
                        assert_eq!(known[inner + order..], own[inner + order..]);
                    }
                }
            }
        }
    }
}
