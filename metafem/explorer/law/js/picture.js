// The picture of the law: axes, bands, curves, points, and its legend. The handles are drawn by `handles.js`.
import { area, label, made, path, set, ticks } from "./svg.js";
import { MARGIN } from "./view.js";

// Pixels for a label of an axis.
const [BETWEEN_X, BETWEEN_Y] = [85, 48];

// What is drawn, from the back to the front, by the first words of its keys.
const LAYERS = ["tolerance", "other", "pinned", "nearest", "wanted", "achieved", "measured"];

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
  (data.others ?? []).forEach((each, i) => add(each, `other other-${i}`, each.name));
  (data.pending ?? []).forEach((name) => add({}, "pending", `${name}: being computed …`));
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
