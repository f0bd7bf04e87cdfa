// The frame of the map: scale, axes in mm and the bar of the colours, as SVG.
import { digits } from "./values.js";

const SVG = "http://www.w3.org/2000/svg";
const [LEFT, BOTTOM, TOP, BAR] = [38, 34, 8, 84];

// Least height of the bar, with room for its ticks and its name: a map of one row is lower.
const LEAST_BAR = 180;

export function element(name, attributes = {}, parent = null) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  parent?.append(made);
  return made;
}

// From mm to pixels; one scale for both directions.
export function viewOf(layout, width, height) {
  const edge = 0.62 * layout.spacing;
  const range = (values) => values.reduce(([low, high], each) => [Math.min(low, each), Math.max(high, each)], [Infinity, -Infinity]);
  const [[west, east], [south, north]] = [range(layout.x), range(layout.y)];
  const [across, along] = [east - west + 2 * edge, north - south + 2 * edge];
  const scale = Math.max(1e-9, Math.min((width - LEFT - BAR) / across, (height - TOP - BOTTOM) / along));
  const left = LEFT + Math.max(0, (width - LEFT - BAR - scale * across) / 2);
  const top = TOP + Math.max(0, (height - TOP - BOTTOM - scale * along) / 2);
  const box = { left, top, right: left + scale * across, bottom: top + scale * along };
  return {
    scale,
    box,
    bar: barOf(box, height),
    range: [west - edge, east + edge, south - edge, north + edge],
    px: (x) => left + scale * (x - west + edge),
    py: (y) => top + scale * (north + edge - y),
  };
}

// Top and bottom of the bar, beside the middle of the map.
function barOf({ top, bottom }, height) {
  const half = Math.max(bottom - top, Math.min(LEAST_BAR, height - TOP - BOTTOM)) / 2;
  const middle = Math.max(TOP + half, Math.min(height - BOTTOM - half, (top + bottom) / 2));
  return { top: middle - half, bottom: middle + half };
}

function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((each) => each * power >= rough) ?? 10);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}

function text(parent, x, y, words, anchor = "middle", turned = "") {
  element("text", { x, y, "text-anchor": anchor, ...(turned && { transform: turned }) }, parent).textContent = words;
}

export function drawAxes(parent, view) {
  parent.replaceChildren();
  const { left, top, right, bottom } = view.box;
  const [west, east, south, north] = view.range;
  element("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "frame" }, parent);
  const room = (pixels) => Math.max(2, Math.min(8, Math.floor(pixels / 45)));
  for (const x of ticks(west, east, room(right - left))) text(parent, view.px(x), bottom + 14, digits(x));
  for (const y of ticks(south, north, room(bottom - top))) text(parent, left - 5, view.py(y) + 4, digits(y), "end");
  text(parent, (left + right) / 2, bottom + 29, "x [mm]");
  const [x, y] = [left - 29, (top + bottom) / 2];
  text(parent, x, y, "y [mm]", "middle", `rotate(-90 ${x} ${y})`);
}

// The power of ten that is left out of the numbers of a bar, where they would be too long for it.
const powerOf = (most) => (most > 0 && (most < 0.01 || most >= 1e5) ? Math.floor(Math.log10(most)) : 0);

const superscript = (power) => String(power).replace("-", "⁻").replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

export function drawBar(parent, view, colours) {
  parent.replaceChildren();
  if (!colours.scale) return;
  const { low, high, css } = colours.scale;
  const { top, bottom } = view.bar;
  const x = view.box.right + 12;
  const steps = Math.max(1, Math.round(bottom - top));
  for (let i = 0; i < steps; i++) {
    element("rect", { x, y: bottom - 1 - i, width: 12, height: 1.5, fill: css(low + ((i + 0.5) / steps) * (high - low)) }, parent);
  }
  const power = powerOf(Math.max(Math.abs(low), Math.abs(high)));
  if (high > low) for (const value of ticks(low, high, 5)) text(parent, x + 16, bottom - ((value - low) / (high - low)) * (bottom - top) + 4, digits(value / 10 ** power), "start");
  const middle = (top + bottom) / 2;
  const unit = power ? `10${superscript(power)} ${colours.unit}` : colours.unit;
  text(parent, x + 64, middle, `${colours.name} [${unit}]`, "middle", `rotate(-90 ${x + 64} ${middle})`);
}
