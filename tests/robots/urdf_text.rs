//! URDF as a text: foreign elements, published oddities, encodings, names.

use crate::texts::*;
use costate::robot::RobotError as E;
use costate::robot::{LoadOptions, Robot, RobotFormat};

#[test]
fn what_is_not_dynamics_is_not_read() {
    let shapes = r#"<visual><origin xyz="${x}"/><geometry><mesh/></geometry></visual><visual/><collision><geometry><box size="a"/></geometry></collision>"#;
    let rest = r#"<material/><transmission name="t"><joint name="elbow"/><joint/></transmission>
        <gazebo reference="arm"><joint name="elbow" type="ball"/><link/></gazebo><gazebo:plugin a="b"/>
        <sensor:camera other:x="1"/><ros2_control><joint name="elbow"><param name="x">nan</param></joint></ros2_control>"#;
    let safety = r#"<safety_controller k_velocity="fast"/><calibration rising="x"/>"#;
    let plain = load(&elbow("continuous", ""));
    let text = one_joint("continuous", &(INERTIAL.to_owned() + shapes), safety, rest);
    assert_eq!(load(&text), plain);
    let dressed = format!(
        "\u{feff}<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<!-- <joint/> -->\n{text}\n<!-- end -->"
    );
    assert_eq!(load(&dressed.replace('\n', "\r\n")), plain);
    let default_namespace = text
        .replace("<robot ", "<robot xmlns=\"http://www.ros.org\" xmlns:xacro=\"http://ros.org/wiki/xacro\" ");
    assert_eq!(load(&default_namespace), plain);
    let left = load(&default_namespace.replace("<material/>", "<xacro:finger name=\"f\"/>"));
    assert!(notes(&left).contains("'finger' in line 10"), "{}", notes(&left));
}

/// What XML forbids and the usual readers of URDF accept.
#[test]
fn published_oddities_do_no_harm() {
    let text = more("");
    for odd in [
        format!("\n  \n<?xml version=\"1.0\"?>\n{text}"),
        format!("<?xml verison=\"1.0\" encoding=\"latin-1\"?>{text}"),
        format!("<!-- ---- links ---- -->\n<!-- <robot> --->{text}<!-- the end -->"),
        text.replace("<link name=\"base\"/>", "<link name=\"base\"/><s:x/><!-- <robot> -->"),
    ] {
        assert_eq!(load(&odd).dof(), 1, "{odd}");
    }
    let swapped = load(&elbow("revolute", "<limit lower=\"1\" upper=\"-1\" effort=\"2\" velocity=\"3\"/>"));
    assert!(notes(&swapped).contains("no limit of position"), "{}", notes(&swapped));
    assert_eq!(swapped.joints()[0].limits.lower, f64::NEG_INFINITY);
    let (line, error) = refused(&format!("<!--\n-->\n{}", elbow("hinge", "")));
    assert!(line == Some(8) && error.to_string().contains("hinge"), "{line:?} {error}");
}

fn read(bytes: &[u8]) -> Result<Robot, E> {
    Robot::read(bytes, RobotFormat::Urdf, LoadOptions::default())
}

/// Bytes that are not UTF-8 are refused with their line, in comments too.
#[test]
fn other_encodings() {
    let text = more("");
    let not_utf8 = |bytes: &[u8], at: usize| {
        let error = read(bytes).unwrap_err();
        assert!(
            matches!(&error, E::InFile { line, error, .. } if *line == Some(at) && matches!(**error, E::NotUtf8)),
            "{error}"
        );
    };
    not_utf8(&[b"<!--\n90\xb0 -->".as_slice(), text.as_bytes()].concat(), 2);
    let (start, end) = text.split_once("elbow").unwrap();
    not_utf8(&[start.as_bytes(), b"\xe9paule", end.as_bytes()].concat(), 6);
    let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = read(&utf16).unwrap_err();
    assert!(
        matches!(&error, E::InFile { line: Some(1), error, .. } if matches!(**error, E::NotUtf8)),
        "{error}"
    );
}

#[test]
fn names_are_kept() {
    let odd = "a &lt;&amp;&quot;'&gt; \u{e9}";
    let robot = load(&elbow("revolute", "").replace("elbow", odd).replace("arm", odd).replace("bench", ""));
    assert_eq!((robot.name(), names(&robot)), ("robot", vec!["a <&\"'> \u{e9}"]));
}
