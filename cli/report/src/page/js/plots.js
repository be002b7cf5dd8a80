// Plots: values under the pointer, legends that hide curves, zoom, click to move the robot there.

const MARGIN = { left: 54, right: 12, top: 10, bottom: 26 };

const makePlots = (player) => {
  // What all plots share: the joints that are hidden, the part of the time that is shown, the time under the pointer.
  const shared = { hidden: new Set(), span: null, hover: null };
  const all = [];
  const refresh = () => all.forEach((plot) => plot.redraw());
  const toggleJoint = (number) => {
    if (!shared.hidden.delete(number)) shared.hidden.add(number);
    refresh();
    showJoints();
  };
  const showJoints = () => {
    const legend = element("joints");
    legend.replaceChildren();
    data.joints.forEach((joint, number) => {
      const chip = create(legend, "button", { type: "button", class: "chip", "aria-pressed": String(!shared.hidden.has(number)) }, joint.name);
      chip.style.setProperty("--chip", jointColour(number));
      chip.addEventListener("click", () => toggleJoint(number));
    });
    const reset = create(legend, "button", { type: "button", id: "whole", class: "chip plain" }, "Whole motion");
    reset.hidden = shared.span === null;
    reset.addEventListener("click", () => zoom(null));
  };
  const zoom = (span) => {
    shared.span = span;
    refresh();
    showJoints();
  };
  const hover = (time) => {
    shared.hover = time;
    all.forEach((plot) => plot.follow());
  };

  const make = (parent, plot) => {
    const figure = create(parent, "figure", { class: "plot", "data-plot": plot.id });
    const caption = create(figure, "figcaption");
    create(caption, "h3", {}, plot.title);
    const unit = create(caption, "span", { class: "unit" });
    const svg = draw(figure, "svg", { role: "img", "aria-label": plot.title, class: plot.overTime ? "timed" : "" });
    const legend = create(figure, "div", { class: plot.curves.length > 2 ? "legend" : "legend few" });
    const hiddenHere = new Set();
    const isHidden = (curve, k) => (plot.ofJoints ? shared.hidden.has(curve.color) : hiddenHere.has(k));
    const xs = (curve) => curve.x || times;
    const y = (curve, k) => (curve.y[k] === null ? null : curve.y[k] * factorOf(plot, curve.color));
    const height = 218;
    let scale = null;
    let cursor = null;
    let pointer = null;

    const chips = plot.curves.map((curve, k) => {
      const chip = create(legend, "button", { type: "button", class: "chip", title: curve.name });
      create(chip, "span", { class: "name" }, curve.name);
      const value = create(chip, "b");
      chip.style.setProperty("--chip", jointColour(curve.color));
      chip.addEventListener("click", () => {
        if (plot.ofJoints) return toggleJoint(curve.color);
        if (!hiddenHere.delete(k)) hiddenHere.add(k);
        redraw();
      });
      return { chip, value };
    });

    const limitValue = (limit, k) => (Array.isArray(limit.value) ? limit.value[k] : limit.value) * factorOf(plot, limit.color);
    const span = () => {
      if (plot.overTime) return shared.span || [startTime, endTime];
      const [low, high] = rangeOf(plot.curves.flatMap((curve) => xs(curve)));
      return [low, high];
    };

    // The limits of the curves that are shown, near enough not to flatten them. Where the limits of some joints
    // are shown, those of others are from farther away: a curve beyond the limit of another joint is seen to
    // have its own.
    const limitsNear = (shown, range) => {
      const near = limitsWithin(shown, range, 0.55);
      return near.length ? limitsWithin(shown, range, 1.6) : near;
    };
    const limitsWithin = (shown, [low, high], part) => plot.limits.filter((limit) => {
      if (!shown.some((curve) => curve.color === limit.color)) return false;
      const room = part * (high - low);
      const values = Array.isArray(limit.value) ? limit.value.map((_, k) => limitValue(limit, k)) : [limitValue(limit, 0)];
      return values.some((value) => value >= low - room && value <= high + room);
    });

    const pathOf = (curve, scale) => {
      const list = xs(curve);
      const [first, last] = [Math.max(0, interval(list, scale.from)), Math.min(list.length - 1, interval(list, scale.to) + 1)];
      let text = "";
      let open = false;
      for (let k = first; k <= last; k++) {
        const value = y(curve, k);
        const at = value === null ? NaN : scale.y(value);
        if (!Number.isFinite(at)) { open = false; continue; }
        text += `${open ? "L" : "M"}${scale.x(list[k]).toFixed(1)} ${at.toFixed(1)}`;
        open = true;
      }
      return text;
    };

    // The area between a curve and a limit that it is beyond; nothing where that is rounding.
    const beyond = (curve, limit, scale) => {
      const side = limit.upper ? 1 : -1;
      const excess = curve.y.map((_, k) => (y(curve, k) === null ? 0 : side * (y(curve, k) - limitValue(limit, k))));
      const most = excess.reduce((a, b) => Math.max(a, b), 0);
      if (most <= 1e-3 * Math.max(Math.abs(limitValue(limit, 0)), 1e-2 * (scale.high - scale.low))) return null;
      const list = xs(curve);
      const forth = excess.map((e, k) => [scale.x(list[k]), scale.y(e > 0 ? y(curve, k) : limitValue(limit, k))]);
      const back = excess.map((_, k) => [scale.x(list[k]), scale.y(limitValue(limit, k))]).reverse();
      return `M${forth.concat(back).map(([a, b]) => `${a.toFixed(1)} ${b.toFixed(1)}`).join("L")}Z`;
    };

    const axes = (group, scale, width) => {
      const bottom = height - MARGIN.bottom;
      ticksOf(scale.from, scale.to, (width - MARGIN.left - MARGIN.right) / 80).forEach((x) => {
        draw(group, "path", { class: "grid", d: `M${scale.x(x).toFixed(1)} ${MARGIN.top}V${bottom}` });
        draw(group, "text", { x: scale.x(x), y: bottom + 16, "text-anchor": "middle" }, short(x, 6));
      });
      const rows = plot.logarithmic ? decadesOf(scale.low, scale.high, 5) : ticksOf(scale.low, scale.high, 5);
      rows.forEach((row) => {
        const at = scale.row(row);
        draw(group, "path", { class: row === 0 && !plot.logarithmic ? "grid zero" : "grid", d: `M${MARGIN.left} ${at.toFixed(1)}H${width - MARGIN.right}` });
        draw(group, "text", { x: MARGIN.left - 6, y: at + 3.5, "text-anchor": "end" }, plot.logarithmic ? `1e${row}` : short(row, 5));
      });
      if (!plot.overTime) return;
      const marked = (list, kind) => list.filter((t) => t >= scale.from && t <= scale.to)
        .forEach((t) => draw(group, "path", { class: kind, d: `M${scale.x(t).toFixed(1)} ${MARGIN.top}V${bottom}` }));
      marked(data.switches, "switch");
      marked(data.vias, "phase");
    };

    const redraw = () => {
      const width = Math.max(220, svg.clientWidth || figure.clientWidth);
      svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
      svg.setAttribute("height", height);
      svg.replaceChildren();
      unit.textContent = plot.unit ? `${plot.symbol} in ${unitOf(plot)}` : plot.symbol;
      const shown = plot.curves.filter((curve, k) => !isHidden(curve, k));
      plot.curves.forEach((curve, k) => chips[k].chip.setAttribute("aria-pressed", String(!isHidden(curve, k))));
      const [from, to] = span();
      const place = plot.logarithmic ? (value) => (value > 0 ? Math.log10(value) : NaN) : (value) => value;
      const inside = shown.flatMap((curve) => curve.y.map((_, k) => (xs(curve)[k] >= from && xs(curve)[k] <= to ? y(curve, k) : null)));
      let [low, high] = rangeOf(inside.map((value) => (value === null ? null : place(value))));
      const limits = plot.logarithmic ? [] : limitsNear(shown, [low, high]);
      limits.filter((limit) => !Array.isArray(limit.value)).forEach((limit) => {
        const room = 0.03 * (high - low);
        low = Math.min(low, limitValue(limit, 0) - room);
        high = Math.max(high, limitValue(limit, 0) + room);
      });
      const bottom = height - MARGIN.bottom;
      const row = (value) => bottom - (bottom - MARGIN.top) * (value - low) / (high - low);
      scale = {
        from, to, low, high, row, width,
        x: (x) => MARGIN.left + (width - MARGIN.left - MARGIN.right) * (x - from) / (to - from || 1),
        y: (value) => row(place(value)),
        time: (x) => from + (to - from) * (x - MARGIN.left) / (width - MARGIN.left - MARGIN.right),
      };
      axes(draw(svg, "g"), scale, width);
      const clip = `clip-${plot.id}`;
      draw(draw(draw(svg, "defs"), "clipPath", { id: clip }), "rect",
        { x: MARGIN.left, y: MARGIN.top, width: width - MARGIN.left - MARGIN.right, height: bottom - MARGIN.top });
      const group = draw(svg, "g", { "clip-path": `url(#${clip})` });
      // The name of a limit at its right end, on its outer side unless the edge of the plot is there; to the left of
      // names at this height, and nowhere if there is no room.
      const named = [];
      const name = (words, at, isUpper) => {
        const [above, below] = [at - 4, at + 11];
        const baseline = isUpper ? (above < MARGIN.top + 8 ? below : above) : (below > bottom - 3 ? above : below);
        const beside = named.filter((other) => Math.abs(other.baseline - baseline) < 10).map((other) => other.start - 8);
        const end = Math.min(width - MARGIN.right - 4, ...beside);
        const text = draw(group, "text", { class: "whose", x: end, y: baseline, "text-anchor": "end" }, words);
        const start = end - text.getComputedTextLength();
        if (start < MARGIN.left + 4) text.remove(); else named.push({ baseline, start });
      };
      limits.forEach((limit, number) => {
        // Dashes of limits that lie on one another take turns, so that the colour of each joint is seen.
        const same = limits.map((other, k) => k).filter((k) => limits[k].kept === limit.kept
          && !Array.isArray(limit.value) && limitValue(limits[k], 0) === limitValue(limit, 0));
        const [dash, step] = limit.kept ? [6, 10] : [1.5, 5.5];
        const dashes = same.length < 2 ? ""
          : `;stroke-dasharray:${dash} ${step * same.length - dash};stroke-dashoffset:${-step * same.indexOf(number)}`;
        const curve = shown.find((each) => each.color === limit.color);
        const area = beyond(curve, limit, scale);
        if (area) draw(group, "path", { class: "beyond", d: area });
        const list = Array.isArray(limit.value) ? times.map((t, k) => [t, limitValue(limit, k)])
          : [[from, limitValue(limit, 0)], [to, limitValue(limit, 0)]];
        const d = `M${list.map(([t, value]) => `${scale.x(t).toFixed(1)} ${scale.y(value).toFixed(1)}`).join("L")}`;
        draw(group, "path", { class: limit.kept ? "limit kept" : "limit compared", d, style: `stroke:${jointColour(limit.color)}${dashes}` });
        // Whose limit it is: other curves may go beyond.
        if (same.length && same[0] === number && shown.length > same.length) {
          const others = same.length > 1 ? ` and ${same.length - 1} more` : "";
          name(`limit of ${curve.name}${others}`, scale.y(limitValue(limit, 0)), limit.upper);
        }
      });
      shown.forEach((curve) => {
        draw(group, "path", { class: "curve", d: pathOf(curve, scale), style: `stroke:${jointColour(curve.color)}` });
        if (!curve.dotted) return;
        // What a step did not compute has no dot.
        const known = curve.y.map((_, k) => k).filter((k) => y(curve, k) !== null && Number.isFinite(scale.y(y(curve, k))));
        known.forEach((k) => draw(group, "circle", { class: "dot", cx: scale.x(xs(curve)[k]), cy: scale.y(y(curve, k)), r: 2.2, style: `stroke:${jointColour(curve.color)}` }));
      });
      cursor = plot.overTime ? {
        now: draw(svg, "path", { class: "cursor" }),
        hover: draw(svg, "path", { class: "cursor hover" }),
        when: draw(svg, "text", { class: "when", y: MARGIN.top + 9 }),
        picked: draw(svg, "rect", { class: "picked", y: MARGIN.top, height: bottom - MARGIN.top, width: 0 }),
        dots: plot.curves.map((curve) => draw(svg, "circle", { class: "spot", r: 3, style: `fill:${jointColour(curve.color)}` })),
      } : null;
      follow();
    };

    // A value, with its unit where that is not the one of the whole plot.
    const valueText = (curve, value) => {
      const text = plot.logarithmic ? short(value, 3) : shortOn(value, scale.high - scale.low);
      const own = unitOfCurve(plot, curve.color);
      return own === unitOf(plot) ? text : `${text} ${own}`.trimEnd();
    };

    // The cursor, and the values there: at the time under the pointer, or else at that of the robot.
    const follow = () => {
      if (!scale || !cursor) return;
      const bottom = height - MARGIN.bottom;
      const line = (time) => (time !== null && time >= scale.from && time <= scale.to ? `M${scale.x(time).toFixed(1)} ${MARGIN.top}V${bottom}` : "");
      const time = shared.hover === null ? player.time() : shared.hover;
      cursor.now.setAttribute("d", line(player.time()));
      cursor.hover.setAttribute("d", line(shared.hover));
      cursor.when.textContent = shared.hover === null ? "" : `${short(time, 4)} s`;
      const late = scale.x(time) > scale.width - 70;
      cursor.when.setAttribute("x", scale.x(time) + (late ? -5 : 5));
      cursor.when.setAttribute("text-anchor", late ? "end" : "start");
      plot.curves.forEach((curve, k) => {
        const value = valueAt(xs(curve), curve.y, time);
        const scaled = value === null ? null : value * factorOf(plot, curve.color);
        chips[k].value.textContent = scaled === null ? "" : valueText(curve, scaled);
        const at = scaled === null || isHidden(curve, k) || time < scale.from || time > scale.to ? NaN : scale.y(scaled);
        const seen = Number.isFinite(at) && at >= MARGIN.top && at <= bottom;
        cursor.dots[k].setAttribute("visibility", seen ? "visible" : "hidden");
        if (seen) { cursor.dots[k].setAttribute("cx", scale.x(time)); cursor.dots[k].setAttribute("cy", at); }
      });
    };

    if (plot.overTime) {
      const timeAt = (event) => {
        const time = scale.time(event.clientX - svg.getBoundingClientRect().left);
        return Math.min(scale.to, Math.max(scale.from, time));
      };
      svg.addEventListener("pointerdown", (event) => {
        if (event.button !== 0) return;
        pointer = { x: event.clientX, time: timeAt(event), scrubs: event.pointerType === "touch" };
        svg.setPointerCapture(event.pointerId);
      });
      svg.addEventListener("pointermove", (event) => {
        const time = timeAt(event);
        if (pointer && pointer.scrubs) return player.set(time);
        hover(time);
        if (!pointer) return;
        const [a, b] = [scale.x(pointer.time), scale.x(time)].sort((p, q) => p - q);
        cursor.picked.setAttribute("x", a);
        cursor.picked.setAttribute("width", Math.abs(event.clientX - pointer.x) > 6 ? b - a : 0);
      });
      svg.addEventListener("pointerup", (event) => {
        if (!pointer) return;
        const [from, to] = [pointer.time, timeAt(event)].sort((p, q) => p - q);
        const dragged = Math.abs(event.clientX - pointer.x) > 6 && !pointer.scrubs;
        pointer = null;
        cursor.picked.setAttribute("width", 0);
        if (dragged && to > from) zoom([from, to]);
        else player.set(timeAt(event));
      });
      svg.addEventListener("pointercancel", () => { pointer = null; cursor.picked.setAttribute("width", 0); });
      svg.addEventListener("pointerleave", () => hover(null));
      svg.addEventListener("dblclick", () => zoom(null));
    }
    all.push({ redraw, follow });
  };

  data.plots.forEach((plot) => make(element(plot.group === "solver" ? "solver-plots" : "plots"), plot));
  showJoints();
  player.listen(() => all.forEach((plot) => plot.follow()));
  let waiting = null;
  const later = () => {
    if (waiting === null) waiting = requestAnimationFrame(() => { waiting = null; refresh(); });
  };
  new ResizeObserver(later).observe(element("plots"));
  document.querySelectorAll("details").forEach((details) => details.addEventListener("toggle", later));
  refresh();
  return { refresh };
};
