// The sites of the map as pixels, where there are too many for elements: a square for each, its contact as a disc.
import { MARKER } from "./marks.js";

// Cells below this size fill the map without gaps, whose widths would differ by a pixel.
const GAPLESS = 8;

const CONTACT = packed("rgb(255 255 255)");

// A colour as one number of a pixel: red in the lowest byte.
function packed(css) {
  const [red, green, blue] = css.match(/[\d.]+/g).map(Number);
  return (0xff000000 | (blue << 16) | (green << 8) | red) >>> 0;
}

export class PixelMarks {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.colours = new Map();
  }

  place(layout, view, width, height) {
    this.fine = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.fine * width);
    this.canvas.height = Math.round(this.fine * height);
    const cell = layout.spacing * view.scale * this.fine;
    this.side = Math.max(1, cell < GAPLESS ? Math.ceil(cell) : Math.round(2 * MARKER * cell));
    const start = (at) => Math.round(this.fine * at - this.side / 2);
    this.at = layout.x.map((x, i) => [start(view.px(x)), start(view.py(layout.y[i]))]);
  }

  clear() {
    this.canvas.width = 0;
    this.at = [];
  }

  // `look(i)`: fill, classes and the radius of the contact [pixels] of a site.
  draw(look) {
    const { canvas: { width, height }, context, side, at, fine } = this;
    if (!width || !height) return;
    const image = context.createImageData(width, height);
    const pixels = new Uint32Array(image.data.buffer);
    const marked = [];
    at.forEach(([left, top], i) => {
      const { fill, classes, contact } = look(i);
      if (classes !== "site") marked.push([left, top, classes]);
      if (fill !== "none") square(pixels, width, left, top, side, this.number(fill));
      if (contact * fine > 0.7) disc(pixels, width, left + side / 2, top + side / 2, contact * fine);
    });
    context.putImageData(image, 0, 0);
    this.mark(marked);
  }

  number(css) {
    if (!this.colours.has(css)) this.colours.set(css, packed(css));
    return this.colours.get(css);
  }

  // Frames of empty and selected sites, and corners of kept ones.
  mark(marked) {
    const { context, side } = this;
    const style = getComputedStyle(this.canvas);
    const [ink, accent, faint] = ["--ink", "--accent", "--faint"].map((name) => style.getPropertyValue(name));
    for (const [left, top, classes] of marked) {
      const chosen = /selected|active/.test(classes);
      context.lineWidth = chosen ? 2 : 1;
      context.strokeStyle = chosen ? accent : classes.includes("asked") ? ink : faint;
      if (chosen || classes.includes("empty")) context.strokeRect(left + 0.5, top + 0.5, side - 1, side - 1);
      const corner = Math.ceil(side / 2);
      context.fillStyle = ink;
      if (classes.includes("pinned")) context.fillRect(left + side - corner, top, corner, corner);
    }
  }
}

function square(pixels, width, left, top, side, colour) {
  for (let row = top; row < top + side; row++) pixels.fill(colour, row * width + left, row * width + left + side);
}

function disc(pixels, width, x, y, radius) {
  for (let row = Math.ceil(y - radius - 0.5); row + 0.5 <= y + radius; row++) {
    const half = Math.sqrt(Math.max(0, radius ** 2 - (row + 0.5 - y) ** 2));
    pixels.fill(CONTACT, row * width + Math.round(x - half), row * width + Math.round(x + half));
  }
}
