//! URDF files: long ones, deep ones, and whatever is left of them when parts are cut off or changed.

use crate::texts::*;
use costate::robot::LoadOptions;
use costate::robot::RobotError as E;
use costate::robot::urdf::parse;

#[test]
fn long_chains_and_deep_nesting() {
    let count = 2000;
    let mut text = String::from("<robot name=\"chain\">");
    for k in 0..=count {
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

/// Whatever is cut off or changed, there is a robot or an error.
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
