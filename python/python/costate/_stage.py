"""What the stage of a report shows, for other viewers: bodies in frames of joints, obstacles, as shapes or triangles."""

from __future__ import annotations

import base64
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    _Array = NDArray[np.float64]
    _Triangles = tuple[_Array, NDArray[np.uint32]]

_SIDES = 28  # Of a circle.


@dataclass(frozen=True)
class Body:
    """A part of a link, or an obstacle.

    Attributes
    ----------
    joint : int or None
        The joint that moves it, in the order of ``Robot.all_joint_names``; None for the world.
    rotation, position : array (3, 3), (3)
        Its axes and origin in the frame of that joint.
    shape : dict
        ``kind`` and its sizes (m).
    colour : list of float or None
        Red, green, blue and opacity, from 0 to 1.
    """

    joint: int | None
    rotation: _Array
    position: _Array
    shape: dict[str, Any]
    colour: list[float] | None


class Stage:
    """Bodies of the robot and obstacles, from the JSON object of the stage."""

    def __init__(self, text: str) -> None:
        found = json.loads(text)
        self.bodies = [_body(each) for each in found["bodies"]]
        self.obstacles = [_body(each) for each in found["obstacles"]]
        self._meshes: list[dict[str, Any]] = found["meshes"]

    def triangles(self, shape: dict[str, Any], reach: float = 1.0) -> _Triangles | None:
        """Vertices (k, 3) and triangles (m, 3) of a shape; of a plane as far as twice the reach (m) about the origin."""
        kind = shape["kind"]
        if kind == "mesh":
            return _mesh(self._meshes[shape["mesh"]], shape["scale"])
        if kind == "cylinder":
            half = shape["length"] / 2
            return turned([(0.0, -half), (shape["radius"], -half), (shape["radius"], half), (0.0, half)])
        if kind == "sphere":
            return _capsule(0.0, shape["radius"])
        if kind == "capsule":
            start, end = np.array(shape["from"]), np.array(shape["to"])
            vertices, faces = _capsule(float(np.linalg.norm(end - start)), shape["radius"])
            return vertices @ _turned_to(end - start).T + (start + end) / 2, faces
        if kind == "box":
            corners = np.array(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [-0.5, 0.5], indexing="ij")).reshape(3, 8).T
            sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
            halves = [part for a, b, c, d in sides for part in ((a, b, c), (a, c, d))]
            return corners * np.array(shape["size"]), np.array(halves, dtype=np.uint32)
        if kind == "plane":
            normal, through = np.array(shape["normal"], float), np.array(shape["through"], float)
            normal = normal / np.linalg.norm(normal)
            # About the place of the plane that is nearest to the origin.
            square = 2 * reach * np.array([(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)])
            return square @ _turned_to(normal).T + (through @ normal) * normal, np.array([(0, 1, 2), (0, 2, 3)], dtype=np.uint32)
        return None


def _body(given: dict[str, Any]) -> Body:
    at = np.array(given["at"])
    return Body(given.get("joint"), at[:9].reshape(3, 3).T, at[9:], given["shape"], given.get("colour"))


def _mesh(mesh: dict[str, Any], scale: list[float]) -> _Triangles:
    """A mesh of a file: its vertices lie on a grid of 2^16 steps between two corners."""
    grid = np.frombuffer(base64.b64decode(mesh["vertices"]), dtype="<u2").reshape(-1, 3)
    faces = np.frombuffer(base64.b64decode(mesh["triangles"]), dtype="<u4").reshape(-1, 3)
    low, high = np.array(mesh["low"]), np.array(mesh["high"])
    if np.prod(scale) < 0:
        faces = faces[:, ::-1]
    return (low + (high - low) * grid / 65535) * np.array(scale), np.ascontiguousarray(faces, dtype=np.uint32)


def _capsule(length: float, radius: float) -> _Triangles:
    """A capsule along z about the origin."""
    angles = np.linspace(0, np.pi / 2, _SIDES // 4 + 1)
    below = [(radius * np.sin(a), -length / 2 - radius * np.cos(a)) for a in angles]
    above = [(radius * np.cos(a), length / 2 + radius * np.sin(a)) for a in angles]
    return turned(below + above)


def turned(profile: list[tuple[float, float]]) -> _Triangles:
    """A profile of points (distance from the axis, z), from below, turned about z."""
    angles = 2 * np.pi * np.arange(_SIDES) / _SIDES
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [np.column_stack([r * circle, np.full(_SIDES, z)]) for r, z in profile]
    k, next_ = np.arange(_SIDES), (np.arange(_SIDES) + 1) % _SIDES
    faces = []
    for ring in range(len(profile) - 1):
        low, high = ring * _SIDES, (ring + 1) * _SIDES
        faces += [np.stack([low + k, low + next_, high + next_], axis=1), np.stack([low + k, high + next_, high + k], axis=1)]
    return np.concatenate(rings), np.concatenate(faces).astype(np.uint32)


def _turned_to(direction: _Array) -> _Array:
    """A rotation that takes z to a direction."""
    length = np.linalg.norm(direction)
    if length == 0:
        return np.eye(3)
    z = direction / length
    other = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(other, z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)
