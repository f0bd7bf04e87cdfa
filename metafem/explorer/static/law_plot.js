// The law: draws answers, and turns what hands and keys do into events.
import { Cursor } from "metafem/cursor.js";
import { Handles, Requests } from "metafem/handles.js";
import { Chosen, hear, remember, textsOf } from "metafem/linked.js";
import { MARGIN, entries, made, Picture, told, View } from "metafem/view.js";

// Pixels that a pointer may move during a click.
const STILL = 4;
// A point that is added so near to the achieved law [pixels] is on it.
const SNAP = 8;
// Two taps are one double tap within these milliseconds and pixels, the width of a finger.
const TWICE = { time: 500, far: 40 };
// Keys that zoom: the part of the axes that is then shown, 0 for all. The wheel does the same in steps of so many units.
const ZOOMS = { "+": 0.8, "=": 0.8, "-": 1.25, 0: 0 };
const WHEEL = 400;
// Where fingers are the first pointer, a pinch enlarges the page.
const FINGERS = matchMedia("(pointer: coarse)").matches;

export class Plot {
  view = new View();
  data = null;
  beside = { tolerance: null };
  requests = new Requests((request) => this.emit("drag", { ...request, part: this.view.part }));
  closed = new AbortController();

  // The element has the words around the plot.
  constructor(element) {
    this.element = element;
    this.emit = (name, data) => element.$emit(name, data);
    [this.root, this.stage, this.svg] = [element.$el, element.$refs.stage, element.$refs.svg];
    this.picture = new Picture(this.svg);
    this.handles = new Handles(this, made("g", {}, this.svg));
    this.cursor = new Cursor(this, made("g", {}, this.svg), element.$refs.readout, this.closed.signal); // after the points in the order of Tab
    this.listen();
    this.resize();
  }

  listen() {
    const { svg, view } = this;
    svg.addEventListener("pointerdown", (event) => { this.pressed = this.pointOf(event); });
    svg.addEventListener("pointermove", (event) => {
      this.cursor.over = this.pointOf(event);
      if (!this.handles.follow(event) && !this.cursor.follow(event)) this.cursor.draw();
    });
    svg.addEventListener("pointerleave", () => {
      this.cursor.over = null;
      this.cursor.draw();
    });
    for (const end of ["pointerup", "pointercancel"]) {
      svg.addEventListener(end, (event) => {
        this.handles.release(event);
        this.cursor.release();
      });
    }
    svg.addEventListener("wheel", (event) => { // a touch pad sends a pinch as this
      if (!event.ctrlKey || FINGERS) return;
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY / WHEEL), this.pointOf(event));
    }, { passive: false });
    svg.addEventListener("click", (event) => {
      const at = this.pointOf(event);
      const still = this.pressed && Math.hypot(at.x - this.pressed.x, at.y - this.pressed.y) < STILL;
      this.pressed = null;
      if (event.target.closest(".handle, .load-knob")) return;
      if (event.pointerType !== "touch") this.tapped = null;
      if (event.pointerType === "touch" && this.tappedTwice(at, event.timeStamp)) this.add(at);
      else if (still && event.detail === 1) this.cursor.choose(view.x.at(at.x));
    });
    svg.addEventListener("dblclick", (event) => {
      if (!event.target.closest(".handle") && !this.tapped) this.add(this.pointOf(event));
    });
    svg.addEventListener("keydown", (event) => {
      const free = !event.ctrlKey && !event.metaKey && !event.altKey;
      if (free && event.key in ZOOMS) this.zoom(ZOOMS[event.key], this.cursor.over);
      else if (free && event.key === "a") this.add(this.cursor.over ?? this.between(event.target));
      else this.cursor.over = null; // a hand at the keys does not add a point where a mouse was left
    });
  }

  // Shows another part of the axes, around the pointer, the handle in focus or the middle; 0 shows all.
  zoom(factor, over) {
    const { view } = this;
    const { x, y } = this.handles.focused ?? {};
    const middle = { x: (MARGIN.left + view.right) / 2, y: (MARGIN.top + view.bottom) / 2 };
    if (factor) view.zoom(factor, over ?? (x === undefined ? middle : { x: view.px(x), y: view.py(y) }));
    else this.fit(true);
    this.paint();
  }

  // Shows a handle that has the focus, which can lie beyond zoomed axes.
  visit(handle) {
    if (!this.view.has(handle)) {
      this.view.show(handle);
      this.paint();
    }
    this.point(handle);
  }

  pointOf(event) {
    const box = this.svg.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  // Whether a tap follows another one closely; some browsers make no double click of two taps.
  tappedTwice(at, time) {
    const before = this.tapped;
    const twice = before && time - before.time < TWICE.time && Math.hypot(at.x - before.at.x, at.y - before.at.y) < TWICE.far;
    this.tapped = { at, time: twice ? -Infinity : time };
    return twice;
  }

  // Where a new point goes without a pointer: halfway from the handle in focus to the next.
  between(node) {
    const handles = this.handles.all;
    const i = Math.max(0, handles.findIndex((each) => each.id === node.dataset?.id));
    const [from, to] = handles.length < 2 ? [{ x: 0, y: 0 }, handles[0]] : i + 1 < handles.length ? [handles[i], handles[i + 1]] : [handles[i - 1], handles[i]];
    return from && to ? { x: this.view.px((from.x + to.x) / 2), y: this.view.py((from.y + to.y) / 2) } : null;
  }

  add(at) {
    const { view } = this;
    if (!at || at.x <= MARGIN.left || at.x > view.right || at.y >= view.bottom) return;
    this.changing = { count: this.handles.all.length, at, marked: this.data.marked };
    this.emit("add", { x: view.x.rounded(view.x.at(at.x)), y: view.y.rounded(view.y.at(at.y)), near: SNAP * view.y.pixel });
  }

  remove(id) {
    const handles = this.handles.all;
    this.changing = { count: handles.length, row: handles.findIndex((each) => each.id === id) };
    this.emit("remove", { id });
  }

  // The focus goes to a point that was added, or to the one in the place of the removed one.
  changed() {
    const { handles, changing } = this;
    const more = changing ? handles.all.length - changing.count : 0;
    if (!more) return;
    this.changing = null;
    if ((more > 0) !== ("at" in changing)) return; // an undo came first
    const next = more > 0 ? handles.nearest(changing.at) : handles.all[Math.min(changing.row, handles.all.length - 1)];
    handles.focus(next);
    const curve = changing.marked && !this.data.marked ? " The law is now a curve that is approximated." : "";
    if (more > 0) this.say(`Added ${handles.words(next)}.${curve}`, false, next.id);
    else this.say("Point removed.");
  }

  // Takes an answer to the requests of drags up to a number; returns the drag that it closes, or null.
  take(number, { refusal, handles, undecided }) {
    this.requests.take(number, !undecided);
    const closed = this.handles.answered(number, refusal, handles);
    this.requests.move();
    return closed;
  }

  // Draws an answer.
  draw(data) {
    const { handles } = this;
    if (data.state !== this.data?.state) this.cursor.chosen = new Chosen();
    const unknown = data.handles === null; // the text has problems: the last target law stays
    const last = this.data?.x.unit === data.x.unit ? this.data : { ...data, handles: [] };
    const { wanted, marked, handles: own } = unknown ? last : data;
    // the tolerance band stays until that of this answer comes
    this.data = { ...data, ...this.beside, wanted, marked, handles: own };
    const closed = data.request < this.requests.received ? null : this.take(data.request, data);
    // a problem may be one of a step that is held; else a move would change a text that is not understood
    handles.inactive = unknown && !handles.drag;
    if (!unknown || !handles.drag) handles.take(own);
    if (closed) handles.tell(closed); // a slope is known with its answer
    else if (!handles.drag && this.said !== undefined && this.said !== data.state) this.point(handles.focused); // what was said belongs to an earlier text
    if (handles.drag) this.offer = data.offer !== "";
    else this.fit();
    if (this.cursor.chosen.isShownBy(data.cursor / data.load_scale)) this.cursor.x = data.cursor;
    this.element.tools = data.tools;
    this.show();
    this.changed();
    this.root.dataset.answered = data.number;
  }

  // Draws what comes a moment after an answer: the tolerance band.
  more({ number, tolerance }) {
    if (number !== this.data?.number) return;
    this.data.tolerance = tolerance;
    this.beside = { tolerance };
    this.show();
    this.root.dataset.beside = number;
  }

  // Takes the refusal of a request that changed nothing.
  refuse(number, words) {
    this.take(number, { refusal: words, handles: null, undecided: false });
    this.say(words, true);
    this.paint();
  }

  // Fits the axes to the target and the laws, also zoomed ones if `anew`.
  fit(anew = false) {
    const { data, view, handles } = this;
    const curves = [data.achieved, data.wanted, data.nearest, data.measured, data.pinned].filter(Boolean);
    if (anew) view.unit = null;
    view.fit(
      [...curves.flatMap((each) => each.x), ...handles.all.map((each) => each.x)],
      [...curves.flatMap((each) => each.y), ...handles.all.map((each) => each.y)],
      data.x.unit,
    );
  }

  paint() {
    const { data, view, handles } = this;
    if (!data) return;
    this.picture.draw(view, data, entries(data));
    handles.draw(view, data.refusal !== "" || Boolean(handles.drag?.refusal));
    this.cursor.draw();
    this.drawRefusal();
  }

  // Draws all. A legend of other lines would change the height of the plot, and so the scale under the hand.
  show() {
    if (!this.handles.drag) this.element.legend = entries(this.data).map((each) => each.slice(0, 3));
    this.paint();
  }

  drawRefusal() {
    const { element, data: { refusal, offer, nearest } } = this;
    const held = Boolean(this.handles.drag);
    if (refusal !== element.refusal || held) element.away = false; // another reason has not been read
    if (refusal && offer) element.offer = offer; // after a drag the target is back, and the last offer stays
    if (refusal && !held) element.offered = false; // the box has it
    Object.assign(element, { held, refusal, nearest: nearest !== null, usable: offer !== "" });
  }

  // A place in words; without the friction where it is null.
  words({ x, y }) {
    const { data, view } = this;
    const load = `${data.x.name} ${told(x, view.x.pixel)} ${data.x.unit}`;
    return y === null ? load : `${load}, ${data.y.name} ${told(y, view.y.pixel)} ${data.y.unit}`;
  }

  // Shows below the plot where a handle is, which it tells screen readers itself, and a button for hands without keys.
  point(handle) {
    this.say(handle ? `${this.handles.words(handle)}.` : "", false, handle?.id, "off");
  }

  // Says something below the plot, also to screen readers.
  say(words, wrong = false, id = "", live = "polite") {
    this.said = this.data?.state;
    const removable = id.startsWith("point") && this.handles.all.length > 1 && !this.handles.inactive;
    const offered = wrong && Boolean(this.offer);
    Object.assign(this.element, { words, wrong, live, offered, pointed: removable ? id : "" });
  }

  resize() {
    const { width, height } = this.stage.getBoundingClientRect();
    if (!width || !height) return; // hidden
    this.view.resize(width, height);
    this.paint();
  }

  close() { this.closed.abort(); }
}

// The element of the law: the choices above the plot and the words below it. NiceGUI calls its methods with answers, and
// receives its events.

// What the line below the plot says at the first visit.
const [HINT, WELCOME] = ["metafem-hint", "Drag the points of the target law: the heights follow. “Take it” has the mould table, and “Menu” the help."];
// Buttons in the legend: their words, and the event that they emit.
const ACTS = {
  achieved: [["Pin", "pin", { on: true }]],
  pinned: [["Unpin", "pin", { on: false }]],
  measured: [["Remove", "measured", {}]],
};

export default {
  template: `
    <div :class="['law-plot', { dropping }]" data-answered="0" @dragover="dropping = $event.dataTransfer?.types.includes('Files')" @dragleave="dropping = false">
      <div class="law-tools head"><h2>Law</h2>
        <span class="choice law-axes" role="group" aria-label="Axes">
          <button type="button" title="Load P and friction F in newtons" :aria-pressed="newtons" :aria-disabled="tools.no_forces !== ''" @click="forces">N</button>
          <button type="button" title="Load P/E* and friction F/(σB), rescaled" :aria-pressed="!newtons" @click="$emit('axes', { newtons: false })">mm²</button>
        </span>
        <span class="choice" role="group" aria-label="Zoom">
          <button type="button" aria-label="Zoom out" title="Show more of the axes (−)" @click="plot.zoom(1.25)">−</button>
          <button type="button" aria-label="Zoom in" title="Show less of the axes (+); also Ctrl and the wheel" @click="plot.zoom(0.8)">+</button>
          <button type="button" title="Fit the axes to target and law (0)" @click="plot.zoom(0)">Fit</button>
        </span>
        <button type="button" class="act law-choose" title="Show a CSV table of a measured law; it can also be dropped onto the plot. Its first line names the columns with their units: load_N,friction_force_N or load_mN,area_mm2." @click="$refs.file.click()">Measured points…</button>
        <input ref="file" type="file" accept=".csv,.tsv,.txt,text/csv" hidden @change="choose">
      </div>
      <div class="law-stage" ref="stage">
        <svg class="law-svg" ref="svg" role="group" aria-label="Target law and achieved law. Points can be dragged, or moved with the arrow keys; the key a adds one, Delete removes one; + and - zoom, 0 shows all."></svg>
        <q-resize-observer debounce="0" @resize="plot?.resize()"></q-resize-observer>
        <output class="law-readout" ref="readout" aria-hidden="true"></output>
      </div>
      <div class="law-dock">
        <ul :key="legend.join()" class="law-legend" aria-label="Legend"><li v-for="[kind, words, more] in legend" :key="words" :title="more || null"><span :class="['key', kind]"></span>{{ words }}
          <button v-for="[act, name, event] in acts[kind]" :key="act" type="button" @click="$emit(name, event)">{{ act }}</button></li></ul>
        <div :class="['law-refusal', { away }]" :hidden="!refusal">
          <button type="button" class="law-away" :hidden="held" :aria-label="away ? 'Show the reason of the refusal' : 'Put the reason away'" @click="away = !away">{{ away ? "Why?" : "✕" }}</button>
          <em class="law-nearest" :hidden="!nearest"><i></i>nearest law that can be designed</em><span>{{ refusal }}</span>
          <button type="button" class="law-use" :hidden="!usable || held" @click="use">{{ offer }}</button></div>
      </div>
      <div :class="['law-live', { wrong }]"><span :aria-live="live">{{ words }}</span>
        <button type="button" class="law-drop" :hidden="!pointed" title="Remove this point (Delete)" @click="plot.remove(pointed)">Remove the point</button>
        <button type="button" class="law-use" :hidden="!offered" @click="use">{{ offer }}</button></div>
    </div>`,
  data() {
    return {
      tools: { no_forces: "" }, dropping: false, legend: [], acts: ACTS,
      refusal: "", away: false, held: false, nearest: false, usable: false, offer: "Use the nearest law", // the words of the button
      words: "", wrong: false, live: "polite", pointed: "", offered: false,
    };
  },
  computed: {
    newtons() { return Boolean(this.tools.newtons && !this.tools.no_forces); },
  },
  mounted() {
    this.plot = new Plot(this);
    if (!localStorage.getItem(HINT)) this.words = WELCOME;
    remember(HINT, "seen");
    hear("table", this.read, this.plot.closed.signal);
  },
  unmounted() { this.plot.close(); },
  methods: {
    draw(data) { this.plot.draw(data); },
    refuse(number, words) { this.plot.refuse(number, words); },
    say(words, wrong) { this.plot.say(words, wrong); },
    more(data) { this.plot.more(data); },
    use() {
      this.plot.offer = false;
      this.$emit("nearest", {});
    },
    forces() {
      if (this.tools.no_forces) this.say(this.tools.no_forces, true);
      else this.$emit("axes", { newtons: true });
    },
    choose({ target }) {
      if (target.files.length) this.read([...target.files]);
      target.value = ""; // the same file can be chosen again
    },
    async read(files) {
      this.dropping = false;
      const [table, ...others] = await textsOf(files);
      if (table.why || others.length) this.say(others.length ? "Drop one file: a table with columns such as load_N,friction_force_N." : `${table.name} ${table.why}.`, true);
      else this.$emit("dropped", table);
    },
  },
};
