"""The robots of the comparison, as `costate info` describes them."""

import functools
import json
import math
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

from shell import stop

# Inertia of rotors and gears seen at the joints (kg m^2): of the usual size for arms of this kind, of no data sheet.
UR5_ARMATURE = {"shoulder_pan_joint": 2.0, "shoulder_lift_joint": 2.0, "elbow_joint": 1.0, "wrist_1_joint": 0.3,
                "wrist_2_joint": 0.3, "wrist_3_joint": 0.3}
PANDA_ARMATURE = {f"panda_joint{i + 1}": value for i, value in enumerate((0.6, 0.6, 0.5, 0.5, 0.2, 0.2, 0.2))}
# The same of a biped's joints.
BIPED_ARMATURE = {f"{leg}_{joint}": value for leg in ("stance", "swing") for joint, value in (
    ("ankle_roll", 0.1), ("ankle_pitch", 0.1), ("knee", 0.2), ("hip_yaw", 0.2), ("hip_roll", 0.2), ("hip_pitch", 0.2))}


@dataclass(frozen=True)
class Source:
    """A file, what is changed in it, and the frame that tasks in space are about: a joint and a point in its frame (m)."""
    file: str
    tool: tuple
    armature: dict = field(default_factory=dict)
    # Whether torques have bounds in every class.
    bounded: bool = False


SOURCES = {
    "two_link": Source("robots/two_link.toml", ("elbow", (1.0, 0.0, 0.0))),
    "manutec_r3": Source("robots/manutec_r3.toml", ("elbow", (0.98, 0.0, 0.0))),
    "puma560": Source("robots/puma560.toml", ("flange", (0.0, 0.0, 0.1))),
    "ur5": Source("robots/ur5.urdf", ("wrist_3_joint", (0.0, 0.0, 0.1))),
    "panda": Source("robots/panda.urdf", ("panda_joint7", (0.0, 0.0, 0.2))),
    "ur5_armature": Source("robots/ur5.urdf", ("wrist_3_joint", (0.0, 0.0, 0.1)), UR5_ARMATURE),
    "panda_armature": Source("robots/panda.urdf", ("panda_joint7", (0.0, 0.0, 0.2)), PANDA_ARMATURE),
    "biped_armature": Source("robots/biped.toml", ("swing_ankle_roll", (0.15, 0.0, -0.067899)), BIPED_ARMATURE),
    # Without rotors and bounds its foot whirls round, which neither side resolves.
    "biped": Source("robots/biped.toml", ("swing_ankle_roll", (0.15, 0.0, -0.067899)), bounded=True),
    # Of the reference values only.
    "pendulum": Source("robots/pendulum.toml", ("pivot", (0.0, 0.0, -1.0))),
}
# Those that tasks are spread over.
ALL = tuple(name for name in SOURCES if name != "pendulum")


@dataclass
class Robot:
    name: str
    source: Source
    path: Path
    gravity: list
    joints: list
    couplings: list

    @property
    def n(self):
        return len(self.joints)

    def index(self, joint):
        return [row["name"] for row in self.joints].index(joint)

    def limits(self, key):
        """A list with a number for each joint; the missing ones are infinite."""
        missing = -math.inf if key == "lower" else math.inf
        return [missing if row["limits"][key] is None else row["limits"][key] for row in self.joints]

    def flags(self):
        """What the other commands of costate need to see the same robot."""
        return [f"--armature={joint}={value}" for joint, value in self.source.armature.items()]


@functools.cache
def read(root, costate, name):
    source = SOURCES[name]
    path = root / source.file
    robot = Robot(name, source, path, [], [], [])
    done = subprocess.run([costate, "info", "--json", *robot.flags(), path], capture_output=True, text=True, check=False)
    if done.returncode:
        stop(f"costate cannot read {source.file}: {done.stderr.strip()}")
    found = json.loads(done.stdout)
    robot.gravity, robot.joints, robot.couplings = found["gravity"], found["joints"], found["armature_couplings"]
    known = ("revolute", "continuous", "prismatic")
    unknown = [row["name"] for row in robot.joints if row["mimic"] or row["type"] not in known]
    if unknown:
        stop(f"{name}: the model of the peer has no joints such as {unknown[0]}")
    return robot
