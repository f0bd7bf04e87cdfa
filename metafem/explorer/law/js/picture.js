// The picture of the law: axes, bands, curves, points, and its legend. The handles are drawn by `handles.js`.
import { area, label, made, path, set, ticks, valueAt } from "./svg.js";
import { MARGIN } from "./view.js";

// Pixels for a label of an axis.
const [BETWEEN_X, BETWEEN_Y] = [85, 48];

// What is drawn, from the back to the front, by the first words of its keys.
const LAYERS = ["band", "tolerance", "other", "pinned", "nearest", "wanted", "achieved", "measured"];

// Returns [class of the key, words, further words, name beside the curve, curve] of all that an answer shows.
export function entries(data) {
  const found = [];
  const add = (curve, kind, words, name = "", more = "") => { if (curve) found.push([kind, words, more, name, curve]); };
  const crowd = data.crowd && ` (${data.crowd})`;
  add(data.wanted && { ...data.wanted, loose: data.marked }, `${data.marked ? "point" : "wanted"}${data.crowd ? "" : " named"}`, `target law${crowd}`, "target",
    data.crowd && "Change them in the specification or its table, or choose another kind of target law.");
  if (data.refusal) add(data.achieved, "achieved old", "last law found", "last law");
  else add(data.achieved, "achieved", `achieved law (${data.model})`, "achieved");
  add(data.pinned, "pinned", "pinned law", "pinned");
  add(data.measured && { ...data.measured, loose: true }, "measured", data.measured?.name, "measured");
  add(data.nearest, "nearest named", "nearest law that can be designed", "nearest law");
  add(data.band, "band named", data.reach, "possible", "What the surfaces within the limits can have at one load. A law inside is refused where no single surface meets all of its loads.");
  // the errors of the part are told where the pointer rests
  add(data.tolerance, "tolerance named", data.tolerance?.name.split(",")[0], "made ± 1 SD", data.tolerance?.name);
  (data.others ?? []).forEach((each, i) => add(each, `other other-${i}`, each.name, each.name.split(",")[0]));
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
    this.curves.replaceChildren(...layers.flatMap(([kind, , , , curve]) => drawn(view, kind, curve)));
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

// Points with bars of their errors.
function points(view, kind, { x, y, x_sd: across, y_sd: up }) {
  const group = made("g", { class: kind });
  x.forEach((each, i) => {
    const [px, py, dx, dy] = [view.px(each), view.py(y[i]), across?.[i] ?? 0, up?.[i] ?? 0];
    const point = made("g", {}, group);
    if (dx) made("line", { x1: view.px(each - dx), x2: view.px(each + dx), y1: py, y2: py }, point);
    if (dy) made("line", { x1: px, x2: px, y1: view.py(y[i] - dy), y2: view.py(y[i] + dy) }, point);
    made("rect", { x: px - 3, y: py - 3, width: 6, height: 6 }, point);
  });
  return group;
}

// Short names beside the curves of the law, in their colours.

// Distances of a name from the end of its curve and from the next name, and about how wide a letter is [pixels].
const [BESIDE, LINE, LETTER] = [8, 15, 8];
// How far around their middles a handle and the mark of the load reach, and the height of what a handle carries [pixels].
const [HANDLE, MARK, CARRIED] = [11, 6, 44];
// The step in which the end of a curve is looked for [pixels], and the places of a name that are tried [lines].
const STEP = 6;
const PLACES = [0, -0.5, 0.5, -1, 1, -1.5, 1.5, -2, 2, -2.5, 2.5, -3, 3, -4, 4, -5, 5, -6, 6];

// The last place of a curve, of a band or of loose points within the picture; null if none is.
function endOf(view, { x, y, low, high, loose }) {
  if (loose) {
    const shown = x.map((each, i) => ({ x: each, y: y[i] })).filter((each) => view.has(each));
    return shown.reduce((last, each) => (last && last.x > each.x ? last : each), null);
  }
  const top = view.y.high;
  const curve = { x, y: y ?? low.map((each, i) => (each + Math.min(top, high[i] ?? top)) / 2) };
  const last = x.at(-1) ?? 0;
  for (let px = Math.min(view.right, view.px(last)); px >= MARGIN.left; px -= STEP) {
    const load = Math.min(last, view.x.at(px)); // not beyond it by a rounding error
    const friction = valueAt(curve, load);
    if (view.y.has(friction)) return { x: load, y: friction };
  }
  return null;
}

const apart = (a, b) => Math.abs(a.y - b.y) >= (a.tall + b.tall) / 2 || a.x > b.x + b.wide || b.x > a.x + a.wide;

export class Names {
  away = {}; // how far each name is above or below the end of its curve [lines]

  constructor(svg) { this.group = made("g", { "aria-hidden": "true" }, svg); }

  // Draws the names of `entries`. A name has a place without other names, handles and the mark of the load; it keeps
  // this place at its curve while a handle is held.
  draw(view, entries, handles, load, held) {
    const around = ({ x, y, carried = "" }, size) =>
      ({ x: view.px(x) - size, y: view.py(y), wide: 2 * size + LETTER * carried.length, tall: carried ? CARRIED : 2 * size });
    const taken = [around(load, MARK), ...handles.map((each) => around(each, HANDLE))];
    const before = held ? this.away : {};
    this.away = {};
    this.group.replaceChildren();
    for (const [kind, words, more, name, curve] of view.named ? entries : []) {
      const end = name && endOf(view, curve);
      if (!end) continue;
      const wide = LETTER * name.length;
      const x = Math.min(view.px(end.x) + (curve.loose ? HANDLE : 0) + BESIDE, view.width - wide);
      const at = (lines) => ({ x, y: view.py(end.y) + lines * LINE, wide, tall: LINE });
      const free = ({ y, ...box }) => y > MARGIN.top && y < view.bottom && taken.every((each) => apart(each, { y, ...box }));
      const lines = before[name] ?? PLACES.find((each) => free(at(each))) ?? 0;
      this.away[name] = lines;
      taken.push(at(lines));
      const node = set(label(name, x.toFixed(1), (at(lines).y + 4).toFixed(1), "start", this.group), { class: `name ${kind}` });
      made("title", {}, node).textContent = more || words;
    }
  }
}
