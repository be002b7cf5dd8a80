// Time: play, loop, steps, keys. Everything that depends on it listens.

const makePlayer = () => {
  const listeners = [];
  const duration = endTime - startTime;
  const [play, slider, speed, loop] = ["play", "slider", "speed", "loop"].map(element);
  let time = startTime;
  let request = null;
  let last = null;

  const show = () => {
    slider.value = Math.round(1000 * (time - startTime) / duration);
    const phases = data.vias.length + 1;
    const phase = data.vias.filter((via) => via <= time).length + 1;
    element("clock").textContent = `${time.toFixed(duration < 1 ? 4 : 3)} s`;
    slider.setAttribute("aria-valuetext", element("clock").textContent);
    const load = stageData.payloads.filter((payload) => time >= payload.from && time < payload.to)
      .reduce((sum, payload) => sum + payload.mass, 0);
    element("phase").textContent = phases > 1
      ? `phase ${phase} of ${phases}${load > 0 ? `, carries ${short(load, 3)} kg` : ""}` : "";
    listeners.forEach((listener) => listener(time));
  };
  const set = (value) => {
    time = Math.min(endTime, Math.max(startTime, value));
    show();
  };
  const mark = () => {
    const isPlaying = request !== null;
    play.textContent = isPlaying ? "Pause" : "Play";
    play.setAttribute("aria-label", isPlaying ? "pause" : "play");
    play.classList.toggle("playing", isPlaying);
  };
  const stop = () => {
    if (request !== null) cancelAnimationFrame(request);
    request = null;
    mark();
  };
  // The clock starts at the first frame: its time can be earlier than that of the click.
  const step = (now) => {
    let next = time + (last === null ? 0 : Math.max(0, now - last) / 1000 * Number(speed.value));
    last = now;
    const ended = next >= endTime;
    if (ended && loops()) next = startTime + (next - endTime) % duration;
    set(next);
    if (ended && !loops()) stop();
    else request = requestAnimationFrame(step);
  };
  const start = () => {
    if (request !== null) return;
    if (time >= endTime) set(startTime);
    last = null;
    request = requestAnimationFrame(step);
    mark();
  };
  const toggle = () => (request !== null ? stop() : start());
  const loops = () => loop.getAttribute("aria-pressed") === "true";
  const nudge = (parts) => { stop(); set(time + parts * duration / 100); };

  // Real time, unless that is too fast or too slow to follow.
  const speeds = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 5, 10];
  const watched = speeds.filter((s) => duration / s >= 1.5 || s === speeds[0]);
  const chosen = duration > 15 ? watched[watched.length - 1] : Math.min(1, watched[watched.length - 1]);
  speeds.forEach((s) => speed.add(new Option(`${s}×`, s, s === chosen, s === chosen)));

  play.addEventListener("click", toggle);
  loop.addEventListener("click", () => loop.setAttribute("aria-pressed", String(!loops())));
  element("back").addEventListener("click", () => nudge(-1));
  element("forward").addEventListener("click", () => nudge(1));
  slider.addEventListener("input", () => { stop(); set(startTime + duration * slider.value / 1000); });
  document.addEventListener("keydown", (event) => {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const on = event.target instanceof Element ? event.target.closest("input, select, button, summary, a, textarea") : null;
    const keys = {
      " ": toggle,
      ArrowLeft: () => nudge(event.shiftKey ? -10 : -1),
      ArrowRight: () => nudge(event.shiftKey ? 10 : 1),
      Home: () => { stop(); set(startTime); },
      End: () => { stop(); set(endTime); },
    };
    // A button that has the focus keeps the space bar, a slider and a list keep the arrows.
    const taken = on && (event.key === " " ? on.tagName !== "INPUT" : on.tagName === "SELECT");
    if (!keys[event.key] || taken) return;
    event.preventDefault();
    keys[event.key]();
  });
  // Beginnings of phases, and times with a payload, on the track of the slider.
  const track = element("track");
  const place = (mark, from, to) => {
    const part = (t) => (t - startTime) / duration;
    mark.style.setProperty("--from", part(from));
    mark.style.setProperty("--to", part(to));
  };
  stageData.payloads.forEach((payload) => place(create(track, "i", { class: "load" }), payload.from, payload.to));
  data.vias.forEach((via) => place(create(track, "i", { class: "via" }), via, via));
  mark();
  return {
    set: (value) => { stop(); set(value); },
    show,
    time: () => time,
    isPlaying: () => request !== null,
    listen: (listener) => listeners.push(listener),
  };
};
