// A section along the row of sites through one of them: undeformed caps, cut off at the glass, with the contacts on it.
import { label, made, path } from "metafem-law/svg.js";
import { colouring } from "./colours.js";
import { capOf, digits, range } from "./contacts.js";
import { EDGE, Picture, drawAxes, viewIn } from "./frame.js";

// Margins [pixels].
const [LEFT, RIGHT, TOP, BOTTOM, ASIDE] = [54, 12, 40, 34, 38];

// Parts of the largest height that are free above it, and shown of the block.
const [ABOVE, BELOW] = [0.2, 0.12];

// Distance of sites at which their heights are written [pixels].
const ROOM = 34;

// A row is a strip as wide as the least distance between sites, without its borders, where the next rows of a lattice are.
const HALF = 0.5 - 1e-6;

export class Profile extends Picture {
  static title = "Profile of the heights through a row of sites";

  constructor(...given) {
    super(...given);
    this.svg.setAttribute("aria-roledescription", "profile through a row of sites");
    this.content = made("g", { class: "heights" }, this.svg);
    this.svg.append(this.axes);
    this.svg.addEventListener("pointermove", (event) => { if (!event.buttons) this.on.hover(this.siteAt(event), event); });
    this.svg.addEventListener("click", (event) => this.on.pick([this.siteAt(event)].filter((each) => each !== null), event.shiftKey));
  }

  // A site of the row to show: one that is pointed at, else the active one, else of the row that is shown, else the highest.
  get first() {
    const { marks: { pointed, active }, surface: { height } } = this;
    const [site = active] = pointed;
    return site ?? this.row?.[0] ?? height.indexOf(range(height)[1]);
  }

  place(width, height) { Object.assign(this, { size: [width, height], row: null }); }

  mark() {
    if (!this.size || !this.surface) return;
    const { first, layout: { x, y, spacing }, surface } = this;
    if (!this.row?.includes(first)) {
      this.row = [...x.keys()].filter((i) => Math.abs(y[i] - y[first]) < HALF * spacing).sort((i, j) => x[i] - x[j]);
      this.y = y[first];
    }
    const most = Math.max(surface.limits[1], ...this.row.map((i) => surface.height[i]));
    const [[west, east], [width, height], edge] = [range(x), this.size, EDGE * spacing];
    const box = { left: LEFT, top: TOP, right: width - RIGHT, bottom: height - BOTTOM };
    this.view = viewIn(box, [west - edge, east + edge, -BELOW * most, (1 + ABOVE) * most], ASIDE);
    drawAxes(this.axes, this.view, "height [µm]");
    this.draw();
  }

  draw() {
    const { content, contacts, surface, row, layout, marks, view, view: { box, px, py, wide, tall, range: [,, low, high] } } = this;
    content.replaceChildren();
    const colours = colouring(surface, contacts, this.look);
    const glass = Math.max(0, contacts?.separation ?? Infinity);
    const filled = row.filter((i) => surface.height[i] !== null);
    const outline = (i, top) => {
      const [{ across, depth, scale }, height] = [capOf(surface, i), surface.height[i]];
      const right = across.map((each, k) => [scale * each, Math.max(low / 2, Math.min(top, height - 1e3 * scale * depth[k]))]);
      const all = [...right.map(([width, z]) => [-width, z]).reverse(), ...right];
      return path(view, { x: all.map(([width]) => layout.x[i] + width), y: all.map(([, z]) => z) });
    };
    for (const i of filled) {
      const chosen = marks.active === i || marks.pointed.has(i) || marks.selected.has(i);
      if (surface.height[i] > glass) made("path", { class: "whole", d: outline(i, Infinity) }, content);
      const fill = colours.shown(i) ? colours.scale.css(colours.values[i]) : "var(--faint)";
      made("path", { class: `cap${chosen ? " chosen" : ""}`, "data-row-site": i, d: outline(i, glass), fill }, content);
    }
    made("rect", { class: "base", x: box.left, y: py(0), width: box.right - box.left, height: py(low) - py(0) }, content);
    if (glass < high) {
      made("rect", { class: "glass", x: box.left, y: py(high), width: box.right - box.left, height: py(glass) - py(high) }, content);
      made("path", { class: "pane", d: `M${box.left} ${py(glass)}H${box.right}` }, content);
    }
    for (const i of filled) {
      const radius = contacts?.radius?.[i];
      if (radius) made("path", { class: "touch", d: `M${px(layout.x[i] - radius)} ${py(glass)}H${px(layout.x[i] + radius)}` }, content);
      if (wide * layout.spacing > ROOM) label(surface.height[i].toFixed(1), px(layout.x[i]), py(surface.height[i]) - 5, "middle", content);
    }
    label(`y = ${digits(this.y)} mm, heights × ${digits((1e3 * tall) / wide, 2)}`, box.right, TOP - 16, "end", content);
  }

  // Site nearest to the place of an event along the row, null beside the sites.
  siteAt(event) {
    if (!this.view) return null;
    const [[x], { layout, view, row }] = [this.at(event), this];
    const away = (i) => Math.abs(view.px(layout.x[i]) - x);
    const best = row.reduce((one, other) => (away(other) < away(one) ? other : one));
    return away(best) <= view.px(layout.spacing) - view.px(0) ? best : null;
  }

  // Where a site is drawn.
  placeOf(i) { return [this.view.px(this.layout.x[i]), this.view.py(this.surface.height[i] ?? 0)]; }
}
