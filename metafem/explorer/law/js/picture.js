// The picture of the law: axes, bands, curves, points, and its legend. The handles are drawn by `hand.js`.
import { area, label, made, path, set, ticks } from "./svg.js";
import { MARGIN } from "./view.js";

// Pixels for a label of an axis.
const [BETWEEN_X, BETWEEN_Y] = [85, 48];

// Returns [class of the key, words, further words, name beside the curve, curve] of all that an answer shows.
export function entries(data) {
  const found = [];
  const add = (curve, kind, words, name = "", more = "") => { if (curve) found.push([kind, words, more, name, curve]); };
  const crowd = data.crowd && ` (${data.crowd})`;
  add(data.wanted && { ...data.wanted, loose: data.marked }, `${data.marked ? "point" : "wanted"}${data.crowd ? "" : " named"}`, `target law${crowd}`, "target",
    data.crowd && "Change them in the specification or its table, or choose another kind of target law.");
  if (data.refusal) add(data.achieved, "achieved old", "last law found", "last law");
  else add(data.achieved, "achieved", `achieved law (${data.model})`, "achieved");
  add(data.pinned, "pinned", "A", "A");
  add(data.measured && { ...data.measured, loose: true }, "measured", data.measured?.name, "measured");
  add(data.nearest, "nearest named", "nearest law that can be designed", "nearest law");
  add(data.band, "band named", data.reach, "possible", "What the surfaces within the limits can have at one load. A law inside is refused where no single surface meets all of its loads.");
  // the errors of the part are told where the pointer rests
  add(data.tolerance, "tolerance named", data.tolerance?.name.split(",")[0], "tolerances", data.tolerance?.name);
  (data.others ?? []).forEach((each, i) => add(each, `other other-${i}`, each.name, each.name.split(",")[0]));
  (data.pending ?? []).forEach((name) => add({}, "pending", `${name}: being computed …`));
  return found;
}

export class Picture {
  constructor(svg) {
    this.svg = svg;
    this.name = `law-clip-${Math.random().toString(36).slice(2)}`; // two plots in one page each have their own
    this.clip = made("rect", {}, made("clipPath", { id: this.name }, made("defs", {}, svg)));
    this.grid = made("g", { class: "grid", "aria-hidden": "true" }, svg);
    this.curves = made("g", { class: "law-curves", "clip-path": `url(#${this.name})`, "aria-hidden": "true" }, svg);
    this.band = made("path", { class: "band" }, this.curves);
    this.tolerance = made("path", { class: "tolerance" }, this.curves);
    this.others = made("g", {}, this.curves);
    this.pinned = made("path", { class: "pinned" }, this.curves);
    this.nearest = made("path", { class: "nearest" }, this.curves);
    this.wanted = made("path", { class: "wanted" }, this.curves);
    this.achieved = made("path", { class: "achieved" }, this.curves);
    this.marks = made("g", { class: "marks" }, this.curves);
    this.measured = made("g", { class: "measured" }, this.curves);
    this.axes = made("g", { class: "axes", "aria-hidden": "true" }, svg);
    this.titleX = made("text", { class: "title", "text-anchor": "middle", "aria-hidden": "true" }, svg);
    this.titleY = made("text", { class: "title", "text-anchor": "middle", "aria-hidden": "true" }, svg);
  }

  draw(view, data) {
    set(this.svg, { viewBox: `0 0 ${view.width} ${view.height}` });
    const [width, height] = [Math.max(1, view.right - MARGIN.left), Math.max(1, view.bottom - MARGIN.top)];
    set(this.clip, { x: MARGIN.left, y: MARGIN.top, width, height });
    this.drawAxes(view, data);
    set(this.band, { d: area(view, data.band) });
    set(this.tolerance, { d: area(view, data.tolerance) });
    set(this.pinned, { d: path(view, data.pinned) });
    set(this.nearest, { d: path(view, data.nearest) });
    set(this.achieved, { d: path(view, data.achieved), class: data.refusal ? "achieved old" : "achieved" });
    set(this.wanted, { d: data.marked ? "" : path(view, data.wanted) });
    replace(this.others, data.others, (each, i) => made("path", { class: `other other-${i}`, d: path(view, each) }));
    replace(this.marks, data.nearest?.marked ? zip(data.nearest) : [], ([x, y]) =>
      made("circle", { cx: view.px(x), cy: view.py(y), r: 4 }));
    this.drawMeasured(view, data.measured);
  }

  drawAxes(view, data) {
    const { right, bottom } = view;
    const x = ticks(view.x.low, view.x.high, (right - MARGIN.left) / BETWEEN_X);
    const y = ticks(view.y.low, view.y.high, (bottom - MARGIN.top) / BETWEEN_Y);
    replace(this.grid, [...x.values.map((each) => ["x", each]), ...y.values.map((each) => ["y", each])], ([axis, value]) =>
      axis === "x"
        ? made("line", { x1: view.px(value), x2: view.px(value), y1: MARGIN.top, y2: bottom })
        : made("line", { x1: MARGIN.left, x2: right, y1: view.py(value), y2: view.py(value) }));
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

  drawMeasured(view, points) {
    const all = points ? points.x.map((x, i) => [x, points.y[i], points.x_sd?.[i] ?? 0, points.y_sd?.[i] ?? 0]) : [];
    replace(this.measured, all, ([x, y, dx, dy]) => {
      const [px, py] = [view.px(x), view.py(y)];
      const point = made("g");
      if (dx) made("line", { x1: view.px(x - dx), x2: view.px(x + dx), y1: py, y2: py }, point);
      if (dy) made("line", { x1: px, x2: px, y1: view.py(y - dy), y2: view.py(y + dy) }, point);
      made("rect", { x: px - 3, y: py - 3, width: 6, height: 6 }, point);
      return point;
    });
  }
}

function zip(curve) { return curve.x.map((x, i) => [x, curve.y[i]]); }

function replace(group, values, make) { group.replaceChildren(...(values ?? []).map(make)); }
