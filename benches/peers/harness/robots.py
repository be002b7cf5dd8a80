"""The robots of the comparison: a URDF, what Pinocchio makes of it as text, and random states."""

from dataclasses import dataclass
from pathlib import Path

import chains
import describe
import feet

FILES = {name: f"robots/{name}.urdf" for name in ("ur5", "panda", "humanoid32", "humanoid50")}
CHAINS = {"chain12": 12, "chain24": 24, "chain48": 48}
FIXED = ("ur5", "panda", *CHAINS, "humanoid32", "humanoid50")

# The humanoids on a floating joint, in the air and on both feet: their pelvis, which is the base of the files, has mass
# here.
FLOATING = {"floating32": "humanoid32", "floating50": "humanoid50"}
STANDING = {"standing32": "humanoid32", "standing50": "humanoid50"}
FREE = (*FLOATING, *STANDING)
PELVIS = """<link name="world"/>
  <joint name="root" type="floating">
    <parent link="world"/>
    <child link="pelvis"/>
  </joint>
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
    text = (root / FILES[base or name]).read_text()
    return text.replace('<link name="pelvis"/>', PELVIS) if base else text


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
