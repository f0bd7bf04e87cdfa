// The law: shows answers, and turns what hands and keys do into events. NiceGUI calls its methods.
import { Drags } from "metafem/drags.js";
import { ARROWS, Chosen, shared, uploader } from "metafem/linked.js";
import { area, Axis, digits, path, placeIn, PlotAxes, told, valueAt } from "metafem/plot.js";

// What is free around the axes, and the length of the marks below them [pixels].
const [MARGIN, MARK] = [{ left: 62, right: 16, top: 12, bottom: 46 }, { entry: 7, marked: 12, near: 4 }];
// Radius of what takes a pointer at a handle: 44 px wide for a finger. Where fingers are the first pointer, a pinch
// enlarges the page.
const TOUCH = matchMedia("(any-pointer: coarse)").matches ? 22 : 18;
const FINGERS = matchMedia("(pointer: coarse)").matches;
// Pixels that a pointer may move during a click; and from the achieved law to a point that is added on it. Two clicks are
// one double click within these milliseconds and pixels, the width of a finger.
const [STILL, SNAP, TWICE] = [4, 8, { time: 500, far: 40 }];
// Steps of the arrow keys along an axis; with Shift they are ten times as long.
const [STEPS, LONG] = [400, 10];
// The part of the axes that a key shows, 0 for all; the units of the wheel for a step; and what a zoom shows at least and
// at most of the fitted axes. `law.py` has the least, too.
const [ZOOMS, WHEEL, LEAST, MOST] = [{ "+": 0.8, "=": 0.8, "-": 1.25, 0: 0 }, 400, 1e-3, 10];
// Buttons in the legend: their words, and the event that they emit.
const ACTS = { achieved: ["Pin", "pin", { on: true }], pinned: ["Unpin", "pin", { on: false }], measured: ["Remove", "measured", {}] };
// What the line below the plot says at the first visit.
const [HINT, WELCOME] = ["metafem-hint", "Drag the points of the target law: the heights follow. “Take it” has the mould table, and “Menu” the help."];

export default {
  template: `
    <div class="law-plot" :data-answered="answer?.number ?? 0" :data-beside="beside">
      <div class="law-tools head"><h2>Law</h2>
        <span class="choice law-axes" role="group" aria-label="Axes">
          <button type="button" :title="tools.no_forces || 'Load P and friction F in newtons'" :aria-pressed="newtons" :disabled="tools.no_forces !== ''" @click="$emit('axes', { newtons: true })">N</button>
          <button type="button" title="Load P/E* and friction F/(σB), rescaled" :aria-pressed="!newtons" @click="$emit('axes', { newtons: false })">mm²</button>
        </span>
        <span class="choice" role="group" aria-label="Zoom">
          <button type="button" aria-label="Zoom out" title="Show more of the axes (−)" @click="zoom(1.25)">−</button>
          <button type="button" aria-label="Zoom in" title="Show less of the axes (+); also Ctrl and the wheel" @click="zoom(0.8)">+</button>
          <button type="button" title="Fit the axes to target and law (0)" @click="zoom(0)">Fit</button>
        </span>
        <button type="button" class="act law-choose" title="Show a CSV table of a measured law; it can also be dropped onto the plot. Its first line names the columns with their units: load_N,friction_force_N or load_mN,area_mm2." @click="uploader().pickFiles()">Measured points…</button>
      </div>
      <div class="law-stage" ref="stage">
        <svg class="law-svg" ref="svg" role="group" aria-label="Target law and achieved law. Points can be dragged, or moved with the arrow keys; the key a adds one, Delete removes one; + and - zoom, 0 shows all."
             @pointerdown="pressed = placeOf($event)" @pointermove="follow" @pointerup="release($event.pointerId)" @pointercancel="release($event.pointerId)" @pointerleave="over = null; markTicks()" @wheel.ctrl="wheel" @click="click" @keydown="key">
          <template v-if="answer">
            <defs><clipPath :id="clip"><rect :x="box.left" :y="box.top" :width="box.right - box.left" :height="box.bottom - box.top"/></clipPath></defs>
            <plot-axes :x="x" :y="y" :titles="[answer.x, answer.y]" :beside="48"/>
            <g class="law-curves" :clip-path="'url(#' + clip + ')'" aria-hidden="true"><path v-for="{ kind, d } in curves" :key="kind" :class="kind" :d="d"/></g>
            <g v-for="handle in handles" :key="handle.id" :class="classesOf(handle)" :data-id="handle.id" :transform="'translate(' + x.px(handle.x).toFixed(2) + ' ' + y.px(handle.y).toFixed(2) + ')'"
               tabindex="0" role="slider" :aria-disabled="inactive" :aria-label="wordsOf(handle)" :aria-valuetext="wordsOf(handle)" :aria-valuenow="handle.moves === 'x' ? handle.x : handle.y" aria-valuemin="0"
               @pointerdown="grab" @focus="visit(handle)" @keydown="press($event, handle)" @keyup="$event.key in arrows && release('keys')" @blur="release('keys')">
              <circle class="touch" :r="touch"/><circle class="mark" r="6.5"/>
              <path v-if="handle.moves !== 'xy'" class="way" :d="handle.moves === 'x' ? 'M-13 0H13' : 'M0 -13V13'"/>
              <text class="carried" x="12" y="20">{{ handle.carried }}</text>
            </g>
            <path class="rug" :d="rug(entry, ${MARK.entry})" aria-hidden="true"/><path class="rug-mark" :d="rug(marked, ${MARK.marked})" aria-hidden="true"/>
            <g v-for="[name, at] in [['hair', hover], ['load', load]]" :key="name" aria-hidden="true"><template v-if="x.has(at)">
              <line :class="name" :x1="x.px(at)" :x2="x.px(at)" :y1="box.top" :y2="box.bottom"/>
              <circle v-if="y.has(lawAt(at))" :class="name + '-dot'" :cx="x.px(at)" :cy="y.px(lawAt(at))" :r="name === 'load' ? 5 : 4"/></template></g>
            <path v-if="x.has(load)" class="load-mark" :d="'M' + x.px(load) + ' ' + box.bottom + 'l6 9h-12z'" aria-hidden="true"/>
          </template>
        </svg>
        <q-resize-observer debounce="0" @resize="resize"></q-resize-observer>
        <output class="law-readout" aria-hidden="true">{{ readout }}</output>
      </div>
      <div class="law-dock">
        <ul :key="legend.join()" class="law-legend" aria-label="Legend"><li v-for="[kind, words, more] in legend" :key="words" :title="more || null"><span :class="['key', kind]"></span>{{ words }}
          <button v-if="acts[kind]" type="button" @click="$emit(acts[kind][1], acts[kind][2])">{{ acts[kind][0] }}</button></li></ul>
        <details v-if="refusal" :key="refusal" open class="law-refusal"><summary aria-label="Reason of the refusal"></summary>
          <em class="law-nearest" :hidden="!answer.nearest"><i></i>nearest law that can be designed</em><span>{{ refusal }}</span>
          <button type="button" class="law-use" :hidden="!answer.offer || held" @click="use">{{ offer }}</button></details>
      </div>
      <div :class="['law-live', { wrong }]"><span :aria-live="live">{{ words }}</span>
        <button type="button" class="law-drop" :hidden="!pointed" title="Remove this point (Delete)" @click="remove(pointed)">Remove the point</button>
        <button type="button" :hidden="!reason" title="The reason of the refusal" @click="say(reason, true)">Why?</button>
        <button type="button" class="law-use" :hidden="!(wrong && offered)" @click="use">{{ offer }}</button></div>
    </div>`,
  components: { PlotAxes },
  data() {
    return {
      answer: null, tolerance: null, beside: null, tools: { no_forces: "" }, // the answers are frozen: Vue does not follow thousands of numbers
      x: new Axis(), y: new Axis(), unit: null, zoomed: false, box: { ...MARGIN }, clip: `law-clip-${Math.random().toString(36).slice(2)}`,
      handles: [], inactive: false, drags: new Drags((request) => this.$emit("drag", { ...request, part: this.part }), this.ended), // inactive while the text has problems
      over: null, chosen: null, shared, // where the pointer is [px], and the load that was chosen
      offer: "Use the nearest law", offered: false, words: "", reason: "", wrong: false, live: "polite", pointed: "",
      acts: ACTS, arrows: ARROWS, touch: TOUCH, uploader,
    };
  },
  computed: {
    newtons() { return Boolean(this.tools.newtons && !this.tools.no_forces); },
    refusal() { return this.answer?.refusal ?? ""; },
    held() { return this.drags.now !== null; },
    // The part of the fitted axes that is shown.
    part() { return Math.min(this.x.span / this.x.fitted, this.y.span / this.y.fitted); },
    // [class of the key, words, further words, curve] of all that an answer shows.
    entries() {
      const { answer, tolerance, refusal } = this;
      if (!answer) return [];
      const crowd = answer.crowd && ` (${answer.crowd})`;
      const all = [
        [answer.marked ? "point" : "wanted", `target law${crowd}`, crowd && "Change them in the specification or its table, or choose another kind of target law.", answer.wanted],
        [refusal ? "achieved old" : "achieved", refusal ? "last law found" : `achieved law (${answer.model})`, "", answer.achieved],
        ["pinned", "pinned law", "", answer.pinned],
        ["measured", answer.measured?.name, "", answer.measured],
        ["nearest", "nearest law that can be designed", "", answer.nearest],
        ["tolerance", tolerance?.name.split(",")[0], tolerance?.name, tolerance], // the errors of the part are told where the pointer rests
      ];
      return all.filter(([, , , curve]) => curve);
    },
    legend() { return this.entries.map((each) => each.slice(0, 3)); },
    curves() {
      const [across, up] = [this.x.px, this.y.px];
      return this.entries.toReversed().flatMap(([kind, , , curve]) => { // the band is at the back
        if (kind === "point") return []; // it has handles
        if (curve.low) return { kind, d: area(curve, across, up) };
        const squares = path(curve, across, up, true);
        if (kind === "measured") return { kind, d: squares };
        const line = { kind, d: path(curve, across, up) };
        return curve.marked ? [line, { kind: `${kind} marks`, d: squares }] : line;
      });
    },
    // The load at which contacts are shown: the chosen one, or the last of the law; and the one under the pointer.
    load() { return this.chosen ?? this.answer?.achieved?.x.at(-1) ?? null; },
    hover() { return this.over && !this.held && this.over.x >= this.box.left && this.over.x <= this.box.right ? this.x.at(this.over.x) : null; },
    entry() { return this.shared.press?.entry ?? []; },
    marked() { return this.shared.sites.map((site) => this.entry[site] ?? null).filter((load) => load !== null); },
    readout() {
      const { marked, hover, shared: { sites, press } } = this;
      if (marked.length) {
        const who = marked.length === 1 ? `site ${sites[0] + 1} comes` : `${marked.length} sites come`;
        return `${who} into contact at ${press.exact ? "" : "about "}${digits(this.answer.load_scale * marked[0])} ${this.answer.x.unit}`;
      }
      if (hover === null) return "";
      const y = this.lawAt(hover);
      return `${this.told({ x: hover, y })}${y === null ? "" : " (achieved law)"}`;
    },
  },
  watch: {
    "shared.load"(to) { this.take(to); },
  },
  created() { this.own = new Chosen(); },
  mounted() {
    if (!localStorage.getItem(HINT)) this.words = WELCOME;
    localStorage.setItem(HINT, "seen");
    this.resize();
  },
  methods: {
    // Shows an answer.
    draw(data) {
      const before = this.answer;
      if (data.state !== before?.state) this.own = new Chosen();
      const unknown = data.handles === null; // the text has problems: the last target law stays
      const last = before?.x.unit === data.x.unit ? before : { ...data, handles: [] };
      const { wanted, marked, handles } = unknown ? last : data;
      this.answer = Object.freeze({ ...data, wanted, marked, handles });
      const closed = data.request < this.drags.received ? null : this.drags.take(data.request, data);
      // a problem may be one of a step that is held; else a move would change a text that is not understood
      this.inactive = unknown && !this.held;
      if (!unknown || !this.held) this.placed(handles);
      if (closed) this.tellEnd(closed); // a slope is known with its answer
      else if (!this.held && this.said !== undefined && this.said !== data.state) this.point(this.of()); // what was said belongs to an earlier text
      if (data.refusal && data.offer) this.offer = data.offer; // after a drag the target is back, and the last offer stays
      if (this.held) this.offered = data.offer !== "";
      else if (data.refusal) this.offered = false; // the box has it
      if (!this.held) this.fit();
      if (this.own.isShownBy(data.cursor / data.load_scale)) this.chosen = data.cursor;
      this.tools = data.tools;
      this.changed();
    },
    // Takes what comes a moment after an answer: the tolerance band, which stays until the next one comes.
    more({ number, tolerance }) {
      if (number !== this.answer?.number) return;
      this.tolerance = Object.freeze(tolerance);
      this.beside = number;
    },
    // Takes the refusal of a request that changed nothing.
    refuse(number, words) {
      this.drags.take(number, { refusal: words, handles: null, undecided: false });
      this.say(words, true);
    },
    // New handles; the one that is held stays where the hand is.
    placed(handles) {
      const [{ now }, active] = [this.drags, this.of()];
      this.handles = handles.map((each) => ({ ...each, ...(each.id === now?.id ? now.place : {}) }));
      if (now && !this.of(now.id)) this.drags.now = null;
      if (active && !this.of(active.id)) this.focus(this.handles.at(-1)); // it is gone after undo
    },
    // The handle of an id, or the one in focus.
    of(id = document.activeElement?.dataset?.id) { return this.handles.find((each) => each.id === id); },
    focus(handle) { this.$nextTick(() => this.$refs.svg?.querySelector(`[data-id="${handle?.id}"]`)?.focus({ preventScroll: true })); },
    // The focus goes to a point that was added, or to the one in the place of the removed one.
    changed() {
      const { handles, changing } = this;
      const more = changing ? handles.length - changing.count : 0;
      if (!more) return;
      this.changing = null;
      if ((more > 0) !== ("at" in changing)) return; // an undo came first
      const next = more > 0 ? this.nearest(changing.at) : handles[Math.min(changing.row, handles.length - 1)];
      this.focus(next);
      const curve = changing.marked && !this.answer.marked ? " The law is now a curve that is approximated." : "";
      this.$nextTick(() => (more > 0 ? this.say(`Added ${this.wordsOf(next)}.${curve}`, false, next.id) : this.say("Point removed.")));
    },
    resize() {
      const { width, height } = this.$refs.stage.getBoundingClientRect();
      const [right, bottom] = [width - MARGIN.right, height - MARGIN.bottom];
      if (right <= MARGIN.left || bottom <= MARGIN.top) return; // hidden, or not yet laid out
      this.box = { left: MARGIN.left, right, top: MARGIN.top, bottom };
      this.x.ends = [this.box.left, this.box.right];
      this.y.ends = [this.box.bottom, this.box.top];
    },
    // Fits the axes to the target and the laws; zoomed ones stay as they are, unless `anew` or of another unit.
    fit(anew = false) {
      const { answer } = this;
      const fresh = anew || answer.x.unit !== this.unit;
      this.unit = answer.x.unit;
      if (this.zoomed && !fresh) return;
      this.zoomed = false;
      const curves = [answer.achieved, answer.wanted, answer.nearest, answer.measured, answer.pinned].filter(Boolean);
      for (const axis of ["x", "y"]) this[axis].fit([...curves.flatMap((each) => each[axis]), ...this.handles.map((each) => each[axis])], fresh);
    },
    // Shows another part of the axes, around the pointer, the handle in focus or the middle; 0 shows all.
    zoom(factor, over) {
      const [{ box, part }, handle] = [this, this.of()];
      if (!factor) return this.fit(true);
      if (factor * part < LEAST || factor * part > MOST) return;
      const at = over ?? (handle ? this.pixels(handle) : { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 });
      this.zoomed = true;
      for (const axis of ["x", "y"]) this[axis].zoom(factor, at[axis]);
    },
    wheel(event) { // a touch pad sends a pinch as this
      if (FINGERS) return;
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY / WHEEL), this.placeOf(event));
    },
    placeOf(event) { return placeIn(this.$refs.svg, event); },
    pixels({ x, y }) { return { x: this.x.px(x), y: this.y.px(y) }; },
    follow(event) {
      const at = this.over = this.placeOf(event);
      if (this.drags.by(event.pointerId)) this.move({ x: this.x.at(at.x - this.apart.x), y: this.y.at(at.y - this.apart.y) });
      else this.markTicks();
    },
    click(event) {
      const [at, before] = [this.placeOf(event), this.clicked];
      const near = (place, far) => place && Math.hypot(at.x - place.x, at.y - place.y) < far;
      const still = near(this.pressed, STILL);
      if (event.target.closest(".handle")) return;
      const twice = before && event.timeStamp - before.time < TWICE.time && near(before.at, TWICE.far);
      this.clicked = twice ? null : { at, time: event.timeStamp };
      if (twice) this.add(at);
      else if (still && this.answer?.achieved) this.chooseLoad(this.x.at(at.x));
    },
    key(event) {
      const free = !event.ctrlKey && !event.metaKey && !event.altKey;
      if (free && event.key in ZOOMS) this.zoom(ZOOMS[event.key], this.over);
      else if (free && event.key === "a") this.add(this.over ?? this.between());
      else this.over = null; // a hand at the keys does not add a point where a mouse was left
    },
    // Where a new point goes without a pointer: halfway from the handle in focus to the next.
    between() {
      const { handles } = this;
      const i = Math.max(0, handles.indexOf(this.of()));
      const pair = handles.length < 2 ? [{ x: 0, y: 0 }, ...handles] : handles.slice(Math.min(i, handles.length - 2)).slice(0, 2);
      return pair.length < 2 ? null : this.pixels({ x: (pair[0].x + pair[1].x) / 2, y: (pair[0].y + pair[1].y) / 2 });
    },
    add(at) {
      const { box, x, y } = this;
      if (!at || at.x <= box.left || at.x > box.right || at.y >= box.bottom) return;
      this.changing = { count: this.handles.length, at, marked: this.answer.marked };
      this.$emit("add", { x: x.at(at.x), y: y.at(at.y), near: SNAP * y.pixel });
    },
    remove(id) {
      this.changing = { count: this.handles.length, row: this.handles.findIndex((each) => each.id === id) };
      this.$emit("remove", { id });
    },
    // The handle nearest to a place: the areas of neighbours that take a finger overlap.
    nearest(at) {
      const far = (each) => Math.hypot(this.x.px(each.x) - at.x, this.y.px(each.y) - at.y);
      return this.handles.reduce((best, each) => (far(each) < far(best) ? each : best));
    },
    classesOf(handle) {
      const refused = (this.refusal || this.drags.now?.refusal) && handle.id === this.drags.now?.id;
      return ["handle", `moves-${handle.moves}`, { outside: !this.x.has(handle.x) || !this.y.has(handle.y), refused, inactive: this.inactive }];
    },
    hinder() { this.say("The points cannot be moved while the specification has problems.", true); },
    grab(event) {
      if (event.button !== 0) return;
      event.stopPropagation();
      if (this.inactive) return this.hinder();
      const at = this.placeOf(event);
      const handle = this.nearest(at);
      this.drags.begin(handle, event.pointerId, this.refusal !== "");
      if (event.currentTarget.dataset.id !== handle.id) {
        event.preventDefault(); // the focus goes to the nearest one
        this.focus(handle);
      }
      // the point keeps its distance from the finger, so that it does not jump
      this.apart = { x: at.x - this.x.px(handle.x), y: at.y - this.y.px(handle.y) };
      this.$refs.svg.setPointerCapture(event.pointerId);
    },
    release(by) { if (this.drags.by(by)) this.drags.rest(); },
    press(event, handle) {
      const step = event.ctrlKey || event.altKey || event.metaKey ? null : ARROWS[event.key];
      const removes = event.key === "Delete" || event.key === "Backspace";
      if (!step && !removes) return;
      event.preventDefault();
      if (this.inactive) this.hinder();
      else if (removes) this.remove(handle.id);
      else if (!this.held || this.drags.now.by === "keys") {
        this.drags.begin(handle, "keys", this.refusal !== "");
        const far = (event.shiftKey ? LONG : 1) / STEPS;
        this.move({ x: handle.x + step[0] * far * this.x.span, y: handle.y + step[1] * far * this.y.span });
      }
    },
    // Moves the handle that is held along the axes on which it moves, the letters of `moves`.
    move(to) {
      const { now } = this.drags;
      const handle = this.of(now.id);
      for (const axis of handle.moves) {
        handle[axis] = Math.max(this[axis].pixel, to[axis]);
        this[axis].grow(handle[axis]);
      }
      if ([...handle.moves].every((axis) => handle[axis] === now.place[axis])) return;
      this.point(handle);
      this.drags.move({ x: handle.x, y: handle.y });
    },
    ended(drag) {
      Object.assign(this.of(drag.id) ?? {}, drag.place);
      this.tellEnd(drag);
    },
    // Says where a drag has ended.
    tellEnd({ id, refusal, reached, back, stuck }) {
      const handle = this.of(id);
      if (!handle) return;
      const where = reached ? "to the last place that a surface reaches" : "to where it was";
      if (!refusal) this.point(handle);
      else if (back && stuck) this.say(`Refused there. The law is the nearest one that can be designed: ${this.wordsOf(handle)}.`);
      else this.say(`Refused. The point is back ${where}: ${this.wordsOf(handle)}.`, true);
      this.reason = refusal;
    },
    // A handle that has the focus can lie beyond zoomed axes.
    visit(handle) {
      for (const axis of ["x", "y"]) if (!this[axis].has(handle[axis])) this[axis].shift(handle[axis] - this[axis].span / 2);
      this.point(handle);
    },
    // Shows below the plot where a handle is, which it tells screen readers itself, and a button for hands without keys.
    point(handle) { this.say(handle ? `${this.wordsOf(handle)}.` : "", false, handle?.id, "off"); },
    // Says something below the plot, also to screen readers.
    say(words, wrong = false, id = "", live = "polite") {
      this.said = this.answer?.state;
      const removable = id.startsWith("point") && this.handles.length > 1 && !this.inactive;
      Object.assign(this, { words, wrong, live, reason: "", pointed: removable ? id : "" });
    },
    // A place in words; without the friction where it is null.
    told({ x, y }) {
      const { answer } = this;
      const load = `${answer.x.name} ${told(x, this.x.pixel)} ${answer.x.unit}`;
      return y === null ? load : `${load}, ${answer.y.name} ${told(y, this.y.pixel)} ${answer.y.unit}`;
    },
    wordsOf(handle) { return `${handle.label}: ${this.told(handle)}`; },
    lawAt(load) { return valueAt(this.answer.achieved, load); },
    rug(loads, length) {
      const [{ x, box }, { load_scale: scale }, across] = [this, this.answer, this.x.px];
      return loads.filter((load) => load !== null && x.has(scale * load)).map((load) => `M${across(scale * load).toFixed(1)} ${box.bottom}v${length}`).join("");
    },
    // Marks the sites whose tick is under the pointer: a level of heights has one tick.
    markTicks() {
      const { over: at, box, x, answer } = this;
      const on = at && at.y >= box.bottom - MARK.near && at.y <= box.bottom + MARK.entry + MARK.near;
      const away = this.entry.map((load) => (on && load !== null ? Math.abs(x.px(answer.load_scale * load) - at.x) : Infinity));
      const least = Math.min(MARK.near, ...away) + 0.5;
      const sites = [...away.keys()].filter((i) => away[i] < least && away[i] <= MARK.near);
      if (sites.join() !== this.ticked) shared.sites = sites;
      this.ticked = sites.join();
    },
    chooseLoad(load) {
      const { achieved, load_scale: scale } = this.answer;
      shared.load = { load: Math.min(achieved.x.at(-1), Math.max(achieved.x[0], load)) / scale, moving: false };
    },
    // A load that was chosen here or beside the surface. The server computes the contacts where it stays.
    take(to) {
      if (!this.answer?.achieved) return;
      this.own.take(to);
      this.chosen = to.load * this.answer.load_scale;
      if (!to.moving) this.$emit("cursor", { x: this.chosen });
    },
    use() {
      this.offered = false;
      this.$emit("nearest", {});
    },
  },
};
