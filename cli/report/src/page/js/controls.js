// Buttons: views, layers, units, downloads.

const makeControls = (scene, camera, plots, changed) => {
  const group = element("layers");
  Object.values(scene.layers).forEach((layer) => {
    const button = create(group, "button", { type: "button", "aria-pressed": String(layer.on) }, layer.label);
    button.addEventListener("click", () => {
      layer.on = !layer.on;
      button.setAttribute("aria-pressed", String(layer.on));
      changed();
    });
  });
  document.querySelectorAll("[data-preset]").forEach((button) =>
    button.addEventListener("click", () => camera.preset(button.dataset.preset)));
  const full = element("full");
  full.hidden = !document.fullscreenEnabled;
  full.addEventListener("click", () =>
    (document.fullscreenElement ? document.exitFullscreen() : element("view").requestFullscreen()));

  const unit = element("units");
  unit.hidden = !data.joints.some((joint) => joint.kind === "revolute");
  unit.addEventListener("click", () => {
    units.degrees = !units.degrees;
    unit.textContent = units.degrees ? "deg" : "rad";
    unit.setAttribute("aria-pressed", String(units.degrees));
    plots.refresh();
  });

  const save = (text, kind, name) => {
    const link = create(null, "a", { href: URL.createObjectURL(new Blob([text], { type: kind })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  element("csv").addEventListener("click", () => save(table(), "text/csv", `${data.stem}.csv`));
  element("json").addEventListener("click", () =>
    save(element("solution").textContent, "application/json", `${data.stem}.json`));
};

// One line for each time: t, then all quantities of the joints, in rad and SI units; the phase, from 1.
const table = () => {
  const field = (text) => (/[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const columns = [["t", times]];
  const rows = (symbol, lists) => lists.forEach(([name, list]) => columns.push([field(`${symbol}_${name}`), list]));
  const drawn = (id) => (plotNamed(id) ? plotNamed(id).curves.map((curve) => [curve.name, curve.y]) : []);
  for (const [symbol, id] of [["q", "positions"], ["v", "rates"], ["a", "accelerations"]]) rows(symbol, drawn(id));
  rows("tau", data.table.tau.map((list, j) => [data.joints[j].name, list]).filter(([, list]) => list.length > 0));
  for (const [symbol, id] of [["u", "controls"], ["power", "powers"], ["jerk", "jerks"], ["torque_rate", "torque_rates"]])
    rows(symbol, drawn(id));
  if (data.vias.length > 0) columns.push(["phase", times.map((t) => data.vias.filter((via) => via <= t).length + 1)]);
  const line = (k) => columns.map(([, list]) => (list[k] === null || list[k] === undefined ? "" : list[k])).join();
  return `${columns.map(([name]) => name).join()}\n${times.map((_, k) => line(k)).join("\n")}\n`;
};
