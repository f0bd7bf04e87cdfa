// What is shown at the sites by colours: values and their scale.
import { radiusOf } from "./contacts.js";

const NAMES = {
  height: ["height", "µm"],
  radius: ["radius of curvature", "µm"],
  pressure: ["mean contact pressure", "MPa"],
  difference: ["height, B − A", "µm"],
  sensitivity: ["change of friction per height", "%/µm"],
};

// The values at the sites, which of them are shown, and their scale; `spread` is "value" or "quantile".
export function colouring(what, surface, contacts, { dark = false, spread = "value" } = {}) {
  const [name, unit] = NAMES[what];
  const filled = (i) => surface.height[i] !== null;
  const own = { height: surface.height, radius: surface.height.map((_, i) => (filled(i) ? 1e3 * radiusOf(surface, i) : null)), difference: surface.difference };
  const values = own[what] ?? contacts?.[what];
  if (!values) return { name, unit, values: [], scale: null, shown: () => false };
  const shown = own[what] ? (i) => values[i] !== null : (i) => values[i] !== null && contacts.radius[i] > 0;
  const present = values.filter((_, i) => shown(i));
  const [low, high] = present.reduce(([least, most], each) => [Math.min(least, each), Math.max(most, each)], [0, 0]);
  const signed = low < 0 && what !== "height";
  const most = Math.max(high, -low);
  const range = what === "height" ? surface.limits : [signed ? -most : 0, most];
  return { name, unit, values, present, shown, scale: scaleOf(...range, { signed, dark, values: spread === "quantile" && !signed ? present : null }) };
}

// Scales of colour whose lightness rises in equal steps, in the colour space Oklab; along blue and yellow, and blue and
// orange, they are told apart by people who do not tell red from green.

const STEPS = 256;

// From Oklab to linear and then to coded sRGB, each from 0 to 1.
function rgb([light, a, b]) {
  const l = (light + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (light - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (light - 0.0894841775 * a - 1.291485548 * b) ** 3;
  const linear = [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
  return linear.map((each) => {
    const value = Math.min(1, Math.max(0, each));
    return value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055;
  });
}

const between = (from, to, t) => from.map((each, i) => each + t * (to[i] - each));

function table(at) {
  return Array.from({ length: STEPS }, (_, i) => rgb(at(i / (STEPS - 1))));
}

// From blue over green to yellow.
const [LOW, GREEN, HIGH] = [[0.32, 0.0, -0.13], [0.625, -0.11, 0.0], [0.93, -0.03, 0.16]];
const rising = table((t) => between(between(LOW, GREEN, t), between(GREEN, HIGH, t), t));

const BLUE = [-0.03, -0.12];
const ORANGE = [0.09, 0.11];
const diverging = (dark) => {
  const middle = [dark ? 0.38 : 0.93, 0, 0];
  const end = dark ? 0.8 : 0.55;
  return table((t) => between(middle, [end, ...(t < 0.5 ? BLUE : ORANGE)], Math.abs(2 * t - 1)));
};
const twoSided = { true: diverging(true), false: diverging(false) };

// A scale of colours over a range; `rgb` answers from 0 to 1, `css` for drawing. With `values` it is by quantile: each
// colour has as many of them.
function scaleOf(low, high, { signed = false, dark = false, values = null } = {}) {
  const colours = signed ? twoSided[dark] : rising;
  const sorted = values?.toSorted((a, b) => a - b);
  const edges = sorted?.length ? colours.map((_, i) => sorted[Math.round((i / (STEPS - 1)) * (sorted.length - 1))]) : null;
  const ranked = (value) => { // the middle of the colours of equal values
    const above = edges.findIndex((each) => each >= value);
    return (edges.findLastIndex((each) => each <= value) + (above < 0 ? STEPS : above)) / 2;
  };
  const place = edges ? ranked : (value) => ((STEPS - 1) * (value - low)) / (high - low || 1);
  const index = (value) => Math.round(Math.min(STEPS - 1, Math.max(0, place(value))));
  const css = colours.map((each) => `rgb(${each.map((part) => Math.round(255 * part)).join(" ")})`);
  return { low, high, rgb: (value) => colours[index(value)], css: (value) => css[index(value)] };
}
