"""Serial chains with general axes, written as URDF: the same file every time.

Joints are "revolute" with wide limits: Pinocchio gives a "continuous" one two coordinates, cos q and sin q.
"""

import math
import random


def numbers(values):
    return " ".join(f"{value:.6f}" for value in values)


def direction(rng):
    while True:
        axis = [rng.uniform(-1, 1) for _ in range(3)]
        length = math.sqrt(sum(a * a for a in axis))
        if 0.1 < length <= 1:
            return [a / length for a in axis]


def inertia(rng):
    """Inertia about the centre of mass of three point pairs on random axes: positive definite, never flat."""
    sizes = [rng.uniform(0.02, 0.1) for _ in range(3)]
    axes = [direction(rng) for _ in range(3)]
    matrix = [[0.0] * 3 for _ in range(3)]
    for size, axis in zip(sizes, axes):
        for i in range(3):
            for j in range(3):
                matrix[i][j] += size * ((i == j) - axis[i] * axis[j])
    return matrix


def chain(n, seed=1):
    """The URDF of a chain of n revolute joints with random axes, placements and inertias."""
    rng = random.Random(1000 * seed + n)
    lines = ['<?xml version="1.0"?>', f'<robot name="chain{n}">', '  <link name="link0"/>']
    for i in range(1, n + 1):
        mass = rng.uniform(0.5, 2.0)
        centre = [rng.uniform(-0.1, 0.1) for _ in range(3)]
        j = inertia(rng)
        j = [[mass * entry for entry in row] for row in j]
        lines += [
            f'  <link name="link{i}">',
            "    <inertial>",
            f'      <origin xyz="{numbers(centre)}" rpy="0 0 0"/>',
            f'      <mass value="{mass:.6f}"/>',
            f'      <inertia ixx="{j[0][0]:.8f}" ixy="{j[0][1]:.8f}" ixz="{j[0][2]:.8f}" '
            f'iyy="{j[1][1]:.8f}" iyz="{j[1][2]:.8f}" izz="{j[2][2]:.8f}"/>',
            "    </inertial>",
            "  </link>",
        ]
    for i in range(1, n + 1):
        axis = direction(rng)
        xyz = [rng.uniform(-0.3, 0.3) for _ in range(3)]
        rpy = [rng.uniform(-math.pi, math.pi) for _ in range(3)]
        lines += [
            f'  <joint name="joint{i}" type="revolute">',
            f'    <parent link="link{i - 1}"/>',
            f'    <child link="link{i}"/>',
            f'    <origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>',
            f'    <axis xyz="{" ".join(f"{a:.17g}" for a in axis)}"/>',
            '    <limit lower="-10" upper="10" velocity="10" effort="1000"/>',
            "  </joint>",
        ]
    return "\n".join(lines + ["</robot>", ""])
