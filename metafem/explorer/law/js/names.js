// Short names beside the curves of the law, in their colours.
import { made, set, valueAt } from "./svg.js";
import { MARGIN } from "./view.js";

// Distances of a name from the end of its curve and from the next name, and about how wide a letter is [pixels].
const [BESIDE, LINE, LETTER] = [8, 15, 7];
// How far around their middles a handle and the mark of the load reach, and the height of what a handle carries [pixels].
const [HANDLE, MARK, CARRIED] = [11, 6, 44];
// The step in which the end of a curve is looked for [pixels].
const STEP = 6;

// The last place of a curve, or of points, within the picture; null if none is.
function endOf(view, { x, y, low, high, loose }) {
  if (loose) {
    const shown = x.map((each, i) => ({ x: each, y: y[i] })).filter((each) => view.has(each));
    return shown.reduce((last, each) => (last && last.x > each.x ? last : each), null);
  }
  const top = view.y.high;
  const middle = low?.map((each, i) => (each + Math.min(top, high[i] ?? top)) / 2); // of a band
  const curve = { x, y: middle ?? y };
  for (let px = Math.min(view.right, view.px(x.at(-1) ?? 0)); px >= MARGIN.left; px -= STEP) {
    const place = { x: view.atX(px), y: valueAt(curve, view.atX(px)) };
    if (view.hasY(place.y)) return place;
  }
  return null;
}

const apart = (a, b) => Math.abs(a.y - b.y) >= (a.tall + b.tall) / 2 || a.x > b.x + b.wide || b.x > a.x + a.wide;

export class Names {
  nodes = new Map();
  away = new Map(); // how far each name is above or below the end of its curve [lines]

  constructor(svg) { this.group = made("g", { class: "names", "aria-hidden": "true" }, svg); }

  // Draws the names of `entries`. A name has a place without other names, handles and the mark of the load. It keeps this place at its
  // curve while a handle is held.
  draw(view, entries, handles, load, held) {
    const around = ({ x, y, carried = "" }, size) =>
      ({ x: view.px(x) - size, y: view.py(y), wide: 2 * size + LETTER * carried.length, tall: carried ? CARRIED : 2 * size });
    const taken = [around(load, MARK), ...handles.map((each) => around(each, HANDLE))];
    const shown = new Set();
    const named = view.named ? entries.filter(([, , , name]) => name) : [];
    for (const [kind, words, more, name, curve] of named) {
      const end = endOf(view, curve);
      if (!end) continue;
      const wide = LETTER * name.length;
      const at = { x: Math.min(view.px(end.x) + (curve.loose ? HANDLE : 0) + BESIDE, view.width - wide), y: view.py(end.y), wide, tall: LINE };
      const moved = (lines) => ({ ...at, y: at.y + lines * LINE });
      const free = (lines) => {
        const there = moved(lines);
        return there.y > MARGIN.top && there.y < view.bottom && taken.every((each) => apart(each, there));
      };
      const tried = [...Array(2 * named.length + 8).keys()].map((i) => (i % 2 ? -1 : 1) * Math.ceil(i / 2) * 0.5);
      const lines = (held ? this.away.get(kind) : undefined) ?? tried.find(free) ?? 0;
      this.away.set(kind, lines);
      taken.push(moved(lines));
      shown.add(kind);
      this.put(kind, name, more || words, moved(lines));
    }
    for (const [kind, node] of this.nodes) {
      if (shown.has(kind)) continue;
      node.remove();
      this.nodes.delete(kind);
      this.away.delete(kind);
    }
  }

  put(kind, name, more, { x, y }) {
    const node = this.nodes.get(kind) ?? made("text", { class: `name ${kind}` }, this.group);
    this.nodes.set(kind, node);
    if (node.dataset.words !== name + more) {
      node.dataset.words = name + more;
      node.textContent = name;
      made("title", {}, node).textContent = more;
    }
    set(node, { x: x.toFixed(1), y: (y + 4).toFixed(1) });
  }
}
