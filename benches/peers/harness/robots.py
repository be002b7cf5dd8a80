"""The robots of the comparison: a URDF, what Pinocchio makes of it as text, and random states."""

import re
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import chains
import describe
import feet
import pinocchio

# TALOS as its maker describes it (PAL Robotics, CC BY-NC-ND 3.0) comes with the package example-robot-data.
TALOS = "share/example-robot-data/robots/talos_data/robots/talos_reduced.urdf"
FILES = {name: f"robots/{name}.urdf" for name in ("ur5", "panda", "humanoid32", "humanoid50")}
CHAINS = {"chain12": 12, "chain24": 24, "chain48": 48}
FIXED = ("ur5", "panda", *CHAINS, "humanoid32", "humanoid50", "talos")

# The humanoids on a floating joint, in the air and on both feet: their pelvis, which is the base of the files, has mass
# here.
FLOATING = {"floating32": "humanoid32", "floating50": "humanoid50", "floating_talos": "talos"}
STANDING = {"standing32": "humanoid32", "standing50": "humanoid50"}
FREE = (*FLOATING, *STANDING)
ROOT = """<link name="world"/>
  <joint name="root" type="floating">
    <parent link="world"/>
    <child link="{base}"/>
  </joint>"""
PELVIS = f"""{ROOT.format(base="pelvis")}
  <link name="pelvis">
    <inertial>
      <origin xyz="0.01 0 0.02" rpy="0 0 0"/>
      <mass value="7"/>
      <inertia ixx="0.0508667" ixy="0" ixz="0" iyy="0.0263667" iyz="0" izz="0.0543667"/>
    </inertial>
  </link>"""


@dataclass
class Prepared:
    name: str
    nq: int
    n: int
    stands: bool
    folder: Path
    urdf: Path
    model: Path
    states: Path


def text_of(root, name):
    """The URDF."""
    if name in CHAINS:
        return chains.chain(CHAINS[name])
    base = {**FLOATING, **STANDING}.get(name)
    if "talos" in (base, name):
        text = sorted_as_pinocchio(Path(pinocchio.__file__).resolve().parents[4] / TALOS)
        # After the tag of the robot.
        return re.sub(r"(<robot\b[^>]*>)", rf"\1{ROOT.format(base='base_link')}", text, count=1) if base else text
    text = (root / FILES[base or name]).read_text()
    return text.replace('<link name="pelvis"/>', PELVIS) if base else text


def sorted_as_pinocchio(path):
    """A URDF with its joints depth first and by name, which is Pinocchio's order of coordinates."""
    tree = ElementTree.parse(path)
    robot, joints = tree.getroot(), {}
    for joint in robot.findall("joint"):
        joints.setdefault(joint.find("parent").get("link"), []).append(joint)
        robot.remove(joint)

    def append(link):
        for joint in sorted(joints.get(link, ()), key=lambda joint: joint.get("name")):
            robot.append(joint)
            append(joint.find("child").get("link"))

    children = {joint.find("child").get("link") for some in joints.values() for joint in some}
    append(next(link.get("name") for link in robot.findall("link") if link.get("name") not in children))
    return ElementTree.tostring(robot, encoding="unicode")


def prepare(root, cache, name, count, seed):
    """Writes everything both sides read into a folder of its own."""
    folder = cache / name
    folder.mkdir(parents=True, exist_ok=True)
    urdf, model, states = (folder / f"{name}.{end}" for end in ("urdf", "model", "states"))
    urdf.write_text(text_of(root, name))
    robot = describe.Robot(urdf, feet.LINKS if name in STANDING else ())
    model.write_text(robot.text())
    urdf.with_suffix(".stance").write_text(robot.stance())
    states.write_text(robot.states(count, seed))
    return Prepared(name, robot.nq, robot.n, name in STANDING, folder, urdf, model, states)
