//! URDF files: long ones, deep ones, truncated and mutated ones.

use crate::texts::*;
use costate::robot::LoadOptions;
use costate::robot::RobotError as E;
use costate::robot::Tree;
use costate::robot::urdf::parse;

#[test]
fn long_chains_and_deep_nesting() {
    let count = 2000;
    let mut text = String::from("<robot name=\"chain\"><link name=\"l0\"/>");
    for k in 1..=count {
        text += &format!("<link name=\"l{k}\">{INERTIAL}</link>");
    }
    for k in 0..count {
        let kind = if k == 0 { "revolute" } else { "fixed" };
        text += &format!(
            "<joint name=\"j{k}\" type=\"{kind}\"><origin xyz=\"1 0 0\"/><parent link=\"l{k}\"/><child link=\"l{}\"/></joint>\n",
            k + 1
        );
    }
    let robot = load(&(text + "</robot>"));
    let inertia = robot.joints()[0].inertia;
    assert_eq!(inertia.mass, 2.0 * f64::from(count));
    assert!((inertia.com.x - (0.1 + f64::from(count - 1) / 2.0)).abs() < 1e-9);
    let nested = format!("<robot>{}{}</robot>", "<a>".repeat(20_000), "</a>".repeat(20_000));
    assert!(matches!(refused(&nested).1, E::NoJoints { .. } | E::Malformed { .. }));
}

/// A robot of `count` hinges 1 mm apart, each on the one that `parent` names by number, as a URDF: 10 m of
/// them in one chain, which nobody takes for millimetres.
fn hinges(count: usize, parent: impl Fn(usize) -> usize) -> String {
    let mut text = String::from("<robot name=\"many\"><link name=\"l0\"/>");
    for k in 1..=count {
        text += &format!(
            "<link name=\"l{k}\">{INERTIAL}</link><joint name=\"j{k}\" type=\"revolute\"><origin xyz=\"0.001 0 0\"/>\
             <parent link=\"l{}\"/><child link=\"l{k}\"/>{LIMIT}</joint>\n",
            parent(k)
        );
    }
    text + "</robot>"
}

/// Loading, and the model of the kernels, take time and memory in proportion to the joints: within a second
/// each here, where a quadratic step took ten.
#[test]
fn ten_thousand_joints() {
    let count = 10_000;
    let start = std::time::Instant::now();
    for (parent, pairs) in [
        ((|k| k - 1) as fn(usize) -> usize, count * (count + 1) / 2),
        (|_| 0, count),
        (|k| (k - 1) / 2, 113_644),
    ] {
        let robot = load(&hinges(count, parent));
        assert_eq!(robot.joints().len(), count);
        assert_eq!((robot.armature().len(), robot.warnings()), (0, &[][..]));
        let tree = Tree::from(&robot);
        assert_eq!(tree.pairs(), pairs);
        assert_eq!(tree.subtree(0)[0], 0);
    }
    assert!(start.elapsed().as_secs() < 20, "{:?}", start.elapsed());
}

#[test]
fn ten_thousand_joints_in_toml() {
    let mut text = String::from("name = 'chain'\nconvention = 'modified-dh'\n");
    for k in 0..10_000 {
        text += &format!("[[joint]]\nname = 'j{k}'\ndh = {{ a = 1.0 }}\nmass = 1.0\ncom = [0.5, 0.0, 0.0]\n");
    }
    assert_eq!(costate::robot::file::parse(&text, LoadOptions::default()).unwrap().joints().len(), 10_000);
}

/// Any truncation or mutation gives a robot or an error.
#[test]
fn nothing_panics() {
    let published = ["ur5", "panda"].map(|name| {
        std::fs::read_to_string(format!("{}/robots/{name}.urdf", env!("CARGO_MANIFEST_DIR"))).unwrap()
    });
    let inside = "<origin xyz=\"0 0 1\" rpy=\"0 0 1\"/><axis xyz=\"0 0 1\"/><limit velocity=\"1\"/><dynamics damping=\"1\"/>";
    let own = ["revolute", "floating", "planar"].map(|kind| elbow(kind, inside));
    let parts: Vec<&str> = vec![
        "1e308", "-1e308", "nan", "\"", "<", ">", "/>", "&", "0", "-", "e", " ", "fixed", "name", "base",
        "\u{e9}", "\n",
    ];
    let mut random = fastrand::Rng::with_seed(1);
    for text in published.into_iter().chain(own) {
        let ends: Vec<usize> = text.char_indices().map(|(at, _)| at).collect();
        for _ in 0..400 {
            let at = random.choice(&ends).copied().unwrap_or(0);
            let _ = parse(&text[..at], LoadOptions::default());
            let until = ends.iter().copied().find(|&end| end >= at + random.usize(0..12)).unwrap_or(at);
            let part = random.choice(&parts).copied().unwrap_or("");
            let _ = parse(&format!("{}{part}{}", &text[..at], &text[until..]), LoadOptions::default());
        }
    }
}
