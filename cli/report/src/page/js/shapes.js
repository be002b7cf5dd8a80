// Triangles of bodies: positions, normals and indices.

const makeShape = () => ({ positions: [], normals: [], indices: [] });

const appendShape = (shape, other, move = stillPlacement) => {
  const first = shape.positions.length / 3;
  for (let k = 0; k < other.positions.length; k += 3) {
    shape.positions.push(...placed(move, other.positions.slice(k, k + 3)));
    shape.normals.push(...turned(move, other.normals.slice(k, k + 3)));
  }
  other.indices.forEach((index) => shape.indices.push(first + index));
  return shape;
};

// A surface of revolution about z, from a profile of [radius, height, normal's radius, normal's height].
const revolved = (profile, around = 32) => {
  const shape = makeShape();
  for (let k = 0; k <= around; k++) {
    const [s, c] = [Math.sin(2 * Math.PI * k / around), Math.cos(2 * Math.PI * k / around)];
    profile.forEach(([r, h, nr, nh]) => {
      shape.positions.push(r * c, r * s, h);
      shape.normals.push(nr * c, nr * s, nh);
    });
  }
  const rows = profile.length;
  for (let k = 0; k < around; k++) {
    for (let j = 0; j + 1 < rows; j++) {
      const a = k * rows + j;
      shape.indices.push(a, a + rows, a + 1, a + 1, a + rows, a + rows + 1);
    }
  }
  return shape;
};

const arc = (radius, centre, from, to, steps) => Array.from({ length: steps + 1 }, (_, k) => {
  const angle = from + (to - from) * k / steps;
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  return [radius * c, centre + radius * s, c, s];
});

// From z = 0 to z = length.
const capsuleShape = (radius, length) => revolved(
  [...arc(radius, 0, -Math.PI / 2, 0, 8), ...arc(radius, length, 0, Math.PI / 2, 8)]);
const sphereShape = (radius) => revolved(arc(radius, 0, -Math.PI / 2, Math.PI / 2, 16));
// About the origin, with a bevel that catches light.
const cylinderShape = (radius, length) => {
  const [h, bevel] = [length / 2, Math.min(0.08 * radius, 0.1 * length)];
  return revolved([[0, -h, 0, -1], [radius - bevel, -h, 0, -1], ...arc(bevel, bevel - h, -Math.PI / 2, 0, 3)
    .map(([r, z, nr, nz]) => [r + radius - bevel, z, nr, nz]), ...arc(bevel, h - bevel, 0, Math.PI / 2, 3)
    .map(([r, z, nr, nz]) => [r + radius - bevel, z, nr, nz]), [radius - bevel, h, 0, 1], [0, h, 0, 1]]);
};
const coneShape = (radius, length) => {
  const slope = Math.hypot(radius, length);
  return revolved([[0, 0, 0, -1], [radius, 0, 0, -1], [radius, 0, length / slope, radius / slope],
    [0, length, length / slope, radius / slope]]);
};
const boxShape = (size) => {
  const shape = makeShape();
  for (let axis = 0; axis < 3; axis++) {
    for (const side of [-1, 1]) {
      const first = shape.positions.length / 3;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const [position, normal] = [[0, 0, 0], [0, 0, 0]];
        position[axis] = side * size[axis] / 2;
        position[u] = a * size[u] / 2;
        position[v] = b * size[v] / 2;
        normal[axis] = side;
        shape.positions.push(...position);
        shape.normals.push(...normal);
      }
      const order = side > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      order.forEach((k) => shape.indices.push(first + k));
    }
  }
  return shape;
};
const arrowShape = (length, radius) => {
  const shape = makeShape();
  appendShape(shape, cylinderShape(radius, 0.78 * length), alongZ([0, 0, 1], [0, 0, 0.39 * length]));
  return appendShape(shape, coneShape(2.4 * radius, 0.22 * length), alongZ([0, 0, 1], [0, 0, 0.78 * length]));
};

// A tube through points; its indices come in the order of the points.
const tubeShape = (points, radius, around = 8) => {
  const shape = makeShape();
  let side = [1, 0, 0];
  points.forEach((point, k) => {
    const ahead = minus(points[Math.min(k + 1, points.length - 1)], points[Math.max(k - 1, 0)]);
    const along = norm(ahead) > 0 ? unit(ahead) : [0, 0, 1];
    let across = minus(side, times3(along, dot(side, along)));
    if (norm(across) < 1e-3) across = cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0]);
    side = unit(across);
    const other = cross(along, side);
    for (let j = 0; j < around; j++) {
      const angle = 2 * Math.PI * j / around;
      const normal = add(times3(side, Math.cos(angle)), times3(other, Math.sin(angle)));
      shape.positions.push(...add(point, times3(normal, radius)));
      shape.normals.push(...normal);
    }
  });
  for (let k = 0; k + 1 < points.length; k++) {
    for (let j = 0; j < around; j++) {
      const [a, b] = [k * around + j, k * around + (j + 1) % around];
      shape.indices.push(a, b, a + around, b, b + around, a + around);
    }
  }
  return shape;
};
