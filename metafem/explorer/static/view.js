// The axes: the mapping between the units that are shown and pixels. They begin at 0, or elsewhere when they are zoomed.
export const MARGIN = { left: 62, right: 16, top: 12, bottom: 46 };

// Free space beyond the farthest point, and the part of an axis below which the axis is shortened.
const [SPARE, EMPTY] = [1.08, 0.55];
// Growth of an axis each time that a point is moved beyond its end, and the part of the axis where the end begins.
const [GROWTH, EDGE] = [1.04, 0.985];
// The smallest and the largest part of the fitted axes that a zoom shows; `law.py` has the smallest, too.
const [LEAST, MOST] = [1e-3, 10];

class Axis {
  low = 0;
  high = 1;
  fitted = 1; // its end where it was fitted last
  ends = [0, 1]; // where it begins and ends [pixels]

  get span() { return this.high - this.low; }

  // What a pixel is.
  get pixel() { return this.span / Math.max(1, Math.abs(this.ends[1] - this.ends[0])); }

  px(value) { return this.ends[0] + ((value - this.low) / this.span) * (this.ends[1] - this.ends[0]); }
  at(px) { return this.low + ((px - this.ends[0]) / (this.ends[1] - this.ends[0])) * this.span; }
  has(value) { return value !== null && value >= this.low && value <= this.high; }

  // A value without digits that no pixel resolves.
  rounded(value) {
    const power = Math.floor(Math.log10(this.pixel));
    return power < 0 ? Number(value.toFixed(Math.min(100, -power))) : Math.round(value / 10 ** power) * 10 ** power;
  }

  // Shows all values; stays as it is while they fill it, unless `fresh`.
  fit(values, fresh) {
    const most = values.reduce((most, each) => (each !== null && each > most ? each : most), 0) * SPARE || 1;
    if (fresh || most > this.high || most < EMPTY * this.high) Object.assign(this, { low: 0, high: most, fitted: most });
  }

  // Shows a part that begins at a value; loads and frictions are not negative.
  shift(low, span = this.span) {
    this.low = Math.max(0, low);
    this.high = this.low + span;
  }

  // Becomes longer where a point is moved to its end.
  grow(value) {
    const [end, more] = [(1 - EDGE) * this.span, (GROWTH - 1) * this.span];
    if (value >= this.high - end) this.high += more;
    else if (value <= this.low + end) this.low = Math.max(0, this.low - more);
  }
}

export class View {
  x = new Axis();
  y = new Axis();
  unit = null;
  zoomed = false;

  constructor() { this.resize(640, 400); }

  resize(width, height) {
    Object.assign(this, { width, height, right: width - MARGIN.right, bottom: height - MARGIN.bottom });
    this.x.ends = [MARGIN.left, this.right];
    this.y.ends = [this.bottom, MARGIN.top];
  }

  px(x) { return this.x.px(x); }
  py(y) { return this.y.px(y); }
  has({ x, y }) { return this.x.has(x) && this.y.has(y); }

  // Shows all points; zoomed axes stay as they are.
  fit(xs, ys, unit) {
    const fresh = unit !== this.unit;
    this.unit = unit;
    if (this.zoomed && !fresh) return;
    this.zoomed = false;
    this.x.fit(xs, fresh);
    this.y.fit(ys, fresh);
  }

  // The part of the fitted axes that is shown.
  get part() { return Math.min(this.x.span / this.x.fitted, this.y.span / this.y.fitted); }

  // Shows another part of the axes; a place [px] stays where it is.
  zoom(factor, at) {
    if (factor * this.part < LEAST || factor * this.part > MOST) return;
    this.zoomed = true;
    for (const axis of ["x", "y"]) {
      const value = this[axis].at(at[axis]);
      this[axis].shift(value - (value - this[axis].low) * factor, this[axis].span * factor);
    }
  }

  // Moves the axes so that a place is in their middle, if it is not shown.
  show(place) {
    for (const axis of ["x", "y"]) if (!this[axis].has(place[axis])) this[axis].shift(place[axis] - this[axis].span / 2);
  }
}

// A drawing by hand: numbers at axes, the value of a curve, and elements of which a few attributes change for each answer.

// Round values within a range, at most about so many, with the number of decimals that tells them apart.
export function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((each) => each * power >= rough) * power;
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return { values: Array.from({ length: count }, (_, i) => (first + i) * step), decimals: decimalsOf(step * 1.0001) };
}

// The decimals of a value of which so much can be seen.
const decimalsOf = (least) => Math.min(20, Math.max(0, -Math.floor(Math.log10(least))));

// A value for people: with the digits that a pixel resolves.
export const told = (value, pixel) => value.toFixed(decimalsOf(pixel));

// The value of a curve at x, on the line between its points; null outside and in a gap.
export function valueAt(curve, x) {
  if (!curve || !curve.x.length || x < curve.x[0] || x > curve.x.at(-1)) return null;
  const i = Math.max(1, curve.x.findIndex((each) => each >= x));
  const [x0, x1, y0, y1] = [curve.x[i - 1], curve.x[i] ?? curve.x[i - 1], curve.y[i - 1], curve.y[i] ?? curve.y[i - 1]];
  if ([x0, y0, y1].includes(null)) return null; // in a gap
  return x1 === x0 ? y1 : y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
}

const SVG = "http://www.w3.org/2000/svg";

export function made(name, attributes = {}, parent = null) {
  const node = document.createElementNS(SVG, name);
  set(node, attributes);
  parent?.append(node);
  return node;
}

export function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null) node.removeAttribute(name);
    else if (node.getAttribute(name) !== String(value)) node.setAttribute(name, value);
  }
  return node;
}

export function label(words, x, y, anchor, parent = null) {
  const node = made("text", { x, y, "text-anchor": anchor }, parent);
  node.textContent = words;
  return node;
}

const at = (value) => value.toFixed(1);

// The path of a curve, with gaps where a value is missing.
export function path(view, curve) {
  if (!curve) return "";
  let [text, pen] = ["", "M"];
  curve.x.forEach((x, i) => {
    if (x === null || curve.y[i] === null) { pen = "M"; return; }
    text += `${pen}${at(view.px(x))} ${at(view.py(curve.y[i]))}`;
    pen = "L";
  });
  return text;
}

// The outline of an area between two curves; an infinite upper one is drawn at the top of the picture.
export function area(view, band) {
  if (!band || !band.x.length) return "";
  const top = 10 * view.y.high;
  const forth = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(Math.min(top, band.high[i] ?? top)))}`);
  const back = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(band.low[i] ?? 0))}`).reverse();
  return `M${forth.join("L")}L${back.join("L")}Z`;
}

// The picture of the law: axes, bands, curves, points, and its legend. The handles are drawn by `handles.js`.

// Pixels for a label of an axis.
const [BETWEEN_X, BETWEEN_Y] = [85, 48];

// What is drawn, from the back to the front, by the first words of its keys.
const LAYERS = ["tolerance", "pinned", "nearest", "wanted", "achieved", "measured"];

// Returns [class of the key, words, further words, curve] of all that an answer shows.
export function entries(data) {
  const found = [];
  const add = (curve, kind, words, more = "") => { if (curve) found.push([kind, words, more, curve]); };
  const crowd = data.crowd && ` (${data.crowd})`;
  add(data.wanted && { ...data.wanted, loose: data.marked }, data.marked ? "point" : "wanted", `target law${crowd}`,
    data.crowd && "Change them in the specification or its table, or choose another kind of target law.");
  if (data.refusal) add(data.achieved, "achieved old", "last law found");
  else add(data.achieved, "achieved", `achieved law (${data.model})`);
  add(data.pinned, "pinned", "pinned law");
  add(data.measured && { ...data.measured, loose: true }, "measured", data.measured?.name);
  add(data.nearest, "nearest", "nearest law that can be designed");
  // the errors of the part are told where the pointer rests
  add(data.tolerance, "tolerance", data.tolerance?.name.split(",")[0], data.tolerance?.name);
  return found;
}

export class Picture {
  constructor(svg) {
    this.svg = svg;
    this.name = `law-clip-${Math.random().toString(36).slice(2)}`; // two plots in one page each have their own
    this.clip = made("rect", {}, made("clipPath", { id: this.name }, made("defs", {}, svg)));
    this.grid = made("path", { class: "grid", "aria-hidden": "true" }, svg);
    this.curves = made("g", { class: "law-curves", "clip-path": `url(#${this.name})`, "aria-hidden": "true" }, svg);
    this.axes = made("g", { class: "axes", "aria-hidden": "true" }, svg);
    this.titleX = made("text", { class: "title", "text-anchor": "middle", "aria-hidden": "true" }, svg);
    this.titleY = made("text", { class: "title", "text-anchor": "middle", "aria-hidden": "true" }, svg);
  }

  // Draws the entries of `data` that are shown.
  draw(view, data, shown) {
    set(this.svg, { viewBox: `0 0 ${view.width} ${view.height}` });
    const [width, height] = [Math.max(1, view.right - MARGIN.left), Math.max(1, view.bottom - MARGIN.top)];
    set(this.clip, { x: MARGIN.left, y: MARGIN.top, width, height });
    this.drawAxes(view, data);
    const layers = LAYERS.flatMap((layer) => shown.filter(([kind]) => kind.split(" ")[0] === layer));
    this.curves.replaceChildren(...layers.flatMap(([kind, , , curve]) => drawn(view, kind, curve)));
  }

  drawAxes(view, data) {
    const { right, bottom } = view;
    const x = ticks(view.x.low, view.x.high, (right - MARGIN.left) / BETWEEN_X);
    const y = ticks(view.y.low, view.y.high, (bottom - MARGIN.top) / BETWEEN_Y);
    const look = JSON.stringify([x, y, view, data.x, data.y]);
    if (look === this.look) return; // a drag leaves them
    this.look = look;
    const grid = [...x.values.map((each) => `M${view.px(each)} ${MARGIN.top}V${bottom}`), ...y.values.map((each) => `M${MARGIN.left} ${view.py(each)}H${right}`)];
    set(this.grid, { d: grid.join("") });
    this.axes.replaceChildren(
      made("path", { d: `M${MARGIN.left} ${MARGIN.top}V${bottom}H${right}` }),
      ...x.values.map((each) => label(each.toFixed(x.decimals), view.px(each), bottom + 20, "middle")),
      ...y.values.map((each) => label(each.toFixed(y.decimals), MARGIN.left - 7, view.py(each) + 4, "end")),
    );
    const middle = (MARGIN.top + bottom) / 2;
    set(this.titleX, { x: (MARGIN.left + right) / 2, y: view.height - 8 });
    set(this.titleY, { x: 0, y: 0, transform: `translate(14 ${middle}) rotate(-90)` });
    for (const [node, { label: words, unit, meaning }] of [[this.titleX, data.x], [this.titleY, data.y]]) {
      node.textContent = `${words} [${unit}]`;
      if (meaning) made("title", {}, node).textContent = meaning; // shown where a pointer rests
    }
  }
}

// The nodes of a curve, of an area, or of loose points.
function drawn(view, kind, curve) {
  if (curve.loose) return points(view, kind, curve);
  const line = made("path", { class: kind, d: curve.low ? area(view, curve) : path(view, curve) });
  const marks = curve.marked ? curve.x.map((x, i) => made("circle", { cx: view.px(x), cy: view.py(curve.y[i]), r: 4 })) : [];
  return [line, ...marks];
}

function points(view, kind, { x, y }) {
  const group = made("g", { class: kind });
  x.forEach((each, i) => made("rect", { x: view.px(each) - 3, y: view.py(y[i]) - 3, width: 6, height: 6 }, group));
  return group;
}
