// Ticks below the load axis: the loads at which the sites come into contact.
import { hear, tell } from "./linked.js";
import { made, set } from "./svg.js";

// Length of a tick, of the marked one, and how near to it a pointer is on it [pixels].
const [LENGTH, MARKED, NEAR] = [7, 12, 4];

export class Rug {
  entry = [];
  site = null; // the one that is marked
  pointed = null; // the one whose tick is under the pointer

  constructor(group, changed, signal) {
    this.ticks = made("path", { class: "rug", "aria-hidden": "true" }, group);
    this.mark = made("path", { class: "rug-mark", "aria-hidden": "true" }, group);
    hear("entries", (entries) => { changed(Object.assign(this, entries ?? { entry: [] })); }, signal);
    hear("site", (site) => { changed(this.site = site); }, signal);
  }

  // Marks the site whose tick is under the pointer.
  follow(at, view, scale) {
    const reach = at && at.y >= view.bottom - NEAR && at.y <= view.bottom + LENGTH + NEAR ? NEAR : 0;
    let [site, least] = [null, reach];
    this.entry.forEach((load, i) => {
      const away = load === null ? Infinity : Math.abs(view.px(scale * load) - at?.x);
      if (away < least) [site, least] = [i, away];
    });
    if (site === this.pointed) return;
    this.pointed = site;
    tell("site", site);
  }

  draw(view, { load_scale: scale, x: { unit } }) {
    const tick = (load, length) => `M${view.px(scale * load).toFixed(1)} ${view.bottom}v${length}`;
    const inside = this.entry.filter((load) => load !== null && scale * load <= view.x);
    set(this.ticks, { d: inside.map((load) => tick(load, LENGTH)).join("") });
    const load = this.entry[this.site] ?? null;
    const shown = load !== null && scale * load <= view.x;
    set(this.mark, { d: shown ? tick(load, MARKED) : "" });
    return shown ? `site ${this.site} comes into contact at ${this.exact ? "" : "about "}${Number((scale * load).toPrecision(3))} ${unit}` : "";
  }
}
