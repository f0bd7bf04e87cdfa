// The map of the sites: draws them, finds the one under the pointer, moves between them by keys.
import { made, set } from "metafem-law/svg.js";
import { colouring } from "./colours.js";
import { drawAxes, drawBar, viewOf } from "./frame.js";
import { MARKER, MOST_ELEMENTS, PixelMarks, SvgMarks } from "./marks.js";

// Fill of sites without a value, in both themes.
const PLAIN = { light: "rgb(236 239 242)", dark: "rgb(52 60 69)" };

// A drag that is shorter than this is a click [pixels].
const CLICK = 5;

export class SiteMap {
  // `on` has the functions hover(site), pick(sites, add), key(event).
  constructor(box, on) {
    this.on = on;
    this.canvas = document.createElement("canvas");
    this.svg = made("svg", { tabindex: 0, role: "application", "aria-roledescription": "map of the sites" });
    box.append(this.canvas, this.svg);
    [this.axes, this.bar] = [made("g", { class: "axes" }, this.svg), made("g", { class: "axes" }, this.svg)];
    this.marks = { svg: new SvgMarks(this.svg), canvas: new PixelMarks(this.canvas) };
    this.rectangle = made("rect", { class: "rectangle", visibility: "hidden" }, this.svg);
    this.selected = new Set();
    this.active = null;
    this.pointed = new Set(); // those under the pointer, here or at their tick of the law
    for (const name of ["pointerdown", "pointermove", "pointerup", "pointercancel", "pointerleave"]) {
      this.svg.addEventListener(name, (event) => this[name](event));
    }
    this.svg.addEventListener("keydown", (event) => this.on.key(event));
    this.box = box;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height || !this.layout) return;
    this.view = viewOf(this.layout, width, height);
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const many = this.layout.x.length > MOST_ELEMENTS;
    const [used, other] = many ? [this.marks.canvas, this.marks.svg] : [this.marks.svg, this.marks.canvas];
    other.clear();
    this.used = used;
    used.place(this.layout, this.view, width, height);
    drawAxes(this.axes, this.view);
    this.draw();
  }

  // The data of the server; `contacts` may be those of the surface before for some milliseconds.
  show(layout, surface, contacts, look) {
    const placed = this.layout === layout && this.view;
    Object.assign(this, { layout, surface, contacts, look });
    if (placed) this.draw(); else this.resize();
  }

  draw() {
    if (!this.surface || !this.view) return;
    const { surface, contacts, view, selected, look: { dark, spread } } = this;
    const colours = colouring(surface, contacts, this.look);
    const disc = contacts?.radius ? (i) => view.scale * (contacts.radius[i] ?? 0) : () => 0;
    this.used.draw((i) => {
      const height = surface.height[i];
      const names = ["site"];
      if (height === null) names.push("empty");
      if (surface.empty.has(i)) names.push("asked");
      if (surface.pinned[i] !== undefined) names.push("pinned");
      if (selected.has(i)) names.push("selected");
      if (this.active === i || this.pointed.has(i)) names.push("active");
      const fill = colours.shown(i) ? colours.scale.css(colours.values[i]) : height === null ? "none" : dark ? PLAIN.dark : PLAIN.light;
      return { fill, classes: names.join(" "), contact: height === null ? 0 : disc(i) };
    });
    const { name, scale, present } = colours;
    const drawn = scale && [name, scale.low, scale.high, dark, spread, view.bar.top, view.bar.bottom, view.box.right, ...present].join();
    if (drawn !== this.drawnBar) drawBar(this.bar, view, colours);
    this.drawnBar = drawn;
  }

  // Site under a point of the window, null if there is none.
  siteAt(event) {
    if (!this.view) return null;
    const { left, top } = this.svg.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top];
    const reach = Math.max(MARKER * this.layout.spacing * this.view.scale, 12);
    let [best, least] = [null, reach ** 2];
    this.layout.x.forEach((each, i) => {
      const square = (this.view.px(each) - x) ** 2 + (this.view.py(this.layout.y[i]) - y) ** 2;
      if (square < least) [best, least] = [i, square];
    });
    return best;
  }

  // Next site in a direction: the nearest within 45 degrees of it.
  next(right, up) {
    const { x, y } = this.layout;
    if (this.active === null) return x.length ? 0 : null;
    let [best, least] = [this.active, Infinity];
    x.forEach((each, i) => {
      const [dx, dy] = [each - x[this.active], y[i] - y[this.active]];
      const [along, beside] = [dx * right + dy * up, Math.abs(dx * up) + Math.abs(dy * right)];
      const distance = along + 2 * beside;
      if (along > 1e-9 * this.layout.spacing && beside <= along && distance < least) [best, least] = [i, distance];
    });
    return best;
  }

  pointerdown(event) {
    if (event.button) return;
    this.from = { x: event.clientX, y: event.clientY, mouse: event.pointerType === "mouse" };
    if (this.from.mouse) this.svg.setPointerCapture(event.pointerId);
  }

  pointermove(event) {
    const moved = this.from?.mouse && Math.hypot(event.clientX - this.from.x, event.clientY - this.from.y) > CLICK;
    if (!moved && !this.drawn) { if (!this.from) this.on.hover(this.siteAt(event), event); return; }
    const { left, top } = this.svg.getBoundingClientRect();
    const [x, y] = [Math.min(event.clientX, this.from.x) - left, Math.min(event.clientY, this.from.y) - top];
    this.drawn = { x, y, width: Math.abs(event.clientX - this.from.x), height: Math.abs(event.clientY - this.from.y) };
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

  pointerleave() { this.on.hover(null); }
}
