// Draws the stage with WebGL2; null where a browser does not have it.

const makeRenderer = (canvas) => {
  const gl = canvas.getContext("webgl2", { antialias: true, stencil: true, alpha: false, powerPreference: "low-power" });
  if (!gl) return null;
  const compile = (vertex, fragment, names) => {
    const program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program) || "no program");
    return { program, at: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(program, name)])) };
  };
  const body = compile(BODY_VERTEX, BODY_FRAGMENT,
    ["seen", "model", "colour", "eye", "key", "sky", "ground", "shine", "lit"]);
  const grid = compile(GRID_VERTEX, GRID_FRAGMENT, ["seen", "square", "colour", "spacing"]);

  const upload = (shape) => {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    [shape.positions, shape.normals].forEach((values, location) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, 3, gl.FLOAT, false, 0, 0);
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array(shape.indices), gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return { array, count: shape.indices.length };
  };

  const drawItem = (item, model) => {
    const { array, count } = item.geometry;
    const [from, to] = [item.from || 0, item.to === undefined ? count : item.to];
    if (to <= from) return;
    gl.uniformMatrix4fv(body.at.model, false, model || item.model);
    gl.bindVertexArray(array);
    gl.drawElements(gl.TRIANGLES, to - from, gl.UNSIGNED_INT, 4 * from);
  };
  const drawLit = (item) => {
    gl.uniform4fv(body.at.colour, item.colour);
    gl.uniform1f(body.at.shine, item.shine === undefined ? 1 : item.shine);
    gl.uniform1f(body.at.lit, item.unlit ? 0 : 1);
    drawItem(item);
  };

  const drawGrid = (frame) => {
    gl.useProgram(grid.program);
    gl.uniformMatrix4fv(grid.at.seen, false, frame.seen);
    gl.uniform4fv(grid.at.square, [frame.centre[0], frame.centre[1], frame.floor, frame.reach]);
    gl.uniform4fv(grid.at.colour, frame.colours.grid);
    gl.uniform1f(grid.at.spacing, frame.spacing);
    gl.bindVertexArray(null);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
    gl.depthMask(true);
  };

  // Bodies pressed onto the floor along the light; the stencil keeps shadows from adding up.
  const drawShadows = (frame, items) => {
    const [x, y, z] = frame.colours.key;
    const h = frame.floor + 0.002 * frame.reach / 10;
    const onto = [1, 0, 0, 0, 0, 1, 0, 0, -x / z, -y / z, 0, 0, h * x / z, h * y / z, h, 1];
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.depthMask(false);
    gl.uniform4fv(body.at.colour, frame.colours.shadow);
    gl.uniform1f(body.at.lit, 0);
    items.forEach((item) => drawItem(item, product(onto, item.model)));
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
  };

  // Draws a frame: seen (projection and view), eye, items, floor, colours.
  const draw = (frame) => {
    const { colours } = frame;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...colours.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    const solid = frame.items.filter((item) => item.colour[3] >= 1);
    const ghosts = frame.items.filter((item) => item.colour[3] < 1 && item.ghost);
    const glass = frame.items.filter((item) => item.colour[3] < 1 && !item.ghost);
    if (frame.hasGrid) drawGrid(frame);
    gl.useProgram(body.program);
    gl.uniformMatrix4fv(body.at.seen, false, frame.seen);
    gl.uniform3fv(body.at.eye, frame.eye);
    gl.uniform3fv(body.at.key, colours.key);
    gl.uniform3fv(body.at.sky, colours.sky);
    gl.uniform3fv(body.at.ground, colours.ground);
    if (frame.hasGrid && frame.eye[2] > frame.floor) drawShadows(frame, solid.filter((item) => !item.flat));
    solid.forEach(drawLit);
    // Only the nearest surface of a ghost is seen, and the robot itself where both are in one place.
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 6);
    for (const name of new Set(ghosts.map((item) => item.ghost))) {
      const parts = ghosts.filter((item) => item.ghost === name);
      gl.colorMask(false, false, false, false);
      parts.forEach((item) => drawItem(item));
      gl.colorMask(true, true, true, true);
      parts.forEach(drawLit);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.depthMask(false);
    const away = (item) => norm(minus(item.model.slice(12, 15), frame.eye));
    glass.sort((a, b) => away(b) - away(a)).forEach(drawLit);
    gl.depthMask(true);
    gl.bindVertexArray(null);
  };
  return { upload, draw, name: "WebGL2" };
};
