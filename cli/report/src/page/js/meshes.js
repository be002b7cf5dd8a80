// Meshes of files: decoded, with normals that keep sharp edges.

const bytesOf = (text) => {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k++) bytes[k] = letters.charCodeAt(k);
  return bytes.buffer;
};

// Cosine of the angle between triangles beyond which an edge is sharp.
const SHARP = Math.cos(35 * Math.PI / 180);

const meshShapes = stageData.meshes.map((mesh) => {
  const grid = new Uint16Array(bytesOf(mesh.vertices));
  const triangles = new Uint32Array(bytesOf(mesh.triangles));
  const vertices = new Float32Array(grid.length);
  for (let k = 0; k < grid.length; k++) {
    const axis = k % 3;
    vertices[k] = mesh.low[axis] + (mesh.high[axis] - mesh.low[axis]) * grid[k] / 65535;
  }
  return { vertices, triangles };
});

// The mesh with other units along its axes: each corner has the mean normal of the triangles around it that are
// nearly parallel to its own.
const meshShape = (number, scale) => {
  const { vertices, triangles } = meshShapes[number];
  const mirrored = scale[0] * scale[1] * scale[2] < 0;
  const at = (index) => [0, 1, 2].map((k) => vertices[3 * index + k] * scale[k]);
  const count = triangles.length / 3;
  const faces = [];
  const around = Array.from({ length: vertices.length / 3 }, () => []);
  for (let face = 0; face < count; face++) {
    const corners = [0, 1, 2].map((k) => triangles[3 * face + k]);
    const [a, b, c] = corners.map(at);
    const area = cross(minus(b, a), minus(c, a));
    faces.push({ area: mirrored ? times3(area, -1) : area, normal: unit(mirrored ? times3(area, -1) : area) });
    corners.forEach((corner) => around[corner].push(face));
  }
  const shape = makeShape();
  for (let face = 0; face < count; face++) {
    for (let k = 0; k < 3; k++) {
      const corner = triangles[3 * face + k];
      let sum = [0, 0, 0];
      for (const other of around[corner])
        if (dot(faces[other].normal, faces[face].normal) > SHARP) sum = add(sum, faces[other].area);
      shape.positions.push(...at(corner));
      shape.normals.push(...(norm(sum) > 0 ? unit(sum) : faces[face].normal));
      shape.indices.push(3 * face + k);
    }
  }
  return shape;
};

// The triangles of any body of the stage.
const shapeOf = (body) => {
  if (body.kind === "box") return boxShape(body.size);
  if (body.kind === "sphere") return sphereShape(body.radius);
  if (body.kind === "cylinder") return cylinderShape(body.radius, body.length);
  if (body.kind === "mesh") return meshShape(body.mesh, body.scale);
  const along = minus(body.to, body.from);
  if (norm(along) < 1e-9) return appendShape(makeShape(), sphereShape(body.radius), [...stillPlacement.slice(0, 9), ...body.from]);
  return appendShape(makeShape(), capsuleShape(body.radius, norm(along)), alongZ(along, body.from));
};
