// The data of the page, and values of curves between their points.

const data = JSON.parse(document.getElementById("data").textContent);
const stageData = data.stage;
const times = data.t;
const startTime = times[0];
const endTime = times[times.length - 1];
const plotNamed = (id) => data.plots.find((plot) => plot.id === id);

const element = (id) => document.getElementById(id);
const create = (parent, tag, attributes = {}, text) => {
  const made = document.createElement(tag);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  return parent ? parent.appendChild(made) : made;
};

// A number for people: at most so many digits, no trailing zeros.
const short = (x, digits = 4) => {
  if (x === null || !Number.isFinite(x)) return "–";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-4 || size >= 1e7) return x.toExponential(digits - 1).replace(/\.?0+e\+?/, "e").replace("-", "−");
  return String(Number(x.toPrecision(digits))).replace("-", "−");
};

// A value on a plot of this height: digits that are too small to be seen there are left out.
const shortOn = (x, height) => {
  const step = Math.pow(10, Math.floor(Math.log10(height || 1)) - 4);
  return short(Math.round(x / step) * step, 4);
};

// The interval of a rising list that holds x, as the index of its left end.
const interval = (list, x) => {
  let [low, high] = [0, list.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (list[middle] <= x) low = middle;
    else high = middle;
  }
  return low;
};

// A curve at x, straight between its points; null outside of them.
const valueAt = (xs, ys, x) => {
  if (xs.length < 2 || x < xs[0] || x > xs[xs.length - 1]) return null;
  const k = interval(xs, x);
  if (ys[k] === null || ys[k + 1] === null) return null;
  const part = xs[k + 1] > xs[k] ? (x - xs[k]) / (xs[k + 1] - xs[k]) : 0;
  return ys[k] + part * (ys[k + 1] - ys[k]);
};

// The rates of the entries of q: those of quaternions are half of their product with the angular velocity, those of
// the place of a floating joint its velocity, both in the axes of what moves.
const ratesOf = (q, v) => {
  const rates = [];
  data.free.forEach(({ slides, position, coordinate }) => {
    while (rates.length < position) rates.push(v[coordinate - position + rates.length]);
    const part = (list, first, k, size) => list.slice(first, first + size).map((row) => row[k]);
    const made = times.map((_, k) => {
      const quaternion = part(q, position + slides, k, 4);
      const [x, y, z, w] = quaternion;
      const [a, b, c] = part(v, coordinate + slides, k, 3);
      const moved = slides > 0 ? turned(turnOf(quaternion), part(v, coordinate, k, 3)) : [];
      return [...moved, w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a, -(x * a + y * b + z * c)]
        .map((rate, entry) => (entry < slides ? rate : 0.5 * rate));
    });
    for (let entry = 0; entry < slides + 4; entry++) rates.push(made.map((row) => row[entry]));
  });
  const more = data.free.length;
  while (rates.length < q.length) rates.push(v[rates.length - more]);
  return rates;
};

// Positions of the joints at a time: cubics that meet positions and rates at the samples. Those of quaternions have
// nearly length 1; the same orientation with the other sign is taken back to the side of the sample before.
const positionsAt = (() => {
  const q = plotNamed("positions").curves.map((curve) => curve.y.slice());
  const v = ratesOf(q, plotNamed("rates").curves.map((curve) => curve.y));
  data.free.forEach(({ slides, position }) => {
    const entries = [0, 1, 2, 3].map((k) => position + slides + k);
    for (let k = 1; k < times.length; k++) {
      if (entries.reduce((sum, i) => sum + q[i][k - 1] * q[i][k], 0) >= 0) continue;
      entries.forEach((i) => { q[i][k] *= -1; v[i][k] *= -1; });
    }
  });
  return (time) => {
    const k = interval(times, time);
    const h = times[k + 1] - times[k];
    const s = h > 0 ? Math.min(1, Math.max(0, (time - times[k]) / h)) : 0;
    const [a, b] = [(1 + 2 * s) * (1 - s) * (1 - s), s * (1 - s) * (1 - s) * h];
    const [c, d] = [s * s * (3 - 2 * s), s * s * (s - 1) * h];
    return q.map((row, i) => a * row[k] + b * v[i][k] + c * row[k + 1] + d * v[i][k + 1]);
  };
})();

// Colours follow the scheme of the system, which may change while the page is open.
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const jointColour = (number) => (number === null ? "var(--ink)" : `var(--c${number % 12})`);
const rgb = (text) => {
  const hex = text.replace("#", "");
  const wide = hex.length === 3 ? [...hex].map((digit) => digit + digit).join("") : hex;
  return [0, 2, 4].map((k) => parseInt(wide.slice(k, k + 2), 16) / 255);
};
