//! Bodies from the collision models of a URDF: the key `collision.capsules = "urdf"`.

use costate::robot::{LoadOptions, Robot};
use costate_control::{ProblemFile, Solver, Status};
use std::path::PathBuf;

/// A rod of 1 m on a hinge about z, with the collision model of a rod, and its pedestal.
const ARM: &str = r#"<robot name="arm">
  <link name="base">
    <collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision>
  </link>
  <link name="rod">
    <inertial>
      <origin xyz="0.5 0 0"/><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
    <collision>
      <origin xyz="0.5 0 0" rpy="0 1.5707963267948966 0"/>
      <geometry><cylinder radius="0.1" length="1"/></geometry>
    </collision>
  </link>
  <joint name="hinge" type="continuous">
    <parent link="base"/><child link="rod"/><axis xyz="0 0 1"/>
  </joint>
</robot>
"#;

fn problem(more: &str) -> String {
    format!(
        "robot = \"arm.urdf\"\nstart.q = [0.0]\nend.q = [1.0]\ntime.final = 1.0\ncost.effort = [1.0]\n{more}"
    )
}

/// A folder with the URDF.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, urdf: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("arm.urdf"), urdf).unwrap();
        Self(folder)
    }

    fn read(&self, more: &str) -> Result<ProblemFile, String> {
        let found = ProblemFile::from_text(&problem(more), &self.0, LoadOptions::default());
        found.map_err(|error| error.to_string())
    }
}

const BESIDE: &str = "[[obstacle]]\nkind = \"sphere\"\nname = \"ball\"\nradius = 0.1\n";

/// The rod stops where its model touches a ball: at the angle whose sine is the sum of the radii over the
/// distance, before the ball that the rod would else end in.
#[test]
fn a_motion_keeps_the_models_of_a_urdf_away_from_obstacles() {
    let folder = Folder::new("urdf_bodies", ARM);
    let distance = 0.5_f64;
    // With the margin the rod ends exactly where it touches.
    let touching = 1.0 + ((0.1 + 0.1 + 0.02) / distance).asin();
    let ball = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        format!(
            "{BESIDE}xyz = [{}, {}, 0.0]\n[collision]\ncapsules = \"urdf\"\nmargin = 0.02\n",
            distance * cos,
            distance * sin
        )
    };
    let file = folder.read(&ball(touching + 1e-6)).unwrap();
    let bodies = &file.problem.task.collision.as_ref().unwrap().capsules;
    assert_eq!(bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>(), ["base", "rod"]);
    let found = Solver::new(&file.problem, file.options.clone()).unwrap().solve();
    assert_eq!(found.motion.status, Status::Converged);
    // The same ball a little nearer, and the end is beyond it.
    let message = folder.read(&ball(touching - 1e-6)).unwrap_err();
    assert!(message.contains("clearance of 'rod' from 'ball'"), "{message}");
}

/// A link with bodies of its own keeps these alone.
#[test]
fn listed_bodies_replace_the_models_of_their_link() {
    let folder = Folder::new(
        "urdf_bodies_listed",
        &ARM.replace("<box size=\"0.4 0.4 0.2\"/>", "<mesh filename=\"a.stl\"/>"),
    );
    let urdf = format!("{BESIDE}xyz = [3, 0, 0]\n[collision]\ncapsules = \"urdf\"\n");
    let message = folder.read(&urdf).unwrap_err();
    for words in ["collision.capsules", "link 'base'", "line 3", "mesh a.stl", "[[collision.capsule]]"] {
        assert!(message.contains(words), "{message}");
    }
    let listed = format!("{urdf}[[collision.capsule]]\nframe = \"base\"\nradius = 0.3\n");
    let file = folder.read(&listed).unwrap();
    let bodies = file.problem.task.collision.unwrap().capsules;
    let radii: Vec<_> = bodies.iter().map(|body| (body.name.as_str(), body.radius)).collect();
    assert_eq!(radii, [("base", 0.3), ("rod", 0.1)]);
}

#[test]
fn a_robot_without_a_urdf_and_a_radius_are_refused() {
    let folder = Folder::new("urdf_bodies_refused", ARM);
    let urdf = format!("{BESIDE}xyz = [3, 0, 0]\n[collision]\ncapsules = \"urdf\"\n");
    let message = folder.read(&format!("{urdf}radius = 0.1\n")).unwrap_err();
    assert!(message.contains("collision.radius") && message.contains("auto"), "{message}");
    let robot = Robot::from_urdf_str(ARM, LoadOptions::default()).unwrap();
    let text = problem(&urdf);
    let message = ProblemFile::for_robot(&text, &robot, "").unwrap_err().to_string();
    assert!(message.contains("not read from a URDF") && message.contains("problem:12"), "{message}");
    let file = ProblemFile::for_robot_of_urdf(&text, &robot, Some(ARM), "").unwrap();
    assert_eq!(file.problem.task.collision.unwrap().capsules.len(), 2);
    let toml = text.replace("arm.urdf", "two_link.toml").replace("[0.0]", "[0.0, 0.0]");
    let toml = toml.replace("[1.0]", "[1.0, 1.0]");
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../robots");
    let message = ProblemFile::from_text(&toml, robots, LoadOptions::default()).unwrap_err().to_string();
    assert!(message.contains("not read from a URDF"), "{message}");
}
