
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const frames = data.frames;
  if (frames.length < 2) return;
  const duration = data.time > 0 ? data.time : 1;
  document.documentElement.classList.add("scripted");
  const make = (parent, tag, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    return parent.appendChild(element);
  };

  const stages = [...document.querySelectorAll("svg.stage")].map((svg, k) => {
    const stage = Object.assign({ svg }, data.stages[k]);
    const group = svg.querySelector(".moving");
    stage.lines = data.lines.map(([, , part]) => make(group, "line", { class: part }));
    stage.joints = data.joints.map(([, kind]) => kind === "revolute"
      ? make(group, "circle", { r: 4 }) : make(group, "rect", { width: 12, height: 9 }));
    return stage;
  });

  // Sets the right and up directions of a view from its azimuth and elevation.
  const orient = (stage) => {
    const [sa, ca] = [Math.sin(stage.view[0]), Math.cos(stage.view[0])];
    const [se, ce] = [Math.sin(stage.view[1]), Math.cos(stage.view[1])];
    stage.right = [ca, sa, 0];
    stage.up = [-sa * se, ca * se, ce];
  };
  const place = (stage, x, y, z) => {
    const { right, up, scale, origin, centre } = stage;
    const [a, b, c] = [x - centre[0], y - centre[1], z - centre[2]];
    return [origin[0] + scale * (right[0] * a + right[1] * b + right[2] * c),
      origin[1] - scale * (up[0] * a + up[1] * b + up[2] * c)];
  };

  // The part of the motion that has passed, from 0 to 1.
  let phase = 0;
  const set = (value) => { phase = Math.min(1, Math.max(0, value)); };
  const coordinates = () => {
    const at = phase * (frames.length - 1);
    const before = Math.max(0, Math.min(Math.floor(at), frames.length - 2));
    return frames[before].map((x, k) => x + (at - before) * (frames[before + 1][k] - x));
  };
  const draw = (stage, points) => {
    const at = (i) => place(stage, points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    stage.lines.forEach((line, k) => {
      const [[x1, y1], [x2, y2]] = [at(data.lines[k][0]), at(data.lines[k][1])];
      line.setAttribute("x1", x1); line.setAttribute("y1", y1);
      line.setAttribute("x2", x2); line.setAttribute("y2", y2);
    });
    stage.joints.forEach((mark, k) => {
      const [x, y] = at(data.joints[k][0]);
      if (mark.tagName === "circle") { mark.setAttribute("cx", x); mark.setAttribute("cy", y); }
      else { mark.setAttribute("x", x - 6); mark.setAttribute("y", y - 4.5); }
    });
  };

  const scenery = (stage) => {
    orient(stage);
    const traces = data.tips.map((tip) => "M" + frames.map((f) =>
      place(stage, f[3 * tip], f[3 * tip + 1], f[3 * tip + 2]).map((v) => v.toFixed(1)).join(" ")).join("L"));
    stage.svg.querySelector(".trace").setAttribute("d", traces.join(""));
    const triad = stage.svg.querySelector(".triad");
    triad.replaceChildren();
    const length = 40 / stage.scale;
    const [x0, y0] = place(stage, 0, 0, 0);
    [["x", length, 0, 0], ["y", 0, length, 0], ["z", 0, 0, length]].forEach(([name, a, b, c]) => {
      const [x, y] = place(stage, a, b, c);
      make(triad, "path", { d: `M${x0} ${y0}L${x} ${y}` });
      make(triad, "text", { x: x + 0.22 * (x - x0) - 3, y: y + 0.22 * (y - y0) + 4 }).textContent = name;
    });
  };
  stages.filter((stage) => stage.view).forEach((stage) => {
    let from = null;
    scenery(stage);
    stage.svg.addEventListener("pointerdown", (event) => {
      from = [event.clientX, event.clientY, ...stage.view];
      stage.svg.setPointerCapture(event.pointerId);
    });
    stage.svg.addEventListener("pointermove", (event) => {
      if (!from) return;
      const elevation = from[3] + 0.008 * (event.clientY - from[1]);
      stage.view = [from[2] - 0.008 * (event.clientX - from[0]), Math.max(-1.57, Math.min(1.57, elevation))];
      scenery(stage);
      draw(stage, coordinates());
    });
    stage.svg.addEventListener("pointerup", () => { from = null; });
    stage.svg.addEventListener("pointercancel", () => { from = null; });
  });

  const cursors = [...document.querySelectorAll("svg[data-time]")].map((svg) => {
    const [start, end, left, right, top, bottom] = svg.dataset.time.split(" ").map(Number);
    const line = make(svg, "line", { class: "cursor", y1: top, y2: bottom });
    return (time) => {
      const x = left + (right - left) * (time - start) / (end - start || 1);
      line.setAttribute("x1", x); line.setAttribute("x2", x);
    };
  });

  const [play, slider, clock, speed] =
    ["play", "slider", "clock", "speed"].map((id) => document.getElementById(id));
  const show = () => {
    const points = coordinates();
    stages.forEach((stage) => draw(stage, points));
    cursors.forEach((move) => move(phase * duration));
    slider.value = phase;
    clock.textContent = `${(phase * duration).toPrecision(4)} s`;
  };
  // Real time, unless that is too fast or too slow to follow.
  const speeds = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10];
  const watched = speeds.filter((s) => duration / s >= 1.5 || s === speeds[0]);
  const chosen = duration > 15 ? watched[watched.length - 1] : Math.min(1, watched[watched.length - 1]);
  speeds.forEach((s) => speed.add(new Option(s + "\u00d7", s, s === chosen, s === chosen)));
  // The next animation frame while the motion plays, and the time of the last one. The clock starts at the
  // first frame: its time can be earlier than that of the click.
  let request = null;
  let last = null;
  const step = (now) => {
    if (last !== null) set(phase + Math.max(0, now - last) / 1000 * speed.value / duration);
    last = now;
    show();
    if (phase < 1) request = requestAnimationFrame(step);
    else stop();
  };
  const stop = () => {
    if (request !== null) cancelAnimationFrame(request);
    request = null;
    play.textContent = "Play";
  };
  play.addEventListener("click", () => {
    if (request !== null) return stop();
    if (phase >= 1) set(0);
    last = null;
    play.textContent = "Pause";
    request = requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => { stop(); set(Number(slider.value)); show(); });
  // The address can name a part of the motion, such as #0.4.
  const address = Number(location.hash.slice(1));
  if (address >= 0 && address <= 1) set(address);
  show();
})();
