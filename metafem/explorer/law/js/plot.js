// The law: draws answers, and turns what hands and keys do into events.
import { Chosen, hear, remember } from "metafem-page/linked.js";
import { Cursor } from "./cursor.js";
import { Hand } from "./hand.js";
import { Picture, entries } from "./picture.js";
import { made, MARGIN, told, View } from "./svg.js";

// Pixels that a pointer may move during a click.
const STILL = 4;
// A point that is added so near to the achieved law [pixels] is on it.
const SNAP = 8;
// Two taps are one double tap within these milliseconds and pixels, the width of a finger.
const TWICE = { time: 500, far: 40 };

// What the browser keeps of a drag that the server did not take.
const UNSENT = "metafem-unsent";
// Milliseconds after which a page that is connected again is not loaded anew.
const SAME = 1000;

// Where a point is after the one that carries it has moved: by factors for along, across (y for a move in x) and up.
const shifted = (x, y, by, [along, across, up]) => [x + along * by.x, y + across * by.x + up * by.y];

export class Plot {
  view = new View();
  data = null;
  band = null;
  beside = { tolerance: null, others: [], pinned: null };
  // Numbers of the last request of a drag, of the newest one with an answer, and of the newest one with a decided answer.
  sent = 0;
  received = 0;
  answered = 0;
  unsent = null; // the move that waits behind the request under way
  closed = new AbortController();

  // The element has the words around the plot.
  constructor(element) {
    this.element = element;
    this.emit = (name, data) => element.$emit(name, data);
    [this.root, this.stage, this.svg] = [element.$el, element.$refs.stage, element.$refs.svg];
    this.picture = new Picture(this.svg);
    this.hand = new Hand(this, made("g", {}, this.svg));
    this.cursor = new Cursor(this, made("g", {}, this.svg), element.$refs.readout, this.closed.signal); // after the points in the order of Tab
    this.listen();
    hear("lost", (lost) => (lost ? this.lose() : setTimeout(() => this.resume(), SAME)), this.closed.signal);
    this.resize();
  }

  // A drag that a lost connection ends is made when the server answers again, also on a page that was loaded anew.
  lose() {
    this.received = this.answered = this.sent; // no answer comes
    this.unsent = null;
    const place = this.hand.park();
    if (!place) return;
    remember(UNSENT, JSON.stringify(place), sessionStorage);
    this.say("The server has not taken this move; it is made when the connection is back.", true);
  }

  resume() {
    if (!window.socket.connected) return; // a server that ends can be connected for a moment
    const place = sessionStorage.getItem(UNSENT);
    sessionStorage.removeItem(UNSENT);
    if (place) this.hand.put(JSON.parse(place));
  }

  listen() {
    const { svg } = this;
    svg.addEventListener("pointerdown", (event) => { this.pressed = this.pointOf(event); });
    svg.addEventListener("pointermove", (event) => {
      this.cursor.over = this.pointOf(event);
      if (this.hand.follow(event) || this.cursor.follow(event) || !this.data) return;
      this.cursor.draw(this.view, this.data);
    });
    svg.addEventListener("pointerleave", () => {
      this.cursor.over = null;
      if (this.data) this.cursor.draw(this.view, this.data);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      svg.addEventListener(end, (event) => {
        this.hand.release(event);
        this.cursor.release();
      });
    }
    svg.addEventListener("click", (event) => {
      const at = this.pointOf(event);
      const still = this.pressed && Math.hypot(at.x - this.pressed.x, at.y - this.pressed.y) < STILL;
      this.pressed = null;
      if (event.target.closest(".handle, .load-knob")) return;
      if (event.pointerType !== "touch") this.tapped = null;
      if (event.pointerType === "touch" && this.tappedTwice(at, event.timeStamp)) this.add(at);
      else if (still && event.detail === 1) this.cursor.choose(this.view.atX(at.x));
    });
    svg.addEventListener("dblclick", (event) => {
      if (!event.target.closest(".handle") && !this.tapped) this.add(this.pointOf(event));
    });
    svg.addEventListener("keydown", (event) => {
      if (event.key === "a" && !event.ctrlKey && !event.metaKey && !event.altKey) this.add(this.cursor.over ?? this.between(event.target));
      else this.cursor.over = null; // a hand at the keys does not add a point where a mouse was left
    });
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
    const { handles } = this.hand;
    const i = Math.max(0, handles.findIndex((each) => each.id === node.dataset?.id));
    const [from, to] = handles.length < 2 ? [{ x: 0, y: 0 }, handles[0]] : i + 1 < handles.length ? [handles[i], handles[i + 1]] : [handles[i - 1], handles[i]];
    return from && to ? { x: this.view.px((from.x + to.x) / 2), y: this.view.py((from.y + to.y) / 2) } : null;
  }

  add(at) {
    if (!at || at.x <= MARGIN.left || at.y >= this.view.bottom) return;
    this.changing = { count: this.hand.handles.length, at, marked: this.data.marked };
    const { view } = this;
    this.emit("add", { x: view.roundedX(view.atX(at.x)), y: view.roundedY(view.atY(at.y)), near: (SNAP * view.y) / view.tall });
  }

  remove(id) {
    const { handles } = this.hand;
    this.changing = { count: handles.length, row: handles.findIndex((each) => each.id === id) };
    this.emit("remove", { id });
  }

  // The focus goes to a point that was added, or to the one in the place of the removed one.
  changed() {
    const { hand, changing } = this;
    const more = changing ? hand.handles.length - changing.count : 0;
    if (!more) return;
    this.changing = null;
    if ((more > 0) !== ("at" in changing)) return; // an undo came first
    const { handles } = hand;
    const next = more > 0 ? hand.nearest(changing.at) : handles[Math.min(changing.row, handles.length - 1)];
    hand.focus(next);
    const curve = changing.marked && !this.data.marked ? " The law is now a curve that is approximated." : "";
    if (more > 0) this.say(`Added ${hand.words(next)}.${curve}`, false, next.id);
    else this.say("Point removed.");
  }

  // Sends a move; while a request is under way, the newest move waits.
  move(request) {
    this.unsent = request;
    if (this.received === this.sent) this.send(request);
  }

  // Sends a request of a drag; returns its number.
  send(request) {
    this.unsent = null;
    this.sent += 1;
    this.emit("drag", { ...request, number: this.sent });
    return this.sent;
  }

  // Whether the last place that was asked for is decided.
  get idle() { return this.answered === this.sent && !this.unsent; }

  // Takes an answer to the requests up to a number. An undecided one is followed by another one to the same requests.
  take(number, { refusal, handles, undecided }) {
    this.received = number;
    if (!undecided) this.answered = number;
    const ended = this.hand.answered(number, refusal, handles);
    if (this.unsent && this.received === this.sent) this.send(this.unsent);
    return ended;
  }

  // Draws an answer. An answer without a band has the one of the answer before.
  draw(data) {
    this.band = data.band === undefined ? this.band : data.band;
    if (data.state !== this.data?.state) this.cursor.chosen = new Chosen();
    const unknown = data.handles === null; // the text has problems: the last target law stays
    const stays = unknown && this.data?.x.unit === data.x.unit;
    const wanted = stays ? this.data.wanted : data.wanted;
    const marked = stays ? this.data.marked : data.marked;
    const handles = data.handles ?? (stays ? this.data.handles : []);
    // the tolerance band and further laws stay until those of this answer come
    this.data = { ...data, ...this.beside, wanted, marked, band: this.band, handles };
    const shown = (name) => this.beside.others.some((each) => each.name.startsWith(`${name},`));
    this.data.pending = data.achieved ? data.tools.models.filter(({ name, on }) => on && !shown(name)).map(({ name }) => name) : [];
    const ended = data.request < this.received ? null : this.take(data.request, data);
    // a problem may be one of a step that is held; else a move would change a text that is not understood
    this.hand.inactive = unknown && !this.hand.held;
    if (!unknown || !this.hand.held) this.hand.take(handles);
    this.carry();
    if (ended) this.hand.tell(ended); // a slope is known with its answer
    else if (!this.hand.held && this.said !== undefined && this.said !== data.state) this.point(this.hand.focused); // what was said belongs to an earlier text
    if (this.hand.held) this.offer = data.refusal !== "" && data.nearest !== null;
    if (!this.hand.held) this.fit();
    if (this.cursor.chosen.isShownBy(data.cursor / data.load_scale)) this.cursor.x = data.cursor;
    Object.assign(this.element, { tools: data.tools, block: data.tools.block ?? this.element.block });
    this.drawLegend();
    this.paint();
    this.changed();
    if (this.root.dataset.answered === "0") this.resume();
    this.root.dataset.answered = data.number;
  }

  // Draws what comes a moment after an answer: the tolerance band and the laws under further models.
  more({ number, errors, block, ...curves }) {
    if (block) this.element.block = block;
    if (number !== this.data?.number) return;
    Object.assign(this.data, curves, { pending: [] });
    this.beside = curves;
    if (errors.length) this.say(errors.join(" "), true);
    this.drawLegend();
    this.paint();
    this.root.dataset.beside = number;
  }

  // Takes the refusal of a request that changed nothing.
  refuse(number, words) {
    this.take(number, { refusal: words, handles: null, undecided: false });
    this.say(words, true);
    this.paint();
  }

  fit() {
    const { data, view, hand } = this;
    const curves = [data.achieved, data.wanted, data.nearest, data.measured, data.pinned, ...data.others].filter(Boolean);
    view.fit(
      [...curves.flatMap((each) => each.x), ...hand.handles.map((each) => each.x)],
      [...curves.flatMap((each) => each.y), ...hand.handles.map((each) => each.y)],
      data.x.unit,
    );
  }

  paint() {
    const { data, view, hand } = this;
    if (!data) return;
    this.picture.draw(view, data, this.wanted());
    hand.draw(view, data.refusal !== "" || hand.held?.refused);
    this.cursor.draw(view, data);
    this.drawRefusal();
  }

  // A legend of other lines would change the height of the plot, and so the scale under the hand.
  drawLegend() {
    if (!this.hand.held) this.element.legend = entries(this.data);
  }

  // What follows the handle that is held, and how far it is from where the last answer has it; null for nothing.
  follows() {
    const { current } = this.hand;
    const from = this.data.handles.find((each) => each.id === current?.id);
    const carried = this.data.wanted?.follows[current?.id];
    return from && carried ? { ...carried, by: { x: current.x - from.x, y: current.y - from.y } } : null;
  }

  // The target's curve, whose corners follow the hand; the next answer replaces it.
  wanted() {
    const { wanted } = this.data;
    const follows = this.follows();
    if (!follows) return wanted;
    const moved = { x: [...wanted.x], y: [...wanted.y] };
    for (const [i, ...factors] of follows.corners) [moved.x[i], moved.y[i]] = shifted(wanted.x[i], wanted.y[i], follows.by, factors);
    return moved;
  }

  // Handles that are on the curve stay on it.
  carry() {
    const follows = this.follows();
    for (const [id, ...factors] of follows?.handles ?? []) {
      const from = this.data.handles.find((each) => each.id === id);
      const handle = this.hand.handles.find((each) => each.id === id);
      if (from && handle) [handle.x, handle.y] = shifted(from.x, from.y, follows.by, factors);
    }
  }

  drawRefusal() {
    const { element, data: { refusal, offer, nearest } } = this;
    const held = Boolean(this.hand.held);
    if (refusal !== element.refusal || held) element.away = false; // another reason has not been read
    if (refusal && offer) element.offer = offer; // after a drag the target is back, and the last offer stays
    if (refusal && !held) element.offered = false; // the box has it
    Object.assign(element, { held, refusal, nearest: nearest !== null });
  }

  // A place in words; without the friction where it is null.
  words({ x, y }) {
    const { data, view } = this;
    const load = `${data.x.name} ${told(x, view.x / view.wide)} ${data.x.unit}`;
    return y === null ? load : `${load}, ${data.y.name} ${told(y, view.y / view.tall)} ${data.y.unit}`;
  }

  // Shows below the plot where a handle is, which it tells screen readers itself, and a button for hands without keys.
  point(handle) {
    this.say(handle ? `${this.hand.words(handle)}.` : "", false, handle?.id, "off");
  }

  // Says something below the plot, also to screen readers.
  say(words, wrong = false, id = "", live = "polite") {
    this.said = this.data?.state;
    const removable = id.startsWith("point") && this.hand.handles.length > 1 && !this.hand.inactive;
    const offered = wrong && Boolean(this.offer);
    Object.assign(this.element, { words, wrong, live, offered, pointed: removable ? id : "", welcome: false });
  }

  resize() {
    const { width, height } = this.stage.getBoundingClientRect();
    if (!width || !height) return; // hidden
    Object.assign(this.view, { width, height });
    this.paint();
  }

  close() { this.closed.abort(); }
}
