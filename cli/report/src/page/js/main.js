// Puts the page together.

const main = () => {
  const canvas = element("canvas");
  const scene = makeScene();
  const player = makePlayer();
  let renderer = makeRenderer(canvas);
  if (!renderer) {
    renderer = makePainter(canvas);
    element("hint").textContent = "WebGL2 is not available in this browser: a plainer picture is drawn. " + element("hint").textContent;
  }
  scene.reset(renderer);

  let waiting = null;
  const changed = () => {
    if (waiting === null) waiting = requestAnimationFrame(render);
  };
  const camera = makeCamera(canvas, scene.bounds, changed);
  const [spacing] = ticksOf(0, scene.bounds.radius, 5).slice(1);

  const render = () => {
    waiting = null;
    const sharpness = Math.min(2, window.devicePixelRatio || 1);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((x) => Math.max(1, Math.round(sharpness * x)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const { eye, seen } = camera.frame();
    const dark = colour("--is-dark") === "1";
    renderer.draw({
      eye,
      seen,
      items: scene.items(player.time()),
      centre: [scene.bounds.centre[0], scene.bounds.centre[1]],
      floor: scene.bounds.floor,
      reach: 9 * scene.bounds.radius,
      spacing,
      hasGrid: !scene.layers.grid || scene.layers.grid.on,
      colours: {
        background: rgb(colour("--stage")),
        grid: [...rgb(colour("--stage-grid")), 0.9],
        shadow: [0, 0, 0, dark ? 0.35 : 0.14],
        key: unit([0.45, -0.35, 0.85]),
        sky: dark ? [0.26, 0.29, 0.34] : [0.42, 0.45, 0.5],
        ground: dark ? [0.1, 0.1, 0.11] : [0.24, 0.22, 0.2],
      },
    });
    label(seen);
  };

  // Names over the picture, in their places.
  const names = element("labels");
  const label = (seen) => {
    const wanted = scene.labels(player.time());
    while (names.childElementCount < wanted.length) create(names, "span");
    [...names.children].forEach((span, k) => {
      const [text, x] = wanted[k] || ["", [0, 0, 0]];
      const row = (j) => seen[j] * x[0] + seen[4 + j] * x[1] + seen[8 + j] * x[2] + seen[12 + j];
      const w = row(3);
      span.hidden = text === "" || w <= 0;
      if (span.hidden) return;
      if (span.textContent !== text) span.textContent = text;
      const [a, b] = [(0.5 + 0.5 * row(0) / w) * canvas.clientWidth, (0.5 - 0.5 * row(1) / w) * canvas.clientHeight];
      span.style.transform = `translate(${a.toFixed(1)}px, ${b.toFixed(1)}px)`;
    });
  };

  player.listen(changed);
  const plots = makePlots(player);
  makeControls(scene, camera, plots, changed);
  new ResizeObserver(() => camera.resized()).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { changed(); plots.refresh(); });
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => location.reload());
  // The address can name a part of the motion, such as #0.4.
  const address = Number(location.hash.slice(1));
  if (location.hash !== "" && address >= 0 && address <= 1) player.set(startTime + address * (endTime - startTime));
  player.show();
  // For pages that embed this one: what is shown, and the pose of each joint at a time.
  window.costateReport = {
    renderer: renderer.name,
    time: player.time,
    setTime: player.set,
    isPlaying: player.isPlaying,
    view: camera.view,
    poses: (time) => posesAt(positionsAt(time)),
    table,
  };
};
main();
