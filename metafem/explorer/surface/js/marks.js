// The sites of the map as SVG.
import { made, set } from "metafem-law/svg.js";

// Above this number a redraw of SVG takes longer than a frame of a slow machine.
export const MOST_ELEMENTS = 2000;

// A marker covers this share of the least distance between sites.
export const MARKER = 0.42;

export class SvgMarks {
  constructor(svg) {
    this.group = made("g", {}, svg);
    this.sites = [];
  }

  place(layout, view) {
    const r = Math.max(1.5, MARKER * layout.spacing * view.scale);
    if (this.sites.length !== layout.x.length) {
      this.group.replaceChildren();
      this.sites = layout.x.map((_, i) => {
        const group = made("g", { class: "site", "data-site": i }, this.group);
        const parts = { group, marker: made("circle", { class: "marker" }, group), contact: made("circle", { class: "contact", r: 0 }, group) };
        return { ...parts, cross: made("path", { class: "cross" }, group), pin: made("path", { class: "pin" }, group) };
      });
    }
    const [c, p] = [0.45 * r, Math.max(2.5, 0.26 * r)];
    this.sites.forEach((site, i) => {
      set(site.group, { transform: `translate(${view.px(layout.x[i])} ${view.py(layout.y[i])})` });
      set(site.marker, { r });
      set(site.cross, { d: `M${-c} ${-c}L${c} ${c}M${-c} ${c}L${c} ${-c}` });
      set(site.pin, { d: `M${0.75 * r} ${-0.75 * r - p}l${p} ${p}l${-p} ${p}l${-p} ${-p}z` });
    });
  }

  clear() {
    this.group.replaceChildren();
    this.sites = [];
  }

  // `look(i)`: fill, classes and the radius of the contact [pixels] of a site.
  draw(look) {
    this.sites.forEach((site, i) => {
      const { fill, classes, contact } = look(i);
      set(site.marker, { fill });
      set(site.group, { class: classes });
      set(site.contact, { r: contact });
    });
  }
}
