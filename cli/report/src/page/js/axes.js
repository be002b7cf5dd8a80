// Ranges, ticks and units of plots.

const svgName = "http://www.w3.org/2000/svg";
const draw = (parent, tag, attributes = {}, text) => {
  const made = document.createElementNS(svgName, tag);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  if (text !== undefined) made.textContent = text;
  return parent.appendChild(made);
};

// Multiples of 1, 2 or 5 times a power of ten between two numbers, about so many.
const ticksOf = (low, high, count) => {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0)) return [];
  const power = Math.pow(10, Math.floor(Math.log10(raw)));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= 0.999 * raw);
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  return Array.from({ length: Math.max(0, Math.min(60, last - first + 1)) }, (_, k) => (first + k) * step);
};

// Whole decades between two logarithms, every so many that they do not crowd.
const decadesOf = (low, high, count) => {
  const every = Math.max(1, Math.ceil((high - low) / count));
  const first = Math.ceil(low / every) * every;
  const found = [];
  for (let k = first; k <= high; k += every) found.push(k);
  return found;
};

// Angles can be shown in degrees: the factor of a curve's values and the unit of its plot.
const units = { degrees: false };
const factorOf = (plot, number) => {
  const angle = plot.units[0].includes("rad");
  if (!units.degrees || !angle || number === null || plot.unitless.includes(number) || data.joints[number].kind !== "revolute") return 1;
  return plot.units[0].startsWith("rad") ? 180 / Math.PI : Math.PI / 180;
};
const unitOf = (plot) => (units.degrees ? plot.unit.replace(/\brad\b/g, "deg") : plot.unit);
const unitOfCurve = (plot, number) => {
  if (!plot.ofJoints || plot.units[0] === "" || number === null) return unitOf(plot);
  if (plot.unitless.includes(number)) return "";
  const unit = plot.units[data.joints[number].kind === "revolute" ? 0 : 1];
  return units.degrees ? unit.replace(/\brad\b/g, "deg") : unit;
};

// The range of numbers with a margin; never empty.
const rangeOf = (values) => {
  let [low, high] = [Infinity, -Infinity];
  for (const x of values) {
    if (x === null || !Number.isFinite(x)) continue;
    low = Math.min(low, x);
    high = Math.max(high, x);
  }
  if (low > high) return [-1, 1];
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  const margin = high - low > 1e-9 * size ? 0.07 * (high - low) : 0.5 * size;
  return [low - margin, high + margin];
};
