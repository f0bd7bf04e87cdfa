// The sites of the map as SVG.
import { made } from "metafem-law/svg.js";

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
        return { ...parts, cross: made("path", { class: "cross" }, group), pin: made("path", { class: "pin" }, group), seen: {} };
      });
    }
    const [c, p] = [0.45 * r, Math.max(2.5, 0.26 * r)];
    this.sites.forEach((site, i) => {
      site.group.setAttribute("transform", `translate(${view.px(layout.x[i])} ${view.py(layout.y[i])})`);
      site.marker.setAttribute("r", r);
      site.cross.setAttribute("d", `M${-c} ${-c}L${c} ${c}M${-c} ${c}L${c} ${-c}`);
      site.pin.setAttribute("d", `M${0.75 * r} ${-0.75 * r - p}l${p} ${p}l${-p} ${p}l${-p} ${-p}z`);
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
      const { seen } = site;
      if (seen.fill !== fill) site.marker.setAttribute("fill", (seen.fill = fill));
      if (seen.classes !== classes) site.group.setAttribute("class", (seen.classes = classes));
      if (seen.contact !== contact) site.contact.setAttribute("r", (seen.contact = contact));
    });
  }
}
