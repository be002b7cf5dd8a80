// Vectors, placements and projections. A placement has twelve numbers: a rotation, column by column, and a
// translation; a projection is a 4 x 4 matrix, column by column.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times3 = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => times3(a, 1 / (norm(a) || 1));

const stillPlacement = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];
const turned = (m, x) => [0, 1, 2].map((k) => m[k] * x[0] + m[3 + k] * x[1] + m[6 + k] * x[2]);
const placed = (m, x) => add(turned(m, x), m.slice(9));
const then = (outer, inner) => [0, 3, 6].flatMap((k) => turned(outer, inner.slice(k, k + 3)))
  .concat(placed(outer, inner.slice(9)));

// A rotation about a unit axis, by Rodrigues' formula.
const rotation = ([x, y, z], angle) => {
  const [s, c] = [Math.sin(angle), Math.cos(angle)];
  const k = 1 - c;
  return [c + x * x * k, y * x * k + z * s, z * x * k - y * s, x * y * k - z * s, c + y * y * k,
    z * y * k + x * s, x * z * k + y * s, y * z * k - x * s, c + z * z * k, 0, 0, 0];
};

// The rotation of a quaternion x, y, z, w of any length.
const turnOf = ([x, y, z, w]) => {
  const s = 2 / (x * x + y * y + z * z + w * w);
  return [1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), s * (x * y - z * w),
    1 - s * (x * x + z * z), s * (y * z + x * w), s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y), 0, 0, 0];
};

// A placement whose z axis has this direction.
const alongZ = (direction, origin) => {
  const z = unit(direction);
  const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [0, 1, 0], z));
  return [...x, ...cross(z, x), ...z, ...origin];
};

const matrixOf = (m, [x, y, z] = [1, 1, 1]) => [m[0] * x, m[1] * x, m[2] * x, 0, m[3] * y, m[4] * y, m[5] * y, 0,
  m[6] * z, m[7] * z, m[8] * z, 0, m[9], m[10], m[11], 1];
const product = (a, b) => {
  const out = new Array(16).fill(0);
  for (let column = 0; column < 4; column++)
    for (let row = 0; row < 4; row++)
      for (let k = 0; k < 4; k++) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return out;
};

const perspective = (angle, aspect, near, far) => {
  const f = 1 / Math.tan(angle / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
};

// The view from `eye` along the axes right, up and back.
const viewOf = (eye, right, up, back) => [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0,
  right[2], up[2], back[2], 0, -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
