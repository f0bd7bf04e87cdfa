// What is shown at the sites by colours: values and their scale.
import { radiusOf, range as rangeOf } from "./contacts.js";

const NAMES = {
  height: ["height", "µm"],
  radius: ["radius of curvature", "µm"],
  pressure: ["mean contact pressure", "MPa"],
  sensitivity: ["change of friction per height", "%/µm"],
};

// The values at the sites, which of them are shown, and their scale.
export function colouring(surface, contacts, { what, dark }) {
  const [name, unit] = NAMES[what];
  const filled = (i) => surface.height[i] !== null;
  const own = { height: surface.height, radius: surface.height.map((_, i) => (filled(i) ? 1e3 * radiusOf(surface, i) : null)) };
  const values = own[what] ?? contacts?.[what];
  if (!values) return { name, unit, values: [], scale: null, shown: () => false };
  const shown = own[what] ? (i) => values[i] !== null : (i) => values[i] !== null && contacts.radius[i] > 0;
  const present = values.filter((_, i) => shown(i));
  const [low, high] = rangeOf([0, ...present]);
  const signed = low < 0 && what !== "height";
  const most = Math.max(high, -low);
  const range = what === "height" ? surface.limits : [signed ? -most : 0, most];
  return { name, unit, values, present, shown, scale: scaleOf(...range, signed, dark) };
}

// Scales of colour whose lightness rises in equal steps, in the colour space Oklab; along blue and yellow, and blue and
// orange, they are told apart by people who do not tell red from green.

const STEPS = 256;

// The colours that the browser mixes for places from 0 to 1, each as its parts from 0 to 255.
function table(at) {
  const context = Object.assign(document.createElement("canvas"), { width: STEPS, height: 1 }).getContext("2d", { willReadFrequently: true });
  for (let i = 0; i < STEPS; i++) {
    context.fillStyle = at(i / (STEPS - 1));
    context.fillRect(i, 0, 1, 1);
  }
  const { data } = context.getImageData(0, 0, STEPS, 1);
  return Array.from({ length: STEPS }, (_, i) => [...data.slice(4 * i, 4 * i + 3)]);
}

const between = (from, to, t) => `color-mix(in oklab, ${from}, ${to} ${100 * t}%)`;

// From blue over green to yellow.
const [LOW, GREEN, HIGH] = ["oklab(0.32 0 -0.13)", "oklab(0.625 -0.11 0)", "oklab(0.93 -0.03 0.16)"];
const rising = table((t) => between(between(LOW, GREEN, t), between(GREEN, HIGH, t), t));

// From blue to orange.
const twoSided = (middle, end) => table((t) => between(`oklab(${middle} 0 0)`, `oklab(${end} ${t < 0.5 ? "-0.03 -0.12" : "0.09 0.11"})`, Math.abs(2 * t - 1)));
const diverging = { true: twoSided(0.38, 0.8), false: twoSided(0.93, 0.55) };

// A scale of colours over a range.
function scaleOf(low, high, signed, dark) {
  const colours = signed ? diverging[dark] : rising;
  const index = (value) => Math.round(Math.min(STEPS - 1, Math.max(0, ((STEPS - 1) * (value - low)) / (high - low || 1))));
  return { low, high, css: (value) => `rgb(${colours[index(value)].join(", ")})` };
}
