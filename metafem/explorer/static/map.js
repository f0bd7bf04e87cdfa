// The axes and the scale of the map, and the bar of its colours.
import { colouring, digits, range } from "./contacts.js";
import { label, made, set, ticks } from "./view.js";

const [LEFT, BOTTOM, TOP, BAR, ASIDE] = [38, 34, 8, 104, 29];

// Part of the least distance between sites that is free around them.
const EDGE = 0.62;

// Least height of the bar of colours [pixels].
const LEAST_BAR = 180;

// Widths of the colours and of the most frequent class of the histogram [pixels], and number of classes.
const [COLOURS, FREQUENT, CLASSES] = [10, 22, 48];

// The view of the map: one scale for both directions.
export function viewOf(layout, width, height) {
  const edge = EDGE * layout.spacing;
  const [[west, east], [south, north]] = [range(layout.x), range(layout.y)];
  const [across, along] = [east - west + 2 * edge, north - south + 2 * edge];
  const scale = Math.max(1e-9, Math.min((width - LEFT - BAR) / across, (height - TOP - BOTTOM) / along));
  const left = LEFT + Math.max(0, (width - LEFT - BAR - scale * across) / 2);
  const top = TOP + Math.max(0, (height - TOP - BOTTOM - scale * along) / 2);
  const box = { left, top, right: left + scale * across, bottom: top + scale * along };
  const tall = Math.max(scale * along, Math.min(LEAST_BAR, height - TOP - BOTTOM)); // a map of one row is lower
  const above = Math.max(TOP, top + (scale * along - tall) / 2);
  const bar = { top: above, bottom: above + Math.max(0, tall) };
  const [x, y] = [west - edge, south - edge];
  return { box, range: [x, east + edge, y, north + edge], scale, bar, px: (each) => box.left + scale * (each - x), py: (each) => box.bottom - scale * (each - y) };
}

function upward(words, x, y, parent) { label(words, x, y, "middle", parent).setAttribute("transform", `rotate(-90 ${x} ${y})`); }

export function drawAxes(parent, view) {
  parent.replaceChildren();
  const { left, top, right, bottom } = view.box;
  const [west, east, south, north] = view.range;
  made("rect", { x: left, y: top, width: right - left, height: bottom - top, class: "frame" }, parent);
  const room = (pixels) => Math.max(2, Math.min(8, Math.floor(pixels / 45)));
  for (const x of ticks(west, east, room(right - left)).values) label(digits(x), view.px(x), bottom + 14, "middle", parent);
  for (const y of ticks(south, north, room(bottom - top)).values) label(digits(y), left - 5, view.py(y) + 4, "end", parent);
  label("x [mm]", (left + right) / 2, bottom + 29, "middle", parent);
  upward("y [mm]", left - ASIDE, (top + bottom) / 2, parent);
}

// The power of ten that is left out of the numbers of a bar, where they would be too long for it.
const powerOf = (most) => (most > 0 && (most < 0.01 || most >= 1e5) ? Math.floor(Math.log10(most)) : 0);

const superscript = (power) => String(power).replace("-", "⁻").replace(/\d/g, (digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);

export function drawBar(parent, view, colours) {
  parent.replaceChildren();
  if (!colours.scale) return;
  const { low, high, css } = colours.scale;
  const { top, bottom } = view.bar;
  const x = view.box.right + 12;
  const counts = new Array(CLASSES).fill(0);
  for (const value of colours.present) counts[Math.min(CLASSES - 1, Math.floor((CLASSES * (value - low)) / (high - low || 1)))] += 1;
  const [height, most] = [(bottom - top) / CLASSES, Math.max(1, ...counts)];
  counts.forEach((count, i) => {
    const place = { x, y: bottom - (i + 1) * height, height: height + 0.5, width: COLOURS };
    made("rect", { ...place, fill: css(low + ((i + 0.5) / CLASSES) * (high - low)) }, parent);
    if (count) made("rect", { ...place, class: "count", x: x + COLOURS, width: (FREQUENT * count) / most }, parent);
  });
  const right = x + COLOURS + FREQUENT;
  const power = powerOf(Math.max(Math.abs(low), Math.abs(high)));
  if (high > low) {
    for (const value of ticks(low, high, 5).values) label(digits(value / 10 ** power), right + 4, bottom - ((value - low) / (high - low)) * (bottom - top) + 4, "start", parent);
  }
  const unit = power ? `10${superscript(power)} ${colours.unit}` : colours.unit;
  upward(`${colours.name} [${unit}]`, right + 52, (top + bottom) / 2, parent);
}

// The sites of the map: as SVG, or on a canvas where there are too many for elements.

// Above this number a redraw of SVG takes longer than a frame of a slow machine.
export const MOST_ELEMENTS = 2000;

// A marker covers this share of the least distance between sites.
export const MARKER = 0.42;

// A site whose marker has the radius 1: its lines are as wide at any scale.
const SITE = '<circle class="marker" r="1"/><circle class="contact" r="0"/><path class="cross" d="M-.45-.45L.45.45M-.45.45L.45-.45"/><path class="pin" d="M.75-1.05l.3.3-.3.3-.3-.3z"/>';

export class SvgMarks {
  constructor(svg) { this.group = made("g", {}, svg); }

  place(layout, view) {
    this.scale = Math.max(1.5, MARKER * layout.spacing * view.scale);
    const site = (x, i) => `<g data-site="${i}" transform="translate(${view.px(x)} ${view.py(layout.y[i])}) scale(${this.scale})">${SITE}</g>`;
    this.group.innerHTML = layout.x.map(site).join("");
  }

  clear() { this.group.replaceChildren(); }

  // `look(i)`: fill, classes and the radius of the contact [pixels] of a site.
  draw(look) {
    [...this.group.children].forEach((site, i) => {
      const { fill, classes, contact } = look(i);
      const [marker, disc] = site.children;
      set(site, { class: classes });
      set(marker, { fill });
      set(disc, { r: contact / this.scale });
    });
  }
}

// Cells below this size [pixels] fill the map without gaps.
const GAPLESS = 8;

// Smallest radius of a contact that is drawn [pixels].
const SEEN = 0.5;

// A square for each site, its contact as a disc.
export class PixelMarks {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }

  place(layout, view, width, height) {
    const fine = window.devicePixelRatio || 1;
    Object.assign(this.canvas, { width: fine * width, height: fine * height });
    this.context.scale(fine, fine);
    const cell = layout.spacing * view.scale;
    this.side = cell < GAPLESS ? cell + 1 / fine : 2 * MARKER * cell;
    this.at = layout.x.map((x, i) => [view.px(x), view.py(layout.y[i])]);
  }

  clear() {
    this.canvas.width = 0;
    this.at = [];
  }

  // `look(i)`: fill, classes and the radius of the contact [pixels] of a site. Empty and selected sites have frames,
  // kept ones corners.
  draw(look) {
    const { canvas, context, side, at } = this;
    context.clearRect(0, 0, canvas.width, canvas.height);
    const style = getComputedStyle(canvas);
    const [ink, accent, faint] = ["--ink", "--accent", "--faint"].map((name) => style.getPropertyValue(name));
    at.forEach(([x, y], i) => {
      const { fill, classes, contact } = look(i);
      const [left, top] = [x - side / 2, y - side / 2];
      context.fillStyle = fill;
      if (fill !== "none") context.fillRect(left, top, side, side);
      if (contact > SEEN) {
        context.fillStyle = "white";
        context.beginPath();
        context.arc(x, y, contact, 0, 2 * Math.PI);
        context.fill();
      }
      if (classes === "site") return;
      const chosen = /selected|active/.test(classes);
      context.lineWidth = chosen ? 2 : 1;
      context.strokeStyle = chosen ? accent : classes.includes("asked") ? ink : faint;
      if (chosen || classes.includes("empty")) context.strokeRect(left + 0.5, top + 0.5, side - 1, side - 1);
      context.fillStyle = ink;
      if (classes.includes("pinned")) context.fillRect(x, top, side / 2, side / 2);
    });
  }
}

// The map of the sites: draws them, finds the one under the pointer, and those in a rectangle.

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
