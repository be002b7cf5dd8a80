//! Obstacles and bodies: every key of a problem file, the same in Rust, and errors.

use super::task_file::{TOP, read};
use costate::robot::Placement;
use costate_control::{BodyPairs, Collision, LinkCapsule, Obstacle, Shape};

#[test]
fn every_key_of_obstacles_reaches_the_problem() {
    let text = "[[obstacle]]\nkind = \"sphere\"\nxyz = [0, 0, 3]\nradius = 0.2\n\
                [[obstacle]]\nname = \"post\"\nkind = \"capsule\"\nfrom = [2, 2, 0]\nto = [2, 2, 1]\nradius = 0.1\n\
                [[obstacle]]\nkind = \"box\"\nxyz = [-2, 0, 0]\nrpy = [0, 0, 0.5]\nsize = [0.3, 0.2, 0.1]\n\
                [[obstacle]]\nname = \"floor\"\nkind = \"half_space\"\nxyz = [0, 0, -1]\nnormal = [0, 0, 2]\n\
                [collision]\ncapsules = \"auto\"\nradius = 0.05\nmargin = 0.01\nexcept = [[\"floor\", \"gripper\"]]\n\
                pairs = [[\"gripper\", \"upper_arm_link\"]]\n\
                [[collision.capsule]]\nname = \"gripper\"\nframe = \"tool0\"\nto = [0, 0, 0.1]\nradius = 0.04\n\
                [[collision.capsule]]\nframe = \"joint:wrist_3_joint\"\nfrom = [0, 0, 0.1]\nradius = 0.03\n";
    let task = read(&format!("{TOP}{text}")).unwrap().problem.task;
    let shapes = [
        ("obstacle 1", Shape::Sphere { centre: [0.0, 0.0, 3.0], radius: 0.2 }),
        ("post", Shape::Capsule { from: [2.0, 2.0, 0.0], to: [2.0, 2.0, 1.0], radius: 0.1 }),
        (
            "obstacle 3",
            Shape::Box {
                placement: Placement::from_xyz_rpy([-2.0, 0.0, 0.0], [0.0, 0.0, 0.5]),
                size: [0.3, 0.2, 0.1],
            },
        ),
        ("floor", Shape::HalfSpace { through: [0.0, 0.0, -1.0], normal: [0.0, 0.0, 2.0] }),
    ];
    assert_eq!(task.obstacles, shapes.map(|(name, shape)| Obstacle::new(name, shape)));
    let mut collision = Collision::along_links(0.05)
        .with_margin(0.01)
        .with_exception("floor", "gripper")
        .with_pairs(BodyPairs::These(vec![["gripper".into(), "upper_arm_link".into()]]));
    collision.capsules = vec![
        LinkCapsule::new("tool0", [0.0; 3], [0.0, 0.0, 0.1], 0.04).with_name("gripper"),
        LinkCapsule::sphere("joint:wrist_3_joint", 0.03).with_from([0.0, 0.0, 0.1]),
    ];
    assert_eq!(task.collision, Some(collision));
}

#[test]
fn wrong_keys_of_obstacles_are_named() {
    let sphere = "[[obstacle]]\nkind = \"sphere\"\nxyz = [0, 0, 3]\nradius = 0.2\n";
    let auto = "[collision]\ncapsules = \"auto\"\nradius = 0.05\n";
    for (text, message) in [
        (sphere.into(), "problem:11: obstacle.kind: the robot has no bodies that could touch anything"),
        (sphere.replace("sphere", "cone"), "problem:11: obstacle.kind: `cone` is unknown; give `sphere`"),
        (sphere.replace("xyz", "centre") + auto, "problem:12: obstacle.centre: unknown key"),
        (
            sphere.replace("0.2", "-0.2") + auto,
            "problem:13: obstacle.radius: must be positive and finite, but is -0.2",
        ),
        (sphere.replace("0, 0, 3", "0, nan, 3") + auto, "problem:12: obstacle.xyz: must be finite"),
        (
            format!(
                "{sphere}[[obstacle]]\nkind = \"half_space\"\nxyz = [0, 0, 0]\nnormal = [0, 0, 0]\n{auto}"
            ),
            "problem:17: obstacle.normal: gives no direction",
        ),
        (
            format!("{sphere}[[obstacle]]\nkind = \"box\"\nxyz = [0, 0, 5]\nsize = [1, 0, 1]\n{auto}"),
            "problem:17: obstacle.size: must be positive and finite, but is 0",
        ),
        (
            format!(
                "{sphere}[[obstacle]]\nname = \"obstacle 1\"\nkind = \"sphere\"\nxyz = [0, 0, 5]\nradius = 1\n{auto}"
            ),
            "problem:15: obstacle.name: two bodies or obstacles are called 'obstacle 1'",
        ),
        ("[collision]\nmargin = 0.1\n".into(), "problem:10: collision.capsules: the robot has no bodies"),
        (
            "[collision]\nradius = 0.1\n".into(),
            "problem:11: collision.radius: only for `capsules = \"auto\"`",
        ),
        (auto.replace("radius = 0.05\n", ""), "problem:10: collision.radius: missing"),
        (auto.replace("auto", "all"), "problem:11: collision.capsules: `all` is unknown; give `auto`"),
        (
            format!("{auto}margin = -1\n"),
            "problem:13: collision.margin: must be neither negative nor infinite",
        ),
        (format!("{auto}pairs = \"some\"\n"), "problem:13: collision.pairs: `some` is unknown; give `all`"),
        (
            format!("{auto}pairs = [\"a\", \"b\"]\n"),
            "problem:13: collision.pairs: give a list of pairs of names",
        ),
        (
            format!("{auto}pairs = [[\"forearm_link\", \"hand\"]]\n"),
            "problem:13: collision.pairs: nothing is called 'hand'; the bodies and obstacles are ",
        ),
        (
            format!("{auto}except = [[\"forearm_link\", \"forearm_link\"]]\n"),
            "problem:13: collision.except: the robot does not move 'forearm_link' and 'forearm_link'",
        ),
        (
            format!("{auto}[[collision.capsule]]\nframe = \"tool\"\nradius = 0.1\n"),
            "problem:14: collision.capsule.frame: there is no frame 'tool'; did you mean 'tool0'",
        ),
        (
            "[[obstacle]]\nname = \"shelf\"\nkind = \"box\"\nxyz = [0, 0, 5]\nsize = [1, 1, 1]\n\
             [[collision.capsule]]\nframe = \"tool0\"\nradius = 0\n"
                .into(),
            "problem:15: collision.margin: 'tool0' and 'shelf' have neither a radius nor a margin",
        ),
        // In the way at the start.
        (
            format!(
                "[[obstacle]]\nname = \"wall\"\nkind = \"half_space\"\nxyz = [0, 0, 9]\nnormal = [0, 0, 1]\n{auto}"
            ),
            "problem:3: start.q: the clearance of '",
        ),
    ] {
        let error = read(&format!("{TOP}{text}")).unwrap_err();
        assert!(error.starts_with(message), "{error}\n{message}");
    }
}
