// What is shown at a load: the values under the pointer, the load of the contacts, and the loads at which sites touch.
import { ARROWS, Chosen, hear, tell } from "./linked.js";
import { MARGIN, made, set, valueAt } from "./view.js";

// Steps of the arrow keys along the axis, and of those with Shift.
const [STEPS, LONG] = [100, 10];

// Length of a tick, of a marked one, and how near to it a pointer is on it [pixels].
const [LENGTH, MARKED, NEAR] = [7, 12, 4];

// Ticks below the load axis: the loads at which the sites come into contact.
class Rug {
  entry = [];
  sites = []; // those that are marked
  pointed = ""; // those whose tick is under the pointer

  constructor(group, changed, signal) {
    this.ticks = made("path", { class: "rug", "aria-hidden": "true" }, group);
    this.marks = made("path", { class: "rug-mark", "aria-hidden": "true" }, group);
    hear("entries", (entries) => { changed(Object.assign(this, entries ?? { entry: [] })); }, signal);
    hear("sites", (sites) => { changed(this.sites = sites); }, signal);
  }

  // Marks the sites whose tick is under the pointer: a level of heights has one tick.
  follow(at, view, scale) {
    const on = at && at.y >= view.bottom - NEAR && at.y <= view.bottom + LENGTH + NEAR;
    const away = this.entry.map((load) => (on && load !== null ? Math.abs(view.px(scale * load) - at.x) : Infinity));
    const least = Math.min(NEAR, ...away) + 0.5;
    const sites = [...away.keys()].filter((i) => away[i] < least && away[i] <= NEAR);
    if (sites.join() === this.pointed) return;
    this.pointed = sites.join();
    tell("sites", sites);
  }

  // Returns in words what the marked ticks are.
  draw(view, { load_scale: scale, x: { unit } }) {
    const ticks = (loads, length) => loads.filter((load) => load !== null && view.x.has(scale * load))
      .map((load) => `M${view.px(scale * load).toFixed(1)} ${view.bottom}v${length}`).join("");
    set(this.ticks, { d: ticks(this.entry, LENGTH) });
    const marked = this.sites.map((site) => this.entry[site] ?? null).filter((load) => load !== null);
    set(this.marks, { d: ticks(marked, MARKED) });
    if (!marked.length) return "";
    const who = marked.length === 1 ? `site ${this.sites[0] + 1} comes` : `${marked.length} sites come`;
    return `${who} into contact at ${this.exact ? "" : "about "}${Number((scale * marked[0]).toPrecision(3))} ${unit}`;
  }
}

export class Cursor {
  over = null; // where the pointer is [px], or null
  held = null; // the pointer that drags the load, or null
  chosen = new Chosen();
  x = null;

  constructor(plot, group, readout, signal) {
    this.plot = plot;
    this.readout = readout;
    this.rug = new Rug(group, () => this.draw(), signal);
    hear("load", (to) => this.take(to), signal);
    this.hair = made("line", { class: "hair", "aria-hidden": "true" }, group);
    this.dot = made("circle", { class: "hair-dot", r: 4, "aria-hidden": "true" }, group);
    this.line = made("line", { class: "load", "aria-hidden": "true" }, group);
    this.reached = made("circle", { class: "load-dot", r: 5, "aria-hidden": "true" }, group);
    this.knob = made("g", { class: "load-knob", tabindex: 0, role: "slider" }, group);
    // below the axis, so that it does not cover a point there
    made("rect", { class: "touch", x: -22, y: 0, width: 44, height: 44 }, this.knob);
    made("path", { class: "mark", d: "M0 0L6 9H-6Z" }, this.knob);
    this.knob.addEventListener("pointerdown", (event) => {
      event.stopPropagation();
      this.held = event.pointerId;
      plot.svg.setPointerCapture(event.pointerId);
    });
    this.knob.addEventListener("keydown", (event) => {
      if (!ARROWS[event.key]) return;
      const [right, up] = ARROWS[event.key];
      event.preventDefault();
      const { view } = plot;
      this.choose(this.load + ((right + up) * (event.shiftKey ? LONG : 1) * view.x.span) / STEPS);
    });
  }

  // The load at which contacts are shown: the chosen one, or the last of the law.
  get load() { return this.x ?? this.plot.data?.achieved?.x.at(-1) ?? null; }

  // Where it is on the achieved law.
  get mark() { return { x: this.load, y: valueAt(this.plot.data.achieved, this.load) }; }

  follow(event) {
    if (this.held !== event.pointerId) return false;
    this.choose(this.plot.view.x.at(this.plot.pointOf(event).x), true);
    return true;
  }

  release() {
    if (this.held !== null) this.choose(this.load);
    this.held = null;
  }

  choose(x, moving = false) {
    const { data, view } = this.plot;
    const law = data?.achieved;
    if (law) tell("load", { load: view.x.rounded(Math.min(law.x.at(-1), Math.max(law.x[0], x))) / data.load_scale, moving });
  }

  // A load that was chosen here or beside the surface. The server computes the contacts where it stays.
  take(to) {
    const { data } = this.plot;
    if (!data?.achieved) return;
    this.chosen.take(to);
    this.x = to.load * data.load_scale;
    if (!to.moving) this.plot.emit("cursor", { x: this.x });
    this.draw();
  }

  values(x) { return this.plot.words({ x, y: valueAt(this.plot.data.achieved, x) }); }

  // Puts a line and a dot at a load, or hides those for which there is no place.
  place(line, dot, x, y) {
    const { view } = this.plot;
    const px = view.px(x ?? 0);
    set(line, { x1: px, x2: px, y1: MARGIN.top, y2: view.bottom, visibility: x === null ? "hidden" : null });
    set(dot, { cx: px, cy: view.py(y ?? 0), visibility: y === null ? "hidden" : null });
  }

  draw() {
    const { view, data } = this.plot;
    if (!data) return;
    const inside = this.over && this.over.x >= MARGIN.left && this.over.x <= view.right;
    const x = inside ? view.x.at(this.over.x) : null;
    const y = inside ? valueAt(data.achieved, x) : null;
    this.place(this.hair, this.dot, x, view.y.has(y) ? y : null);
    this.rug.follow(this.over, view, data.load_scale);
    const entry = this.rug.draw(view, data);
    this.readout.textContent = entry || (inside ? `${this.values(x)}${y === null ? "" : " (achieved law)"}` : "");
    const load = this.load;
    const shown = view.x.has(load);
    this.place(this.line, this.reached, shown ? load : null, shown && view.y.has(this.mark.y) ? this.mark.y : null);
    set(this.knob, {
      transform: `translate(${view.px(load ?? 0).toFixed(2)} ${view.bottom})`, visibility: shown ? null : "hidden",
      "aria-label": "load at which contacts are shown", "aria-valuenow": load ?? 0, "aria-valuemin": 0,
      "aria-valuetext": load === null ? "" : this.values(load),
    });
  }
}
