// The sites of the map: as SVG, or on a canvas where there are too many for elements.
import { made, set } from "metafem-law/svg.js";

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
