// Ticks below the load axis: the loads at which the sites come into contact.
import { hear, tell } from "./linked.js";
import { made, set } from "./svg.js";

// Length of a tick, of a marked one, and how near to it a pointer is on it [pixels].
const [LENGTH, MARKED, NEAR] = [7, 12, 4];

export class Rug {
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
    const ticks = (loads, length) => loads.filter((load) => load !== null && scale * load <= view.x)
      .map((load) => `M${view.px(scale * load).toFixed(1)} ${view.bottom}v${length}`).join("");
    set(this.ticks, { d: ticks(this.entry, LENGTH) });
    const marked = this.sites.map((site) => this.entry[site] ?? null).filter((load) => load !== null);
    set(this.marks, { d: ticks(marked, MARKED) });
    if (!marked.length) return "";
    const who = marked.length === 1 ? `site ${this.sites[0]} comes` : `${marked.length} sites come`;
    return `${who} into contact at ${this.exact ? "" : "about "}${Number((scale * marked[0]).toPrecision(3))} ${unit}`;
  }
}
