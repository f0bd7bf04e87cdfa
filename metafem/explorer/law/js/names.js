// Short names beside the curves of the law, in their colours.
import { label, made, set, valueAt } from "./svg.js";
import { MARGIN } from "./view.js";

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
