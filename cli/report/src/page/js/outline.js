// Draws the stage without WebGL2: triangles are projected and painted from far to near.

const makePainter = (canvas) => {
  const context = canvas.getContext("2d");
  const upload = (shape) => ({ shape, count: shape.indices.length });
  const project = (seen, x) => {
    const row = (k) => seen[k] * x[0] + seen[4 + k] * x[1] + seen[8 + k] * x[2] + seen[12 + k];
    const w = row(3);
    return w > 1e-6 ? [(0.5 + 0.5 * row(0) / w) * canvas.width, (0.5 - 0.5 * row(1) / w) * canvas.height, w] : null;
  };
  const css = (values, alpha) => `rgba(${values.map((x) => Math.round(255 * Math.min(1, Math.max(0, x)))).join()},${alpha})`;

  const lines = (frame) => {
    context.strokeStyle = css(frame.colours.grid.slice(0, 3), 0.35);
    const half = Math.ceil(0.5 * frame.reach / frame.spacing);
    const centre = frame.centre.map((x) => Math.round(x / frame.spacing));
    context.beginPath();
    for (let k = -half; k <= half; k++) {
      for (const axis of [0, 1]) {
        const end = (side) => {
          const x = [0, 0, frame.floor];
          x[axis] = (centre[axis] + k) * frame.spacing;
          x[1 - axis] = (centre[1 - axis] + side * half) * frame.spacing;
          return project(frame.seen, x);
        };
        const [from, to] = [end(-1), end(1)];
        if (from && to) { context.moveTo(from[0], from[1]); context.lineTo(to[0], to[1]); }
      }
    }
    context.stroke();
  };

  const draw = (frame) => {
    context.fillStyle = css(frame.colours.background, 1);
    context.fillRect(0, 0, canvas.width, canvas.height);
    if (frame.hasGrid) lines(frame);
    const triangles = [];
    for (const item of frame.items) {
      const { positions, indices } = item.geometry.shape;
      const m = item.model;
      const move = [0, 1, 2].map((k) => (x) => m[k] * x[0] + m[4 + k] * x[1] + m[8 + k] * x[2] + m[12 + k]);
      const end = item.to === undefined ? indices.length : item.to;
      for (let k = item.from || 0; k < end; k += 3) {
        const corners = [0, 1, 2].map((j) => {
          const x = positions.slice(3 * indices[k + j], 3 * indices[k + j] + 3);
          return move.map((row) => row(x));
        });
        const seen = corners.map((x) => project(frame.seen, x));
        if (seen.includes(null)) continue;
        const normal = unit(cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
        const light = item.unlit ? 1 : 0.45 + 0.55 * Math.abs(dot(normal, frame.colours.key));
        triangles.push({ seen, away: seen[0][2] + seen[1][2] + seen[2][2], item, light });
      }
    }
    triangles.sort((a, b) => b.away - a.away).forEach(({ seen, item, light }) => {
      context.fillStyle = css(item.colour.slice(0, 3).map((x) => x * light), item.colour[3]);
      context.beginPath();
      seen.forEach(([x, y], k) => (k === 0 ? context.moveTo(x, y) : context.lineTo(x, y)));
      context.fill();
    });
  };
  return { upload, draw, name: "2D" };
};
