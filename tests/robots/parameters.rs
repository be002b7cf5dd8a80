//! Derivatives by parameters against values of other programs (`tests/fixtures/README.md`).

use costate::parameters::{
    DisplacedIn, Displacement, HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor,
};
use costate::robot::{FrameSpec, Placement, Robot};
use costate_test_support::reference::Reference;
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// The regressor of Pinocchio, with the parameters in our order, and their values as Pinocchio reads them.
fn check_regressor(file: &Path) {
    let robot = Robot::from_file(file).unwrap();
    let name = format!("tests/fixtures/{}.regressor.jsonl", robot.name());
    for line in Reference::read(&folder(&name)) {
        let joints: Vec<_> =
            line.line["joints"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
        assert!(joints.iter().eq(robot.joints().iter().map(|joint| &joint.name)), "{joints:?}");
        let set = ParameterSet::new(&robot).links();
        let [q, v, a] = ["q", "v", "a"].map(|key| line.numbers(key));
        line.agrees("pi", set.values(), robot.name());
        let mut regressor = Regressor::<f64>::new(&set);
        let tau_pi = regressor.inverse_dynamics(&q, &v, &a).unwrap();
        line.agrees("tau_pi", tau_pi.as_slice(), robot.name());
    }
}

#[test]
fn mixed_tree_has_the_regressor_of_pinocchio() {
    check_regressor(&folder("tests/fixtures/mixed_tree.urdf"));
}

#[test]
fn ur5_has_the_regressor_of_pinocchio() {
    check_regressor(&folder("robots/ur5.urdf"));
}

/// Every parameter of a tree with springs, friction and full armature, a payload, and a rotation in a
/// parent's frame, by differences in multiple precision.
#[test]
fn friction_tree_has_the_derivatives_of_differences_of_energies() {
    let robot = Robot::from_file(folder("tests/fixtures/friction_tree.toml")).unwrap();
    let tool = Placement::from_xyz_rpy([0.1, -0.2, 0.3], [0.4, -0.5, 0.6]);
    let robot = robot.with_frame(FrameSpec::new("at").on("mast").placed(tool)).unwrap();
    let [line] = &Reference::read(&folder("tests/fixtures/friction_tree.parameters.jsonl"))[..] else {
        panic!("one state")
    };
    let names: Vec<_> =
        line.line["names"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    let own = names.iter().filter(|name| !name.starts_with("tool.") && **name != "twist");
    let set = own.fold(ParameterSet::new(&robot), |set, name| set.named(name).unwrap());
    let twist = Displacement::about(DisplacedIn::Parent, [0.6, 0.0, -0.8]);
    let set = set.payload("tool", "at").unwrap().displacement("twist", "arm", twist).unwrap();
    assert_eq!(set.names(), names);
    let [q, v, a, p, u, y] = ["q", "v", "a", "p", "u", "y"].map(|key| line.numbers(key));
    let agrees = |key: &str, found: &[f64]| line.agrees(key, found, "friction_tree");
    let mut regressor = Regressor::<f64>::new(&set);
    agrees("tau_theta", regressor.inverse_dynamics(&q, &v, &a).unwrap().as_slice());
    agrees("energy_theta", regressor.energy(&q, &v).unwrap());
    let sides = regressor.momentum(&q, &v).unwrap();
    agrees("p_theta", sides.momentum.as_slice());
    agrees("force_theta", sides.force.as_slice());
    let mut in_q_p = HamiltonianParameters::<f64>::new(&set);
    let all = in_q_p.contract(&q, &p, &y).unwrap();
    agrees("f_theta", all.f_theta().as_slice());
    agrees("y_f_x_theta", all.y_f_x_theta().as_slice());
    let mut in_q_v = LagrangianParameters::<f64>::new(&set);
    agrees("a_theta", in_q_v.linearise_forward_dynamics(&q, &v, &u).unwrap().a_theta.as_slice());
}
