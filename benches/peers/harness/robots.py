"""The robots of the comparison: a URDF, what Pinocchio makes of it as text, and random states."""

from dataclasses import dataclass
from pathlib import Path

import chains
import describe

FILES = {name: f"robots/{name}.urdf" for name in ("ur5", "panda", "humanoid32", "humanoid50")}
CHAINS = {"chain12": 12, "chain24": 24, "chain48": 48}
ALL = ("ur5", "panda", *CHAINS, "humanoid32", "humanoid50")


@dataclass
class Prepared:
    name: str
    n: int
    folder: Path
    urdf: Path
    model: Path
    states: Path


def prepare(root, cache, name, count, seed):
    """Writes everything both sides read into a folder of its own."""
    folder = cache / name
    folder.mkdir(parents=True, exist_ok=True)
    urdf, model, states = (folder / f"{name}.{end}" for end in ("urdf", "model", "states"))
    urdf.write_text((root / FILES[name]).read_text() if name in FILES else chains.chain(CHAINS[name]))
    robot = describe.Robot(urdf)
    model.write_text(robot.text())
    states.write_text(robot.states(count, seed))
    return Prepared(name, robot.n, folder, urdf, model, states)
