// The axes: the mapping between the units that are shown and pixels. They begin at 0, or elsewhere when they are zoomed.
export const MARGIN = { left: 62, right: 16, top: 12, bottom: 46 };

// Free space beyond the farthest point, and the part of an axis below which the axis is shortened.
const [SPARE, EMPTY] = [1.08, 0.55];
// Growth of an axis each time that a point is moved beyond its end, and the part of the axis where the end begins.
const [GROWTH, EDGE] = [1.04, 0.985];
// The smallest and the largest part of the fitted axes that a zoom shows; `panel.py` has the smallest, too.
const [LEAST, MOST] = [1e-3, 10];

class Axis {
  low = 0;
  high = 1;
  fitted = 1; // its end where it was fitted last
  ends = [0, 1]; // where it begins and ends [pixels]

  get span() { return this.high - this.low; }

  // What a pixel is.
  get pixel() { return this.span / Math.max(1, Math.abs(this.ends[1] - this.ends[0])); }

  px(value) { return this.ends[0] + ((value - this.low) / this.span) * (this.ends[1] - this.ends[0]); }
  at(px) { return this.low + ((px - this.ends[0]) / (this.ends[1] - this.ends[0])) * this.span; }
  has(value) { return value !== null && value >= this.low && value <= this.high; }

  // A value without digits that no pixel resolves.
  rounded(value) {
    const power = Math.floor(Math.log10(this.pixel));
    return power < 0 ? Number(value.toFixed(Math.min(100, -power))) : Math.round(value / 10 ** power) * 10 ** power;
  }

  // Shows all values; stays as it is while they fill it, unless `fresh`.
  fit(values, fresh) {
    const most = values.reduce((most, each) => (each !== null && each > most ? each : most), 0) * SPARE || 1;
    if (fresh || most > this.high || most < EMPTY * this.high) Object.assign(this, { low: 0, high: most, fitted: most });
  }

  // Shows a part that begins at a value; loads and frictions are not negative.
  shift(low, span = this.span) {
    this.low = Math.max(0, low);
    this.high = this.low + span;
  }

  // Becomes longer where a point is moved to its end.
  grow(value) {
    const [end, more] = [(1 - EDGE) * this.span, (GROWTH - 1) * this.span];
    if (value >= this.high - end) this.high += more;
    else if (value <= this.low + end) this.low = Math.max(0, this.low - more);
  }
}

export class View {
  x = new Axis();
  y = new Axis();
  unit = null;
  zoomed = false;

  constructor() { this.resize(640, 400); }

  resize(width, height) {
    Object.assign(this, { width, height, right: width - MARGIN.right, bottom: height - MARGIN.bottom });
    this.x.ends = [MARGIN.left, this.right];
    this.y.ends = [this.bottom, MARGIN.top];
  }

  px(x) { return this.x.px(x); }
  py(y) { return this.y.px(y); }
  has({ x, y }) { return this.x.has(x) && this.y.has(y); }

  // Shows all points; zoomed axes stay as they are.
  fit(xs, ys, unit) {
    const fresh = unit !== this.unit;
    this.unit = unit;
    if (this.zoomed && !fresh) return;
    this.zoomed = false;
    this.x.fit(xs, fresh);
    this.y.fit(ys, fresh);
  }

  // The part of the fitted axes that is shown.
  get part() { return Math.min(this.x.span / this.x.fitted, this.y.span / this.y.fitted); }

  // Shows another part of the axes; a place [px] stays where it is.
  zoom(factor, at) {
    if (factor * this.part < LEAST || factor * this.part > MOST) return;
    this.zoomed = true;
    for (const axis of ["x", "y"]) {
      const value = this[axis].at(at[axis]);
      this[axis].shift(value - (value - this[axis].low) * factor, this[axis].span * factor);
    }
  }

  // Moves the axes so that a place is in their middle, if it is not shown.
  show(place) {
    for (const axis of ["x", "y"]) if (!this[axis].has(place[axis])) this[axis].shift(place[axis] - this[axis].span / 2);
  }
}
