// The axes: the mapping between the units that are shown and pixels. They begin at 0, or elsewhere when they are zoomed.
export const MARGIN = { left: 62, top: 12, bottom: 46 };

// Width of a plot from which on names stand beside its curves, and the right margin with and without them [pixels].
const [NAMED, NAMES, RIGHT] = [480, 84, 16];

// Free space beyond the farthest point, and the part of an axis below which the axis is shortened.
const [SPARE, EMPTY] = [1.08, 0.55];
// Growth of an axis each time that a point is moved beyond its end, and the part of the axis where the end begins.
const [GROWTH, EDGE] = [1.04, 0.985];
// The smallest and the largest part of the fitted axes that a zoom shows.
const [LEAST, MOST] = [1e-3, 10];

export class View {
  width = 640;
  height = 400;
  x = { low: 0, high: 1, fitted: 1 };
  y = { low: 0, high: 1, fitted: 1 };
  unit = null;
  zoomed = false;

  get named() { return this.width >= NAMED; }
  get right() { return this.width - (this.named ? NAMES : RIGHT); }
  get bottom() { return this.height - MARGIN.bottom; }
  get wide() { return Math.max(1, this.right - MARGIN.left); }
  get tall() { return Math.max(1, this.bottom - MARGIN.top); }

  // What a pixel is.
  get pixelX() { return span(this.x) / this.wide; }
  get pixelY() { return span(this.y) / this.tall; }

  px(x) { return MARGIN.left + (x - this.x.low) / this.pixelX; }
  py(y) { return this.bottom - (y - this.y.low) / this.pixelY; }
  atX(px) { return this.x.low + (px - MARGIN.left) * this.pixelX; }
  atY(py) { return this.y.low + (this.bottom - py) * this.pixelY; }

  // Values have no more digits than a pixel resolves.
  roundedX(x) { return rounded(x, this.pixelX); }
  roundedY(y) { return rounded(y, this.pixelY); }

  hasX(x) { return x !== null && x >= this.x.low && x <= this.x.high; }
  hasY(y) { return y !== null && y >= this.y.low && y <= this.y.high; }
  has({ x, y }) { return this.hasX(x) && this.hasY(y); }

  // Shows all points; the axes stay as they are while the points fill them, and while they are zoomed.
  fit(xs, ys, unit) {
    const fresh = unit !== this.unit;
    this.unit = unit;
    if (this.zoomed && !fresh) return;
    this.zoomed = false;
    for (const [axis, values] of [[this.x, xs], [this.y, ys]]) {
      const most = largest(values) * SPARE;
      const stays = !fresh && axis.low === 0 && most <= axis.high && most >= EMPTY * axis.high;
      if (!stays) Object.assign(axis, { low: 0, high: most || 1, fitted: most || 1 });
    }
  }

  // Shows another part of the axes; a place [px] stays where it is.
  zoom(factor, at) {
    const part = (factor * span(this.x)) / this.x.fitted;
    if (part < LEAST || part > MOST) return;
    this.zoomed = true;
    for (const [axis, value] of [[this.x, this.atX(at.x)], [this.y, this.atY(at.y)]]) {
      shift(axis, value - (value - axis.low) * factor, span(axis) * factor);
    }
  }

  // The part of the fitted axes that is shown.
  get part() { return Math.min(1, span(this.x) / this.x.fitted, span(this.y) / this.y.fitted); }

  // Moves the axes by pixels.
  pan(right, down) {
    this.zoomed = true;
    shift(this.x, this.x.low - right * this.pixelX, span(this.x));
    shift(this.y, this.y.low + down * this.pixelY, span(this.y));
  }

  // Moves the axes so that a place is in their middle, if it is not shown.
  show({ x, y }) {
    if (!this.hasX(x)) shift(this.x, x - span(this.x) / 2, span(this.x));
    if (!this.hasY(y)) shift(this.y, y - span(this.y) / 2, span(this.y));
  }

  // Longer axes where a point is moved to their end.
  grow({ x, y }) {
    for (const [axis, value] of [[this.x, x], [this.y, y]]) {
      const by = span(axis);
      if (value >= axis.high - (1 - EDGE) * by) axis.high += (GROWTH - 1) * by;
      else if (value <= axis.low + (1 - EDGE) * by) axis.low = Math.max(0, axis.low - (GROWTH - 1) * by);
    }
  }
}

const span = (axis) => axis.high - axis.low;

// Loads and frictions are not negative.
function shift(axis, low, length) {
  axis.low = Math.max(0, low);
  axis.high = axis.low + length;
}

function largest(values) {
  return values.reduce((most, each) => (each !== null && each > most ? each : most), 0);
}

function rounded(value, pixel) {
  const power = Math.floor(Math.log10(pixel));
  return power < 0 ? Number(value.toFixed(Math.min(100, -power))) : Math.round(value / 10 ** power) * 10 ** power;
}
