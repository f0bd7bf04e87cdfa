// The map of the sites: draws them, finds the one under the pointer, and those in a rectangle.
import { made, set } from "metafem-law/svg.js";
import { colouring } from "./colours.js";
import { drawAxes, drawBar, viewOf } from "./frame.js";
import { MARKER, MOST_ELEMENTS, PixelMarks, SvgMarks } from "./marks.js";

// Fill of sites without a value, in both themes.
const PLAIN = { light: "rgb(236 239 242)", dark: "rgb(52 60 69)" };

// A drag that is shorter than this is a click [pixels].
const CLICK = 5;

export class SiteMap {
  // `marks` has the sites that are pointed at, selected and active; `on` the functions hover(site, event), pick(sites, add)
  // and key(event).
  constructor(box, marks, on) {
    Object.assign(this, { box, marks, on });
    this.canvas = document.createElement("canvas");
    this.svg = made("svg", { tabindex: 0, role: "application" });
    box.append(this.canvas, this.svg);
    this.axes = made("g", { class: "axes" }, this.svg);
    this.svg.addEventListener("keydown", (event) => on.key(event));
    this.svg.addEventListener("pointerleave", () => on.hover(null));
    this.svg.setAttribute("aria-roledescription", "map of the sites");
    this.bar = made("g", { class: "axes" }, this.svg);
    this.sites = { svg: new SvgMarks(this.svg), canvas: new PixelMarks(this.canvas) };
    this.rectangle = made("rect", { class: "rectangle", visibility: "hidden" }, this.svg);
    for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
      this.svg.addEventListener(name, (event) => this[name](event));
    }
  }

  // The data of the server; `contacts` may be those of the surface before for some milliseconds.
  show(layout, surface, contacts, look) {
    const placed = this.layout === layout && this.view;
    Object.assign(this, { layout, surface, contacts, look });
    if (placed) this.mark(); else this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height || !this.layout) return;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.view = viewOf(this.layout, width, height);
    const many = this.layout.x.length > MOST_ELEMENTS;
    const [used, other] = many ? [this.sites.canvas, this.sites.svg] : [this.sites.svg, this.sites.canvas];
    other.clear();
    this.used = used;
    used.place(this.layout, this.view, width, height);
    drawAxes(this.axes, this.view);
    this.mark();
  }

  // Place of an event in the picture.
  at(event) {
    const { left, top } = this.svg.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  mark() {
    if (!this.surface || !this.view) return;
    const { surface, contacts, view, marks: { selected, active, pointed }, look: { dark } } = this;
    const colours = colouring(surface, contacts, this.look);
    const disc = contacts?.radius ? (i) => view.scale * (contacts.radius[i] ?? 0) : () => 0;
    this.used.draw((i) => {
      const height = surface.height[i];
      const names = ["site"];
      if (height === null) names.push("empty");
      if (surface.empty.has(i)) names.push("asked");
      if (surface.pinned[i] !== undefined) names.push("pinned");
      if (selected.has(i)) names.push("selected");
      if (active === i || pointed.has(i)) names.push("active");
      const fill = colours.shown(i) ? colours.scale.css(colours.values[i]) : height === null ? "none" : dark ? PLAIN.dark : PLAIN.light;
      return { fill, classes: names.join(" "), contact: height === null ? 0 : disc(i) };
    });
    const { name, scale, present } = colours;
    const drawn = scale && [name, scale.low, scale.high, dark, view.bar.top, view.bar.bottom, view.box.right, ...present].join();
    if (drawn !== this.drawnBar) drawBar(this.bar, view, colours);
    this.drawnBar = drawn;
  }

  // Site under a point of the window, null if there is none.
  siteAt(event) {
    if (!this.view) return null;
    const [x, y] = this.at(event);
    const reach = Math.max(MARKER * this.layout.spacing * this.view.scale, 12);
    let [best, least] = [null, reach ** 2];
    this.layout.x.forEach((each, i) => {
      const square = (this.view.px(each) - x) ** 2 + (this.view.py(this.layout.y[i]) - y) ** 2;
      if (square < least) [best, least] = [i, square];
    });
    return best;
  }

  // Where a site is drawn.
  placeOf(i) { return [this.view.px(this.layout.x[i]), this.view.py(this.layout.y[i])]; }

  pointerdown(event) {
    if (event.button) return;
    this.from = { clientX: event.clientX, clientY: event.clientY, mouse: event.pointerType === "mouse" };
    if (this.from.mouse) this.svg.setPointerCapture(event.pointerId);
  }

  pointermove(event) {
    const moved = this.from?.mouse && Math.hypot(event.clientX - this.from.clientX, event.clientY - this.from.clientY) > CLICK;
    if (!moved && !this.drawn) { if (!this.from) this.on.hover(this.siteAt(event), event); return; }
    const [[x, y], [startX, startY]] = [this.at(event), this.at(this.from)];
    this.drawn = { x: Math.min(x, startX), y: Math.min(y, startY), width: Math.abs(x - startX), height: Math.abs(y - startY) };
    set(this.rectangle, { ...this.drawn, visibility: "visible" });
  }

  pointerup(event) {
    if (!this.from) return;
    if (this.drawn && this.view) {
      const { x, y, width, height } = this.drawn;
      const [px, py] = [this.layout.x.map(this.view.px), this.layout.y.map(this.view.py)];
      const inside = [...px.keys()].filter((i) => px[i] >= x && px[i] <= x + width && py[i] >= y && py[i] <= y + height);
      this.on.pick(inside, event.shiftKey);
    } else {
      const site = this.siteAt(event);
      this.on.pick(site === null ? [] : [site], event.shiftKey);
    }
    this.pointercancel();
  }

  pointercancel() {
    this.from = this.drawn = null;
    this.rectangle.setAttribute("visibility", "hidden");
  }
}

// Next site in a direction: the nearest within 45 degrees of it; the site itself if there is none.
export function neighbour({ x, y, spacing }, site, right, up) {
  let [best, least] = [site, Infinity];
  x.forEach((each, i) => {
    const [dx, dy] = [each - x[site], y[i] - y[site]];
    const [along, beside] = [dx * right + dy * up, Math.abs(dx * up) + Math.abs(dy * right)];
    const distance = along + 2 * beside;
    if (along > 1e-9 * spacing && beside <= along && distance < least) [best, least] = [i, distance];
  });
  return best;
}
