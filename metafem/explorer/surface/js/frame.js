// The axes and the scale of the map, and the bar of its colours.
import { label, made, ticks } from "metafem-law/svg.js";
import { digits, range } from "./contacts.js";

const [LEFT, BOTTOM, TOP, BAR, ASIDE] = [38, 34, 8, 104, 29];

// Part of the least distance between sites that is free around them.
const EDGE = 0.62;

// Widths of the colours and of the most frequent class of the histogram [pixels], and number of classes.
const [COLOURS, FREQUENT, CLASSES] = [10, 22, 48];

// The view of the map: one scale for both directions.
export function viewOf(layout, width, height) {
  const edge = EDGE * layout.spacing;
  const [[west, east], [south, north]] = [range(layout.x), range(layout.y)];
  const [across, along] = [east - west + 2 * edge, north - south + 2 * edge];
  const scale = Math.max(1e-9, Math.min((width - LEFT - BAR) / across, (height - TOP - BOTTOM) / along));
  const left = LEFT + Math.max(0, (width - LEFT - BAR - scale * across) / 2);
  const top = TOP + Math.max(0, (height - TOP - BOTTOM - scale * along) / 2);
  const box = { left, top, right: left + scale * across, bottom: top + scale * along };
  const bar = { top: TOP, bottom: Math.max(TOP, height - BOTTOM) }; // a map of one row is lower
  const [x, y] = [west - edge, south - edge];
  return { box, range: [x, east + edge, y, north + edge], scale, bar, px: (each) => box.left + scale * (each - x), py: (each) => box.bottom - scale * (each - y) };
}

function upward(words, x, y, parent) { label(words, x, y, "middle", parent).setAttribute("transform", `rotate(-90 ${x} ${y})`); }

export function drawAxes(parent, view) {
  parent.replaceChildren();
  const { left, top, right, bottom } = view.box;
  const [west, east, south, north] = view.range;
  made("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "frame" }, parent);
  const room = (pixels) => Math.max(2, Math.min(8, Math.floor(pixels / 45)));
  for (const x of ticks(west, east, room(right - left)).values) label(digits(x), view.px(x), bottom + 14, "middle", parent);
  for (const y of ticks(south, north, room(bottom - top)).values) label(digits(y), left - 5, view.py(y) + 4, "end", parent);
  label("x [mm]", (left + right) / 2, bottom + 29, "middle", parent);
  upward("y [mm]", left - ASIDE, (top + bottom) / 2, parent);
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
  const counts = new Array(CLASSES).fill(0);
  for (const value of colours.present) counts[Math.min(CLASSES - 1, Math.floor((CLASSES * (value - low)) / (high - low || 1)))] += 1;
  const [height, most] = [(bottom - top) / CLASSES, Math.max(1, ...counts)];
  counts.forEach((count, i) => {
    const place = { x, y: bottom - (i + 1) * height, height: height + 0.5, width: COLOURS };
    made("rect", { ...place, fill: css(low + ((i + 0.5) / CLASSES) * (high - low)) }, parent);
    if (count) made("rect", { ...place, class: "count", x: x + COLOURS, width: (FREQUENT * count) / most }, parent);
  });
  const right = x + COLOURS + FREQUENT;
  const power = powerOf(Math.max(Math.abs(low), Math.abs(high)));
  if (high > low) {
    for (const value of ticks(low, high, 5).values) label(digits(value / 10 ** power), right + 4, bottom - ((value - low) / (high - low)) * (bottom - top) + 4, "start", parent);
  }
  const unit = power ? `10${superscript(power)} ${colours.unit}` : colours.unit;
  upward(`${colours.name} [${unit}]`, right + 52, (top + bottom) / 2, parent);
}
