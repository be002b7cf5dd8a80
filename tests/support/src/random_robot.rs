//! Random robots and states for property tests.

pub use crate::random_part::Part;
use crate::random_part::{dof, independent, mimicked, numbers, parent, parts};
use crate::random_position::{Kind, every, positions, single};
use costate::derivative::largest;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot, Spring};
use nalgebra::{DMatrix, Matrix3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A robot and a state; printed whole where a property fails.
#[derive(Clone, Debug)]
pub struct Case {
    pub parts: Vec<Part>,
    /// Factor of a full armature matrix `B B'`; empty for none.
    pub coupling: Vec<f64>,
    pub gravity: [f64; 3],
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub u: Vec<f64>,
    pub y: Vec<f64>,
}

/// Whether the mass matrix can be inverted in double precision.
fn is_regular(case: &Case) -> bool {
    let condition = condition(&case.robot(), &case.q);
    0.0 < condition && condition < 1e9
}

/// Robots of 1 to `most` joints of one degree of freedom, and states, with a mass matrix that can be inverted
/// in double precision.
pub fn cases(most: usize) -> impl Strategy<Value = Case> {
    all_cases(most).prop_filter("M is regular", is_regular)
}

/// The same with joints of every type, of which at least one is floating or spherical.
pub fn free_cases(most: usize) -> impl Strategy<Value = Case> {
    of_kinds(most, every(), |parts| {
        if parts.iter().all(|part| part.kind.free().is_none()) {
            parts[0].kind = Kind::Floating;
        }
    })
    .prop_filter("M is regular", is_regular)
}

/// The same where all stands on one floating joint, and no gravity or that along z of the world.
pub fn flying_cases(most: usize) -> impl Strategy<Value = Case> {
    let all = of_kinds(most, every(), |parts| {
        parts[0].kind = Kind::Floating;
        let on_world = |(i, part): &(usize, &mut Part)| parent(part, *i).is_none();
        parts.iter_mut().enumerate().skip(1).filter(on_world).for_each(|(_, part)| part.parent = 1);
    });
    (all, prop_oneof![Just([0.0; 3]), Just([0.0, 0.0, -9.81])])
        .prop_map(|(case, gravity)| Case { gravity, ..case })
        .prop_filter("M is regular", is_regular)
}

/// Robots of 1 to `most` joints of one degree of freedom, and states; q = 0 and v = 0 among them. Joints may
/// be redundant.
pub fn all_cases(most: usize) -> impl Strategy<Value = Case> {
    of_kinds(most, single(), |_| {})
}

/// Robots of 1 to `most` joints of these types, changed as asked for, and states.
fn of_kinds(most: usize, kinds: BoxedStrategy<Kind>, change: fn(&mut [Part])) -> impl Strategy<Value = Case> {
    let drawn = (1..=most).prop_flat_map(move |count| parts(count, kinds.clone()));
    let changed = drawn.prop_map(move |mut parts| {
        change(&mut parts);
        parts
    });
    changed.prop_flat_map(|parts| {
        let (n, all) = (dof(&parts), parts.iter().filter(|part| part.kind.free().is_none()).count());
        let vector = move |range: f64| prop::collection::vec(-range..range, n);
        let zero = Just(vec![0.0; n]);
        let q = if parts.len() == all {
            prop_oneof![4 => vector(PI).boxed(), 1 => zero.clone().boxed()].boxed()
        } else {
            positions(independent(&parts).map(|i| parts[i].kind).collect()).boxed()
        };
        (
            Just(parts),
            prop_oneof![3 => Just(Vec::new()), 1 => prop::collection::vec(-0.5..0.5, all * all)],
            prop_oneof![Just([0.0, 0.0, -9.81]), Just([0.0; 3]), numbers(9.81)],
            q,
            prop_oneof![4 => vector(2.0).boxed(), 1 => zero.boxed()],
            vector(3.0),
            prop::collection::vec(-1.0..1.0, 2 * n),
        )
            .prop_map(|(parts, coupling, gravity, q, v, u, y)| Case {
                parts,
                coupling,
                gravity,
                q,
                v,
                u,
                y,
            })
    })
}

impl Case {
    /// Number of degrees of freedom.
    pub fn n(&self) -> usize {
        dof(&self.parts)
    }

    /// Index of the first entry of q and of v of joint `i`, unless it mimics another one.
    pub fn start(&self, i: usize) -> Option<[usize; 2]> {
        let before = independent(&self.parts).take_while(|&k| k < i).map(|k| self.parts[k].kind);
        let start = before.fold([0; 2], |[q, v], kind| [q + kind.positions(), v + kind.dof()]);
        self.mimicked(i).is_none().then_some(start)
    }

    /// The joint that joint `i` mimics: one before it, which may mimic another one itself, or an independent
    /// one after it.
    pub fn mimicked(&self, i: usize) -> Option<usize> {
        mimicked(&self.parts, i)
    }

    /// Parent of joint `i`: one of those before it, or the world; chains are as likely as branches.
    pub fn parent(&self, i: usize) -> Option<usize> {
        parent(&self.parts[i], i)
    }

    /// The same with every joint independent, where it was; u and y are repeated. Without free joints.
    pub fn all_independent(&self) -> Self {
        let robot = self.robot();
        let rates = robot.joints().iter().map(|joint| joint.mimic);
        let indices = robot.independent_indices();
        let of = |joint: usize, x: &[f64]| indices.iter().position(|&i| i == joint).map_or(0.0, |k| x[k]);
        let v = rates.enumerate().map(|(i, mimic)| match mimic {
            Some(mimic) => mimic.ratio * of(mimic.joint, &self.v),
            None => of(i, &self.v),
        });
        let repeated = |x: &[f64], count: usize| x.iter().cycle().take(count).copied().collect();
        let all = self.parts.len();
        Self {
            q: robot.joint_positions(&self.q).unwrap(),
            v: v.collect(),
            u: repeated(&self.u, all),
            y: repeated(&self.y, 2 * all),
            parts: self.parts.iter().map(|part| Part { mimic: None, ..part.clone() }).collect(),
            ..self.clone()
        }
    }

    pub fn specs(&self) -> Vec<JointSpec> {
        let name = |i: usize| format!("j{i}");
        let spec = |(i, part): (usize, &Part)| {
            let [viscous, coulomb, coulomb_velocity] = part.friction;
            let single = |i: usize| self.parts[i].kind.free().is_none();
            let bears = |next: usize| next < self.parts.len() && self.parent(next) == Some(i) && single(next);
            let mut spec = part.kind.spec(name(i)).placed(Placement::from_xyz_rpy(part.xyz, part.rpy));
            if single(i) {
                spec = spec
                    .axis(part.axis)
                    .armature(part.armature)
                    .spring(Spring { stiffness: part.spring[0], rest: part.spring[1] })
                    .friction(Friction { viscous, coulomb, coulomb_velocity });
            }
            if !(part.massless && single(i) && bears(i + 1)) {
                spec = spec.carrying(self.link(part));
            }
            if let (Some(joint), Some((_, ratio, offset))) = (self.mimicked(i), part.mimic) {
                spec = spec.mimicking(name(joint), ratio, offset);
            }
            match self.parent(i) {
                Some(parent) => spec.on(name(parent)),
                None => spec,
            }
        };
        self.parts.iter().enumerate().map(spec).collect()
    }

    /// A homogeneous ellipsoid-like body: principal moments that obey the triangle inequality, turned.
    fn link(&self, part: &Part) -> LinkInertia {
        let [a, b, c] = part.radii.map(|r| r * r);
        let turn = Placement::from_xyz_rpy([0.0; 3], part.rpy.map(|angle| 0.7 * angle + 0.2)).rotation;
        let principal = Matrix3::from_diagonal(&Vector3::new(b + c, a + c, a + b)) * part.mass;
        LinkInertia::about_com(part.mass, part.com, turn * principal * turn.transpose())
    }

    pub fn robot(&self) -> Robot {
        let builder = Robot::builder("random").gravity(self.gravity);
        let builder = self.specs().into_iter().fold(builder, |builder, spec| builder.joint(spec));
        if self.coupling.is_empty() {
            return builder.build().unwrap();
        }
        // A free joint is several in a row, of which none has armature.
        let single = |part: &Part| vec![part.kind.free().is_none(); part.kind.dof()];
        let joints: Vec<bool> = self.parts.iter().flat_map(single).collect();
        let places: Vec<usize> = (0..joints.len()).filter(|&i| joints[i]).collect();
        let factor = DMatrix::from_row_slice(places.len(), places.len(), &self.coupling);
        let product = &factor * factor.transpose();
        let mut armature = DMatrix::zeros(joints.len(), joints.len());
        for (i, &row) in places.iter().enumerate() {
            places.iter().enumerate().for_each(|(j, &column)| armature[(row, column)] = product[(i, j)]);
        }
        builder.armature_matrix(armature).build().unwrap()
    }

    /// Conjugate momentum p = M v.
    pub fn p(&self, robot: &Robot) -> Vec<f64> {
        Hamiltonian::<f64>::new(robot).momentum(&self.q, &self.v).unwrap().to_vec()
    }

    pub fn x(&self, robot: &Robot) -> Vec<f64> {
        [self.q.clone(), self.p(robot)].concat()
    }
}

/// Condition number of the mass matrix.
pub fn condition(robot: &Robot, q: &[f64]) -> f64 {
    let mass_matrix = Hamiltonian::<f64>::new(robot).mass_matrix(q).unwrap().view().to_nalgebra();
    let values = nalgebra::SymmetricEigen::new(mass_matrix).eigenvalues;
    values.max() / values.min()
}

/// `max |a - b| / max |b|`; the entries of a quantity are judged together.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    let worst = largest(&differences);
    if worst == 0.0 { 0.0 } else { worst / largest(b) }
}

/// The same, relative to this size at least: where `b` vanishes up to rounding.
pub fn difference_at(size: f64, a: &[f64], b: &[f64]) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    largest(&differences) / largest(b).max(size)
}
