// The map of the sites: draws them, finds the one under the pointer, and those in a rectangle.
import { colouring, range } from "metafem/contacts.js";
import { Axis, digits, placeIn, PlotAxes } from "metafem/plot.js";

// What is free around the map; the title beside an axis, and the bar of colours below the other one [pixels].
const [MARGIN, BESIDE, BELOW] = [{ left: 44, right: 8, top: 8, bottom: 84 }, 33, 44];
// Part of the least distance between sites that is free around them, and that a marker covers.
const [EDGE, MARKER] = [0.62, 0.42];
// Smallest radius of a contact that is drawn, of what a pointer finds, and shortest drag that is no click [pixels].
const [SEEN, REACH, CLICK] = [0.5, 12, 5];

// Axes of one scale for both directions: of the block, or of the sites where there is none.
function framed({ x, y, spacing, block }, width, height) {
  const axes = [[x, block?.[0]], [y, block?.[1]]].map(([values, side]) => {
    const [low, high] = range(values);
    const ends = [low - EDGE * spacing, high + EDGE * spacing];
    return Object.assign(new Axis(), { low: Math.min(ends[0], -side / 2 || 0), high: Math.max(ends[1], side / 2 || 0) });
  });
  const [[across, along], room] = [axes, [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom]];
  const scale = Math.max(1e-9, Math.min(room[0] / across.span, room[1] / along.span));
  const left = MARGIN.left + (room[0] - scale * across.span) / 2;
  const top = MARGIN.top + (room[1] - scale * along.span) / 2;
  across.ends = [left, left + scale * across.span];
  along.ends = [top + scale * along.span, top];
  return { x: across, y: along, scale };
}

const HELP = "Map of the heights. Arrow keys move between the sites, with Shift they select. Enter opens the menu, p keeps the height, e leaves the site empty, r lets the design choose, Escape ends the selection.";

export default {
  template: `
    <div class="layer" ref="box"><canvas ref="canvas"></canvas>
      <svg ref="svg" tabindex="0" role="application" aria-roledescription="map of the sites" aria-label="${HELP}" @focus="from || $emit('enter')" @blur="$emit('hover', null)"
           @pointerdown="press" @pointermove="move" @pointerup="lift" @pointercancel="drop" @pointerleave="$emit('hover', null)" @keydown="$emit('key', $event)">
        <plot-axes v-if="frame" :x="frame.x" :y="frame.y" :titles="titles" :beside="${BESIDE}" :class="{ bare: !layout.block }"/>
        <rect v-if="drawn" class="rectangle" v-bind="drawn"/>
      </svg>
      <p v-if="frame && colours?.scale" class="colours small" :style="{ top: frame.y.ends[0] + ${BELOW} + 'px' }"><span>{{ digits(colours.scale.low) }}</span><i :style="{ background: colours.scale.gradient }"></i><span>{{ digits(colours.scale.high) }}</span><b>{{ colours.name }} [{{ colours.unit }}]</b></p>
    </div>`,
  components: { PlotAxes },
  props: { marks: Object }, // the sites that are pointed at, selected and active
  emits: ["hover", "pick", "key", "enter"],
  data() { return { frame: null, colours: null, drawn: null, layout: null, titles: ["x", "y"].map((label) => ({ label, unit: "mm" })), digits }; },
  methods: {
    // Takes the data of the server; `contacts` may be those of the surface before for some milliseconds.
    show(layout, surface, contacts, look) {
      const placed = this.layout === layout && this.frame;
      Object.assign(this, { layout: Object.freeze(layout), surface, contacts, colours: Object.freeze(colouring(surface, contacts, look)) });
      if (placed) this.mark(); else this.resize();
    },
    resize() {
      const { clientWidth: width, clientHeight: height } = this.$refs.box;
      if (!width || !height || !this.layout) return;
      this.frame = Object.freeze(framed(this.layout, width, height));
      this.mark();
    },
    // Draws the sites: filled, with their contacts to scale, and what was asked of them.
    mark() {
      if (!this.frame) return;
      const { $refs: { canvas, box }, layout, surface, contacts, colours, frame: { scale }, marks: { selected, active, pointed } } = this;
      const [context, fine, style] = [canvas.getContext("2d"), window.devicePixelRatio || 1, getComputedStyle(canvas)];
      const [ink, accent, faint, plain] = ["--ink", "--accent", "--faint", "--line"].map((name) => style.getPropertyValue(name));
      Object.assign(canvas, { width: fine * box.clientWidth, height: fine * box.clientHeight });
      context.scale(fine, fine);
      const size = Math.max(1, MARKER * layout.spacing * scale);
      const draw = (stroke, width, shape, fill = "transparent", dashes = []) => {
        Object.assign(context, { strokeStyle: stroke, lineWidth: width, fillStyle: fill });
        context.setLineDash(dashes);
        context.beginPath();
        shape();
        context.fill();
        context.stroke();
      };
      layout.x.forEach((_, i) => {
        const [[x, y], height] = [this.placeOf(i), surface.height[i]];
        const disc = (radius) => () => context.arc(x, y, radius, 0, 2 * Math.PI);
        const lines = (...points) => () => points.forEach(([right, down], k) => context[k % 2 ? "lineTo" : "moveTo"](x + right * size, y + down * size));
        const marked = selected.has(i) ? 3.5 : active === i || pointed.has(i) ? 2 : 0;
        const fill = colours.shown(i) ? colours.scale.css(colours.values[i]) : plain;
        draw(marked ? accent : faint, marked || 0.8, disc(size), height === null ? "transparent" : fill, height === null ? [3, 3] : []);
        const contact = height === null ? 0 : scale * (contacts?.radius?.[i] ?? 0);
        if (contact > SEEN) draw("#1f2933", 1, disc(contact), "#ffffffd9");
        if (surface.empty.has(i)) draw(faint, 1.2, lines([-0.45, -0.45], [0.45, 0.45], [-0.45, 0.45], [0.45, -0.45]));
        if (surface.pinned[i] !== undefined) draw(ink, 1, () => context.rect(x + 0.5 * size, y - size, 0.5 * size, 0.5 * size), ink);
      });
    },
    // Where a site is drawn.
    placeOf(i) { return [this.frame.x.px(this.layout.x[i]), this.frame.y.px(this.layout.y[i])]; },
    at(event) { return placeIn(this.$refs.svg, event); },
    // Site under a point of the window, null if there is none.
    siteAt(event) {
      if (!this.frame) return null;
      const { x, y } = this.at(event);
      const away = this.layout.x.map((_, i) => Math.hypot(this.placeOf(i)[0] - x, this.placeOf(i)[1] - y));
      const [least] = range(away);
      return least < Math.max(MARKER * this.layout.spacing * this.frame.scale, REACH) ? away.indexOf(least) : null;
    },
    press(event) {
      if (event.button) return;
      this.from = { at: this.at(event), mouse: event.pointerType === "mouse" };
      if (this.from.mouse) this.$refs.svg.setPointerCapture(event.pointerId);
    },
    move(event) {
      const { from } = this;
      if (!from) return this.$emit("hover", this.siteAt(event), event);
      const [{ x, y }, { x: x0, y: y0 }] = [this.at(event), from.at];
      if (!this.drawn && !(from.mouse && Math.hypot(x - x0, y - y0) > CLICK)) return;
      this.drawn = { x: Math.min(x, x0), y: Math.min(y, y0), width: Math.abs(x - x0), height: Math.abs(y - y0) };
    },
    lift(event) {
      if (!this.from) return;
      const { drawn } = this;
      const inside = (i) => this.placeOf(i).every((each, k) => each >= [drawn.x, drawn.y][k] && each <= [drawn.x + drawn.width, drawn.y + drawn.height][k]);
      const site = this.siteAt(event);
      this.$emit("pick", drawn ? [...this.layout.x.keys()].filter(inside) : site === null ? [] : [site], event.shiftKey);
      this.drop();
    },
    drop() { this.from = this.drawn = null; },
  },
};

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
