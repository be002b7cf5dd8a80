// What stands on the stage at a time: the robot, ghosts of its start and end, paths, payloads, obstacles.

const makeScene = () => {
  const tools = stageData.tools;
  const paths = tools.map((tool) => toolPath(tool, pathTimes));
  const statics = stageData.obstacles.filter((obstacle) => obstacle.shape.kind !== "plane");
  const shapes = new Map();
  const shapeFor = (shape) => {
    const key = JSON.stringify(shape);
    if (!shapes.has(key)) shapes.set(key, shapeOf(shape));
    return shapes.get(key);
  };

  // The box around everything along the motion.
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  const include = (x) => x.forEach((value, k) => {
    low[k] = Math.min(low[k], value);
    high[k] = Math.max(high[k], value);
  });
  const corners = (positions) => {
    const box = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (let k = 0; k < positions.length; k++) {
      box[0][k % 3] = Math.min(box[0][k % 3], positions[k]);
      box[1][k % 3] = Math.max(box[1][k % 3], positions[k]);
    }
    return Array.from({ length: 8 }, (_, k) => [box[k & 1][0], box[k >> 1 & 1][1], box[k >> 2][2]]);
  };
  const boxes = stageData.bodies.map((body) => corners(shapeFor(body.shape).positions));
  for (let k = 0; k <= 24; k++) {
    const poses = posesAt(positionsAt(startTime + (endTime - startTime) * k / 24));
    poses.forEach((pose) => include(pose.slice(9)));
    stageData.bodies.forEach((body, b) => {
      const pose = then(carriedBy(poses, body.joint), body.at);
      boxes[b].forEach((corner) => include(placed(pose, corner)));
    });
  }
  paths.forEach((path) => path.forEach(include));
  include([0, 0, 0]);
  const robotSize = norm(minus(high, low)) || 1;
  statics.forEach((obstacle) => corners(shapeFor(obstacle.shape).positions)
    .forEach((corner) => include(placed(obstacle.at, corner))));
  const bounds = {
    centre: times3(add(low, high), 0.5),
    radius: Math.max(1e-6, norm(minus(high, low)) / 2),
    corners: Array.from({ length: 8 }, (_, k) => [[low, high][k & 1][0], [low, high][k >> 1 & 1][1], [low, high][k >> 2][2]]),
    floor: low[2] > -0.02 * robotSize ? Math.min(0, low[2]) : low[2],
  };
  const size = 0.5 * robotSize;

  // Layers that can be switched off; those without anything are not offered.
  const isCapsule = (body) => body.shape.kind === "capsule";
  const layers = {
    path: { label: "Path", on: paths.length > 0, has: paths.length > 0 },
    ghosts: { label: "Start, end", on: true, has: true },
    obstacles: { label: "Obstacles", on: true, has: stageData.obstacles.length > 0 },
    regions: { label: "Where tools stay", on: true, has: stageData.regions.length > 0 },
    axes: { label: "Joint axes", on: false, has: true },
    frames: { label: "Frames", on: true, has: true },
    payload: { label: "Payload", on: true, has: stageData.payloads.length > 0 },
    grid: { label: "Grid", on: true, has: true },
  };
  Object.keys(layers).forEach((name) => { if (!layers[name].has) delete layers[name]; });
  const shows = (name) => layers[name] !== undefined && layers[name].on;

  let upload = null;
  const uploads = new Map();
  const geometry = (key, make) => {
    if (!uploads.has(key)) uploads.set(key, upload(make()));
    return uploads.get(key);
  };
  const ofShape = (shape) => geometry(JSON.stringify(shape), () => shapeFor(shape));
  const reset = (renderer) => { upload = renderer.upload; uploads.clear(); };

  const isLink = (body) => body.link !== "rail" && body.link !== "sole";
  const capsuleOf = joints.map((_, j) => stageData.bodies.find((body) => body.joint === j && isCapsule(body) && isLink(body)));
  const hasModel = joints.map((_, j) => stageData.bodies.some((body) => body.joint === j && !isCapsule(body) && isLink(body)));
  const robotItems = (poses, paint, more = {}) => {
    const items = stageData.bodies.map((body) => ({
      geometry: ofShape(body.shape),
      model: matrixOf(then(carriedBy(poses, body.joint), body.at)),
      colour: paint(body.colour),
      ...more,
    }));
    // A hub or a slide at each joint of a link without a model, in the colour of its curves.
    joints.forEach((joint, j) => {
      if (joint.free || hasModel[j] || (!capsuleOf[j] && joint.massless)) return;
      const above = joint.parent === null ? undefined : capsuleOf[joint.parent];
      const r = 1.18 * Math.max(0.012 * robotSize, ...[capsuleOf[j], above].filter((body) => body).map((body) => body.shape.radius));
      const hub = joint.kind === "revolute" ? { kind: "cylinder", radius: r, length: (joint.parent !== null && joints[joint.parent].kind === "prismatic" ? 3.8 : 2.3) * r }
        : { kind: "box", size: [3 * r, 3 * r, 3 * r] };
      const tint = more.ghost ? paint(null) : [...rgb(colour(`--c${joint.number % 12}`)), 1];
      items.push({ geometry: ofShape(hub), model: matrixOf(then(poses[j], alongZ(joint.axis, [0, 0, 0]))), colour: tint, ...more });
    });
    return items;
  };

  const triad = (pose, length) => [0, 1, 2].map((k) => ({
    geometry: geometry("axis", () => arrowShape(0.16 * size, 0.006 * size)),
    model: matrixOf(alongZ(pose.slice(3 * k, 3 * k + 3), pose.slice(9)), [length, length, length]),
    colour: [...[[0.85, 0.2, 0.2], [0.15, 0.6, 0.2], [0.15, 0.35, 0.9]][k], 1],
    flat: true,
  }));
  const ball = (at, radius, tint) => ({
    geometry: ofShape({ kind: "sphere", radius }), model: matrixOf([...stillPlacement.slice(0, 9), ...at]), colour: tint, flat: true,
  });

  const payloadPose = (payload, time) => {
    const poses = posesAt(positionsAt(Math.min(payload.to, Math.max(payload.from, time))));
    return then(carriedBy(poses, payload.joint), payload.at);
  };

  const glassItems = (list, tint) => list.map((obstacle) => {
    if (obstacle.shape.kind !== "plane")
      return { geometry: ofShape(obstacle.shape), model: matrixOf(obstacle.at), colour: tint, shine: 0.4 };
    // The part of the plane near the robot.
    const normal = unit(obstacle.shape.normal);
    const nearest = minus(bounds.centre, times3(normal, dot(minus(bounds.centre, obstacle.shape.through), normal)));
    const side = 1.8 * bounds.radius;
    const shape = { kind: "box", size: [side, side, 0.002 * side] };
    return { geometry: ofShape(shape), model: matrixOf(alongZ(normal, nearest)), colour: [...tint.slice(0, 3), 0.16], shine: 0.1 };
  });

  const items = (time) => {
    const poses = posesAt(positionsAt(time));
    const [metal, accent] = [rgb(colour("--metal")), rgb(colour("--accent"))];
    const all = robotItems(poses, (own) => (own ? [...own.slice(0, 3), Math.max(own[3], 0.999) ] : [...metal, 1]));
    all.forEach((item) => { if (item.colour[3] >= 0.99) item.colour[3] = 1; });
    if (shows("ghosts")) {
      [[startTime, "--c0", "start"], [endTime, "--c1", "end"]].forEach(([at, name, ghost]) => {
        if (Math.abs(time - at) < 0.004 * (endTime - startTime)) return;
        const tint = [...rgb(colour(name)), 0.2];
        all.push(...robotItems(posesAt(positionsAt(at)), () => tint, { ghost, shine: 0.5 }));
      });
    }
    if (shows("path")) {
      paths.forEach((path, k) => {
        const tube = geometry(`path ${k}`, () => tubeShape(path, 0.006 * size));
        const passed = 48 * Math.round(pathTimes.length * (time - startTime) / (endTime - startTime));
        const still = { geometry: tube, model: matrixOf(stillPlacement), flat: true, shine: 0.3 };
        all.push({ ...still, colour: [...accent, 1], to: Math.min(passed, tube.count) });
        all.push({ ...still, colour: [...accent, 0.35], from: Math.min(passed, tube.count) });
        data.vias.forEach((via) => all.push(ball(toolPath(tools[k], [via])[0], 0.016 * size, [...accent, 1])));
      });
    }
    if (shows("frames")) {
      all.push(...triad(stillPlacement, 1.4));
      tools.forEach((tool) => all.push(...triad(then(carriedBy(poses, tool.joint), tool.at), 0.9)));
    }
    if (shows("axes")) {
      joints.forEach((joint, j) => {
        if (joint.free) return;
        const along = alongZ(turned(poses[j], joint.axis), minus(poses[j].slice(9), times3(turned(poses[j], joint.axis), 0.1 * size)));
        const arrow = geometry("joint axis", () => arrowShape(0.34 * size, 0.008 * size));
        all.push({ geometry: arrow, model: matrixOf(along), colour: [...rgb(colour(`--c${joint.number % 12}`)), 1], flat: true });
      });
    }
    if (shows("payload")) {
      stageData.payloads.forEach((payload) => {
        const carried = time >= payload.from && time < payload.to;
        const tint = [...rgb(colour("--load")), carried ? 1 : 0.45];
        all.push({ geometry: ofShape(payload.shape), model: matrixOf(payloadPose(payload, time)), colour: tint });
      });
    }
    if (shows("obstacles")) all.push(...glassItems(stageData.obstacles, [...rgb(colour("--obstacle")), 0.55]));
    if (shows("regions")) all.push(...glassItems(stageData.regions, [...rgb(colour("--c2")), 0.12]));
    return all;
  };

  // Names in the picture, with their places.
  const labels = (time) => {
    const named = [];
    if (shows("path") && paths.length > 0) {
      const [first, last] = [paths[0][0], paths[0][paths[0].length - 1]];
      if (norm(minus(last, first)) < 0.01 * size) named.push(["start, end", first]);
      else named.push(["start", first], ["end", last]);
      data.vias.forEach((via, k) => named.push([data.via_names[k], toolPath(tools[0], [via])[0]]));
    }
    if (shows("obstacles")) statics.forEach((obstacle) => named.push([obstacle.name, middle(obstacle)]));
    if (shows("payload")) stageData.payloads.forEach((payload) => named.push([`${short(payload.mass, 3)} kg`, payloadPose(payload, time).slice(9)]));
    return named;
  };
  const middle = (obstacle) => {
    const { from, to } = obstacle.shape;
    return from ? placed(obstacle.at, times3(add(from, to), 0.5)) : obstacle.at.slice(9);
  };
  return { bounds, layers, items, labels, reset };
};
