// The camera: it orbits about a target with z upwards, zooms and pans; presets are reached smoothly.

const PRESETS = {
  perspective: [-0.9, 0.42],
  front: [-Math.PI / 2, 0],
  side: [0, 0],
  top: [-Math.PI / 2, Math.PI / 2 - 1e-4],
};
const ANGLE = 0.62;

const makeCamera = (canvas, bounds, changed) => {
  const centre = bounds.centre;
  const aspect = () => canvas.clientWidth / Math.max(1, canvas.clientHeight);
  const axesOf = (azimuth, elevation) => {
    const [sa, ca] = [Math.sin(azimuth), Math.cos(azimuth)];
    const [se, ce] = [Math.sin(elevation), Math.cos(elevation)];
    const back = [ca * ce, sa * ce, se];
    return { back, right: [-sa, ca, 0], up: [-ca * se, -sa * se, ce] };
  };
  // The distance from which the box around everything fills the picture, but for a margin.
  const fitting = ([azimuth, elevation]) => {
    const { back, right, up } = axesOf(azimuth, elevation);
    const slope = Math.tan(ANGLE / 2) / 1.04;
    const needed = bounds.corners.map((corner) => {
      const x = minus(corner, centre);
      return dot(x, back) + Math.max(Math.abs(dot(x, right)) / aspect(), Math.abs(dot(x, up))) / slope;
    });
    return { azimuth, elevation, distance: Math.max(...needed), target: centre };
  };
  let view = fitting(PRESETS.perspective);
  let moving = null;

  const axes = () => axesOf(view.azimuth, view.elevation);
  const frame = () => {
    const { back, right, up } = axes();
    const eye = add(view.target, times3(back, view.distance));
    const [near, end] = [0.02 * view.distance, view.distance + 30 * bounds.radius];
    return { eye, right, up, seen: product(perspective(ANGLE, aspect(), near, end), viewOf(eye, right, up, back)) };
  };

  const set = (next) => {
    if (moving) cancelAnimationFrame(moving);
    moving = null;
    view = { ...view, ...next };
    view.elevation = Math.max(-1.5, Math.min(Math.PI / 2 - 1e-4, view.elevation));
    view.distance = Math.max(0.05 * bounds.radius, Math.min(40 * bounds.radius, view.distance));
    changed();
  };
  const glide = (goal) => {
    if (moving) cancelAnimationFrame(moving);
    const from = view;
    const turn = Math.atan2(Math.sin(goal.azimuth - from.azimuth), Math.cos(goal.azimuth - from.azimuth));
    let begun = null;
    const step = (now) => {
      if (begun === null) begun = now;
      const x = Math.min(1, (now - begun) / 350);
      const s = x * x * (3 - 2 * x);
      set({
        azimuth: from.azimuth + s * turn,
        elevation: from.elevation + s * (goal.elevation - from.elevation),
        distance: from.distance * Math.pow(goal.distance / from.distance, s),
        target: add(from.target, times3(minus(goal.target, from.target), s)),
      });
      if (x < 1) moving = requestAnimationFrame(step);
    };
    moving = requestAnimationFrame(step);
  };
  const preset = (name) => glide(fitting(PRESETS[name]));

  const orbit = (x, y) => set({ azimuth: view.azimuth - 0.008 * x, elevation: view.elevation + 0.008 * y });
  const pan = (x, y) => {
    const { right, up } = axes();
    const scale = 2 * Math.tan(ANGLE / 2) * view.distance / Math.max(1, canvas.clientHeight);
    set({ target: add(view.target, add(times3(right, -x * scale), times3(up, y * scale))) });
  };
  const zoom = (factor) => set({ distance: view.distance * factor });

  // One finger or the left button orbits; two fingers, the right button or Shift pan; the wheel and two fingers zoom.
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return { middle: [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], width: Math.hypot(a[0] - b[0], a[1] - b[1]) };
  };
  canvas.addEventListener("pointerdown", (event) => {
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
    canvas.classList.add("held");
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = pointers.size === 2 ? spread() : null;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    const [x, y] = [event.clientX - last[0], event.clientY - last[1]];
    if (before) {
      const now = spread();
      if (now.width > 0) zoom(before.width / now.width);
      pan(now.middle[0] - before.middle[0], now.middle[1] - before.middle[1]);
    } else if (event.shiftKey || event.buttons === 2 || event.buttons === 4) pan(x, y);
    else orbit(x, y);
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => {
      pointers.delete(event.pointerId);
      canvas.classList.remove("held");
    });
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(0.0012 * Math.max(-200, Math.min(200, event.deltaY))));
  }, { passive: false });
  return { frame, preset, orbit, pan, zoom, view: () => view, resized: () => set({}) };
};
