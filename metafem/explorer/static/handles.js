// A drag of a handle, from the press to the answer that ends it. It is in one of three states:
//   HELD     a pointer or keys move the handle; every place is asked for
//   RESTING  let go, but the answer that decides whether a surface reaches the last place has not come
//   ENDED    the end is asked for as a step of the history; the answer to this request closes the drag
// A drag ends at its last place. If no surface reaches that, it ends at the last place that one reaches, or at its start.
import { ARROWS } from "./linked.js";
import { made, set } from "./view.js";

export const [HELD, RESTING, ENDED] = ["held", "resting", "ended"];

// Numbers the requests of drags. While one is under way, the newest move waits.
export class Requests {
  sent = 0; // number of the last request
  received = 0; // number of the newest request with an answer
  decided = true; // whether that answer is final; an undecided one is followed by another one to the same request
  waiting = null;

  constructor(emit) { this.emit = emit; }

  // Whether the last place that was asked for is decided.
  get idle() { return this.decided && this.received === this.sent && !this.waiting; }

  send(request) {
    this.waiting = null;
    this.sent += 1;
    this.emit({ ...request, number: this.sent });
    return this.sent;
  }

  // Sends a move, or the one that waits.
  move(request = this.waiting) {
    this.waiting = request;
    if (request && this.received === this.sent) this.send(request);
  }

  // Takes an answer to the requests up to a number.
  take(number, decided) { Object.assign(this, { received: number, decided }); }
}

export class Drag {
  state = HELD;
  first = Infinity; // number of the first request
  last = null; // number of the request that asks for the end
  reached = null; // the last place that a surface reaches
  refusal = ""; // why no surface reaches the newest place with an answer

  // `by` is the pointer that drags, or the keys; `stuck` says that the law was refused before, when a drag that ends refused
  // takes the nearest law; `ended` is called when the end is asked for.
  constructor(requests, { id, x, y }, by, stuck, ended) {
    Object.assign(this, { requests, id, by, stuck, ended, start: { x, y }, place: { x, y } });
  }

  get moved() { return this.first < Infinity; }

  // Whether the law has no place where the drag ends, so that the text stays as it was.
  get back() { return this.refusal !== "" && !this.reached; }

  move(place) {
    this.place = place;
    this.first = Math.min(this.first, this.requests.sent + 1);
    this.requests.move({ id: this.id, ...place, released: false });
  }

  rest() {
    this.state = RESTING;
    this.settle();
  }

  settle() { if (this.state === RESTING && this.requests.idle) this.end(); }

  end() {
    if (this.state === ENDED || !this.moved) return;
    this.state = ENDED;
    if (this.refusal) this.place = this.reached ?? this.start;
    this.last = this.requests.send({ id: this.id, ...this.place, released: true, back: this.back });
    this.ended(this);
  }

  // Takes an answer to the requests up to a number; returns whether it closes the drag.
  take(number, refusal, handles) {
    if (this.state === ENDED) return number >= this.last;
    if (number >= this.first) {
      const there = handles?.find((each) => each.id === this.id);
      this.refusal = refusal;
      if (!refusal && there) this.reached = { x: there.x, y: there.y };
    }
    this.settle();
    return false;
  }
}

// Handles of the target: dragged by a pointer, moved by keys. What is dragged follows at once; the law follows
// with the answers.

// Steps of the arrow keys along an axis, with Shift ten times as long, and radii of a handle [px]: the area that
// takes a pointer, 44 px wide for a finger, and the mark.
const [STEPS, LONG, MARK] = [400, 10, 6.5];
const TOUCH = matchMedia("(any-pointer: coarse)").matches ? 22 : 18;

export class Handles {
  all = [];
  drag = null;
  inactive = false; // the handles of the last target law, while the text has problems
  nodes = new Map();

  constructor(plot, group) {
    this.plot = plot;
    this.group = group;
  }

  of(id) { return this.all.find((each) => each.id === id); }

  get held() { return this.of(this.drag?.id); }

  // Begins a drag, or goes on with the one of the same keys.
  hold(id, by) {
    const { drag, plot } = this;
    if (drag?.id === id && drag.by === "keys" && by === "keys" && drag.state !== ENDED) drag.state = HELD;
    else {
      drag?.end();
      this.drag = new Drag(plot.requests, this.of(id), by, Boolean(plot.data.refusal), (ended) => this.tell(ended));
    }
  }

  // Moves the handle that is held along the axes on which it moves, the letters of `moves`.
  move(to) {
    const { drag, held: handle, plot, plot: { view } } = this;
    for (const axis of handle.moves) {
      handle[axis] = Math.max(view[axis].rounded(view[axis].pixel), view[axis].rounded(to[axis]));
      view[axis].grow(handle[axis]);
    }
    if ([...handle.moves].every((axis) => handle[axis] === drag.place[axis])) return;
    plot.point(handle);
    drag.move({ x: handle.x, y: handle.y });
    plot.paint();
  }

  letGo() {
    this.drag.rest();
    if (!this.drag.moved) this.drop();
  }

  // Whether the drag is one of a pointer, or of the keys, that has not let go.
  heldBy(by) { return this.drag?.state === HELD && this.drag.by === by; }

  drop() {
    this.drag = null;
    this.plot.paint();
  }

  // Says where a drag has ended.
  tell(drag) {
    const { plot } = this;
    const handle = this.of(drag.id);
    if (handle && drag === this.drag) Object.assign(handle, drag.place);
    plot.paint();
    if (!handle) return;
    const where = drag.reached ? "to the last place that a surface reaches" : "to where it was";
    // the box with the reason goes with the last key, so it is said here
    const reason = drag.by === "keys" ? ` ${drag.refusal}` : "";
    if (!drag.refusal) plot.point(handle);
    else if (drag.back && drag.stuck) plot.say(`Refused there. The law is the nearest one that can be designed: ${this.words(handle)}.`);
    else plot.say(`Refused. The point is back ${where}: ${this.words(handle)}.${reason}`, true);
  }

  // Takes an answer to the requests up to a number. Returns the drag that it closes, or null.
  answered(number, refusal, handles) {
    const { drag } = this;
    if (!drag?.take(number, refusal, handles)) return null;
    this.drag = null;
    return drag;
  }

  // New handles; the one that is held stays where the hand is.
  take(handles) {
    this.all = handles.map((each) => ({ ...each, ...(each.id === this.drag?.id ? this.drag.place : {}) }));
    if (!this.held) this.drag = null;
  }

  words(handle) { return `${handle.label}: ${this.plot.words(handle)}`; }

  draw(view, refused) {
    let lost = false; // the focus, with a handle that is gone after undo
    for (const [id, node] of this.nodes) {
      if (this.of(id)) continue;
      lost ||= node === document.activeElement;
      node.carried.remove();
      node.remove();
      this.nodes.delete(id);
    }
    for (const handle of this.all) {
      const node = this.nodes.get(handle.id) ?? this.make(handle);
      const states = [[view.has(handle), "outside"], [!refused || handle !== this.held, "refused"], [!this.inactive, "inactive"]];
      const more = states.map(([not, name]) => (not ? "" : ` ${name}`)).join("");
      if (node.carried.textContent !== handle.carried) node.carried.textContent = handle.carried;
      set(node.carried, { class: `carried${more}`, x: view.px(handle.x) + 12, y: view.py(handle.y) + 20 });
      set(node, {
        class: `handle moves-${handle.moves}${more}`,
        "aria-disabled": this.inactive,
        transform: `translate(${view.px(handle.x).toFixed(2)} ${view.py(handle.y).toFixed(2)})`,
        "aria-label": this.words(handle), "aria-valuetext": this.words(handle),
        "aria-valuenow": handle.moves === "x" ? handle.x : handle.y, "aria-valuemin": 0,
      });
    }
    if (lost) this.focus(this.all.at(-1));
  }

  focus(handle) { this.nodes.get(handle?.id)?.focus({ preventScroll: true }); }

  // The handle in focus.
  get focused() { return this.all.find((each) => this.nodes.get(each.id) === document.activeElement); }

  // The handle nearest to a place: the areas of neighbours that take a finger overlap.
  nearest(at) {
    const { view } = this.plot;
    const far = (each) => Math.hypot(view.px(each.x) - at.x, view.py(each.y) - at.y);
    return this.all.reduce((best, each) => (far(each) < far(best) ? each : best));
  }

  make(handle) {
    const node = made("g", { "data-id": handle.id, tabindex: 0, role: "slider" }, this.group);
    made("circle", { class: "touch", r: TOUCH }, node);
    made("circle", { class: "mark", r: MARK }, node);
    node.carried = made("text", {}, this.group);
    if (handle.moves !== "xy") made("path", { class: "way", d: handle.moves === "x" ? "M-13 0H13" : "M0 -13V13" }, node);
    node.addEventListener("pointerdown", (event) => this.grab(event));
    node.addEventListener("focus", () => this.plot.visit(this.of(handle.id)));
    node.addEventListener("keydown", (event) => this.press(event, handle.id));
    node.addEventListener("keyup", (event) => { if (event.key in ARROWS && this.heldBy("keys")) this.letGo(); });
    node.addEventListener("blur", () => { if (this.heldBy("keys")) this.letGo(); });
    this.nodes.set(handle.id, node);
    return node;
  }

  grab(event) {
    if (event.button !== 0) return;
    event.stopPropagation();
    if (this.inactive) { this.hinder(); return; }
    const { view } = this.plot;
    const at = this.plot.pointOf(event);
    const handle = this.nearest(at);
    this.hold(handle.id, event.pointerId);
    if (!event.target.closest(`[data-id="${handle.id}"]`)) {
      event.preventDefault(); // the focus goes to the nearest one
      this.focus(handle);
    }
    // the point keeps its distance from the finger, so that it does not jump
    this.apart = { x: at.x - view.px(handle.x), y: at.y - view.py(handle.y) };
    this.plot.svg.setPointerCapture(event.pointerId);
  }

  // Follows the pointer that holds a handle; returns whether there is one.
  follow(event) {
    if (!this.heldBy(event.pointerId)) return false;
    const { view } = this.plot;
    const at = this.plot.pointOf(event);
    this.move({ x: view.x.at(at.x - this.apart.x), y: view.y.at(at.y - this.apart.y) });
    return true;
  }

  release(event) { if (this.heldBy(event.pointerId)) this.letGo(); }

  hinder() { this.plot.say("The points cannot be moved while the specification has problems.", true); }

  press(event, id) {
    const step = event.ctrlKey || event.altKey || event.metaKey ? null : ARROWS[event.key];
    const removes = event.key === "Delete" || event.key === "Backspace";
    if (!step && !removes) return;
    event.preventDefault();
    if (this.inactive) this.hinder();
    else if (removes) this.plot.remove(id);
    else if (!this.drag || this.drag.by === "keys") {
      this.hold(id, "keys");
      const { view } = this.plot;
      const far = (event.shiftKey ? LONG : 1) / STEPS;
      const { x, y } = this.held;
      this.move({ x: x + step[0] * far * view.x.span, y: y + step[1] * far * view.y.span });
    }
  }
}
