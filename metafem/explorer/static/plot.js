// What the law and the map draw with: axes between values and pixels, and curves as paths.

// Free space beyond the farthest point, and the part of an axis below which the axis is shortened.
const [SPARE, EMPTY] = [1.08, 0.55];
// Growth of an axis each time that a point is moved beyond its end, and the part of the axis where the end begins.
const [GROWTH, EDGE] = [1.04, 0.985];

// An axis of the law begins at 0, or elsewhere when it is zoomed.
export class Axis {
  low = 0;
  high = 1;
  fitted = 1; // its end where it was fitted last
  ends = [0, 1]; // where it begins and ends [pixels]

  get span() { return this.high - this.low; }

  // Its length and its middle [pixels], and what a pixel is.
  get length() { return Math.abs(this.ends[1] - this.ends[0]); }
  get middle() { return (this.ends[0] + this.ends[1]) / 2; }
  get pixel() { return this.span / Math.max(1, this.length); }

  // The function from values to pixels.
  get px() {
    const [{ low, span }, [from, to]] = [this, this.ends];
    return (value) => from + ((value - low) / span) * (to - from);
  }

  at(px) { return this.low + ((px - this.ends[0]) / (this.ends[1] - this.ends[0])) * this.span; }
  has(value) { return value !== null && value >= this.low && value <= this.high; }

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

  // Shows so many times as much; the value at a pixel stays where it is.
  zoom(factor, px) {
    const value = this.at(px);
    this.shift(value - (value - this.low) * factor, this.span * factor);
  }

  // Becomes longer where a point is moved to its end.
  grow(value) {
    const [end, more] = [(1 - EDGE) * this.span, (GROWTH - 1) * this.span];
    if (value >= this.high - end) this.high += more;
    else if (value <= this.low + end) this.low = Math.max(0, this.low - more);
  }
}

// Pixels for a number at an axis.
const BETWEEN = { x: 85, y: 48 };

// Two axes with a grid, their numbers, and their titles: the one of y is so many pixels beside the axis.
export const PlotAxes = {
  template: `
    <g class="axes" aria-hidden="true">
      <path class="grid" :d="grid"/><path class="frame" :d="frame"/>
      <text v-for="each in marks.x" :x="x.px(each.value)" :y="y.ends[0] + 20" text-anchor="middle">{{ each.words }}</text>
      <text v-for="each in marks.y" :x="x.ends[0] - 7" :y="y.px(each.value) + 4" text-anchor="end">{{ each.words }}</text>
      <text v-for="({ label, unit, meaning }, i) in titles" class="title" text-anchor="middle" :transform="places[i]">{{ label }} [{{ unit }}]<title v-if="meaning">{{ meaning }}</title></text>
    </g>`,
  props: { x: Object, y: Object, titles: Array, beside: Number },
  computed: {
    marks() {
      return Object.fromEntries(["x", "y"].map((name) => [name, ticks(this[name].low, this[name].high, this[name].length / BETWEEN[name])]));
    },
    grid() {
      const { x, y, marks } = this;
      return [...marks.x.map(({ value }) => `M${x.px(value)} ${y.ends[1]}V${y.ends[0]}`), ...marks.y.map(({ value }) => `M${x.ends[0]} ${y.px(value)}H${x.ends[1]}`)].join("");
    },
    frame() {
      const { x: { ends: [left, right] }, y: { ends: [bottom, top] } } = this;
      return `M${left} ${top}V${bottom}H${right}V${top}Z`;
    },
    places() {
      const { x, y } = this;
      return [`translate(${x.middle} ${y.ends[0] + 38})`, `translate(${x.ends[0] - this.beside} ${y.middle}) rotate(-90)`];
    },
  },
};

// Round values within a range, at most about so many, with the number of decimals that tells them apart.
function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((each) => each * power >= rough) * power;
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return Array.from({ length: count }, (_, i) => ({ value: (first + i) * step, words: told((first + i) * step, step * 1.0001).replace("-", "−") }));
}

// A value for people: with the digits that so small a part of it resolves.
export const told = (value, least) => value.toFixed(Math.min(20, Math.max(0, -Math.floor(Math.log10(least)))));

// A value with so many digits.
export const digits = (value, count = 3) => Number(value.toPrecision(count)).toLocaleString("en", { maximumSignificantDigits: count, useGrouping: false }).replace("-", "−");

// Where an event is in an element [pixels].
export function placeIn(element, { clientX, clientY }) {
  const { left, top } = element.getBoundingClientRect();
  return { x: clientX - left, y: clientY - top };
}

// The value of a curve at x, on the line between its points; null outside and in a gap.
export function valueAt(curve, x) {
  if (!curve || !curve.x.length || x < curve.x[0] || x > curve.x.at(-1)) return null;
  const i = Math.max(1, curve.x.findIndex((each) => each >= x));
  const [x0, x1, y0, y1] = [curve.x[i - 1], curve.x[i] ?? curve.x[i - 1], curve.y[i - 1], curve.y[i] ?? curve.y[i - 1]];
  if ([x0, y0, y1].includes(null)) return null; // in a gap
  return x1 === x0 ? y1 : y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
}

// The path of a curve, with gaps where a value is missing; or of a square at each of its points.
export function path({ x, y }, px, py, loose = false) {
  let pen = "M";
  return x.map((each, i) => {
    if (each === null || y[i] === null) {
      pen = "M";
      return "";
    }
    const at = `${pen}${px(each).toFixed(1)} ${py(y[i]).toFixed(1)}`;
    if (loose) return `${at}m-3-3h6v6h-6z`;
    pen = "L";
    return at;
  }).join("");
}

// Where an infinite curve is drawn [pixels]: far above the picture.
const FAR = -1e4;

// The outline of an area between two curves.
export function area({ x, low, high }, px, py) {
  const corner = (value, i) => `${px(x[i]).toFixed(1)} ${value.toFixed(1)}`;
  const forth = high.map((each, i) => corner(each === null ? FAR : py(each), i));
  const back = low.map((each, i) => corner(py(each ?? 0), i)).reverse();
  return x.length ? `M${forth.join("L")}L${back.join("L")}Z` : "";
}
