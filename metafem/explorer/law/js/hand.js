// Handles of the target: dragged by a pointer, moved by keys. What is dragged follows at once; the law follows
// with the answers.
import { ARROWS } from "metafem-page/linked.js";
import { made, set } from "./svg.js";

// Steps of the arrow keys along an axis, with Shift ten times as long, and radii of a handle [px]: the area that
// takes a pointer, 44 px wide for a finger, and the mark.
const [STEPS, LONG, MARK] = [400, 10, 6.5];
const TOUCH = matchMedia("(any-pointer: coarse)").matches ? 22 : 18;

export class Hand {
  handles = [];
  held = null;
  inactive = false; // the handles of the last target law, while the text has problems
  nodes = new Map();

  constructor(plot, group) {
    this.plot = plot;
    this.group = group;
  }

  // The state of a handle that is held: where it started, where it is, and the last place that a surface reaches.
  hold(id, by, moved = false) {
    const handle = this.handles.find((each) => each.id === id);
    if (!handle) return;
    if (this.held?.by === "keys" && by === "keys" && this.held.id === id && this.held.final === null) {
      this.held.let = false;
      return;
    }
    if (this.held) this.finish(this.held);
    const start = { x: handle.x, y: handle.y };
    const stuck = Boolean(this.plot.data?.refusal); // a drag that ends refused takes the nearest law
    this.held = { id, by, start, place: start, good: null, refused: false, stuck, moved, let: false, final: null };
  }

  get current() { return this.handles.find((each) => each.id === this.held?.id); }

  move(x, y) {
    const { view } = this.plot;
    const handle = this.current;
    if (handle.moves !== "y") handle.x = Math.max(view.roundedX(view.x / view.wide), view.roundedX(x));
    if (handle.moves !== "x") handle.y = Math.max(view.roundedY(view.y / view.tall), view.roundedY(y));
    view.grow(handle.moves === "y" ? 0 : handle.x, handle.moves === "x" ? 0 : handle.y);
    const place = { x: handle.x, y: handle.y };
    const { place: before } = this.held;
    if ((handle.moves === "y" || place.x === before.x) && (handle.moves === "x" || place.y === before.y)) return;
    Object.assign(this.held, { place, moved: true });
    this.plot.carry();
    this.plot.point(handle);
    this.held.first ??= this.plot.sent + 1;
    this.plot.move({ id: handle.id, ...place, released: false });
    this.plot.paint();
  }

  // The end of a drag: the place becomes a step of the history once it is known whether a surface reaches it.
  letGo() {
    if (!this.held) return;
    this.held.let = true;
    if (!this.held.moved) this.drop();
    else if (this.plot.idle) this.finish(this.held);
  }

  // A place that the server did not take, because the connection was lost; the point returns to its start.
  park() {
    const { held } = this;
    if (!held?.moved) return null;
    Object.assign(this.current ?? {}, held.start);
    this.drop();
    return { id: held.id, ...held.place };
  }

  // Moves a handle as a drag that ends there.
  put({ id, x, y }) {
    this.hold(id, "put");
    if (!this.held) return;
    this.move(x, y);
    this.letGo();
  }

  drop() {
    this.held = null;
    this.plot.paint();
  }

  finish(held) {
    if (held.final !== null || !held.moved) return;
    const place = held.refused ? held.good ?? held.start : held.place;
    const back = held.refused && !held.good; // to the text as it was
    held.final = this.plot.send({ id: held.id, ...place, released: true, back });
    const handle = this.handles.find((each) => each.id === held.id);
    if (handle) Object.assign(handle, place);
    this.plot.carry();
    this.tell(held);
    this.plot.paint();
  }

  // Says where a drag has ended.
  tell(held) {
    const handle = this.handles.find((each) => each.id === held.id);
    if (!handle) return;
    const where = held.good ? "to the last place that a surface reaches" : "to where it was";
    if (!held.refused) { this.plot.point(handle); return; }
    if (held.stuck && !held.good) { this.plot.say(`Refused there. The law is the nearest one that can be designed: ${this.words(handle)}.`); return; }
    // the box with the reason goes with the last key, so it is said here
    const reason = held.by === "keys" ? ` ${held.reason}` : "";
    this.plot.say(`Refused. The point is back ${where}: ${this.words(handle)}.${reason}`, true);
  }

  // Takes an answer to the requests up to a number. Returns the drag that it ends, or null.
  answered(request, refusal, handles) {
    const held = this.held;
    if (!held) return null;
    if (held.final !== null) {
      if (request < held.final) return null;
      this.held = null;
      return held;
    }
    if (request >= held.first) {
      Object.assign(held, { refused: refusal !== "", reason: refusal });
      const there = handles?.find((each) => each.id === held.id);
      if (!held.refused && there) held.good = { x: there.x, y: there.y };
    }
    if (held.let && this.plot.idle) this.finish(held);
    return null;
  }

  // New handles; the one that is held stays where the hand is.
  take(handles) {
    const held = this.current;
    this.handles = handles.map((each) => (held && each.id === held.id ? { ...each, x: held.x, y: held.y } : { ...each }));
    if (this.held && !this.current) this.held = null;
  }

  words(handle) { return `${handle.label}: ${this.plot.words(handle)}`; }

  draw(view, refused) {
    const kept = new Set(this.handles.map((each) => each.id));
    let lost = false; // the focus, with a handle that is gone after undo
    for (const [id, node] of this.nodes) {
      if (kept.has(id)) continue;
      lost ||= node === document.activeElement;
      node.carried.remove();
      node.remove();
      this.nodes.delete(id);
    }
    for (const handle of this.handles) {
      const node = this.nodes.get(handle.id) ?? this.make(handle);
      const wrong = refused && handle.id === this.held?.id;
      if (node.carried.textContent !== handle.carried) node.carried.textContent = handle.carried;
      set(node.carried, { x: view.px(handle.x) + 12, y: view.py(handle.y) + 20 });
      set(node, {
        class: `handle moves-${handle.moves}${wrong ? " refused" : ""}${this.inactive ? " inactive" : ""}`,
        "aria-disabled": this.inactive,
        transform: `translate(${view.px(handle.x).toFixed(2)} ${view.py(handle.y).toFixed(2)})`,
        "aria-label": this.words(handle), "aria-valuetext": this.words(handle),
        "aria-valuenow": handle.moves === "x" ? handle.x : handle.y, "aria-valuemin": 0,
      });
    }
    if (lost) this.focus(this.handles.at(-1));
  }

  focus(handle) { this.nodes.get(handle?.id)?.focus({ preventScroll: true }); }

  // The handle in focus.
  get focused() { return this.handles.find((each) => this.nodes.get(each.id) === document.activeElement); }

  // The handle nearest to a place: the areas of neighbours that take a finger overlap.
  nearest(at) {
    const { view } = this.plot;
    const far = (each) => Math.hypot(view.px(each.x) - at.x, view.py(each.y) - at.y);
    return this.handles.reduce((best, each) => (far(each) < far(best) ? each : best));
  }

  make(handle) {
    const node = made("g", { "data-id": handle.id, tabindex: 0, role: "slider" }, this.group);
    made("circle", { class: "touch", r: TOUCH }, node);
    made("circle", { class: "mark", r: MARK }, node);
    node.carried = made("text", { class: "carried" }, this.group);
    if (handle.moves !== "xy") made("path", { class: "way", d: handle.moves === "x" ? "M-13 0H13" : "M0 -13V13" }, node);
    node.addEventListener("pointerdown", (event) => this.grab(event));
    node.addEventListener("focus", () => this.plot.point(this.focused));
    node.addEventListener("keydown", (event) => this.press(event, handle.id));
    node.addEventListener("keyup", (event) => { if (event.key in ARROWS && this.held?.by === "keys") this.letGo(); });
    node.addEventListener("blur", () => { if (this.held?.by === "keys") this.letGo(); });
    this.nodes.set(handle.id, node);
    return node;
  }

  grab(event) {
    if (event.button !== 0) return;
    event.stopPropagation();
    if (this.inactive) { this.hinder(); return; }
    const { view } = this.plot;
    const at = this.plot.pointOf(event);
    const { id } = this.nearest(at);
    this.hold(id, event.pointerId);
    const handle = this.current;
    if (!event.target.closest(`[data-id="${id}"]`)) {
      event.preventDefault(); // the focus goes to the nearest one
      this.focus(handle);
    }
    // the point keeps its distance from the finger, so that it does not jump
    this.apart = { x: at.x - view.px(handle.x), y: at.y - view.py(handle.y) };
    this.plot.svg.setPointerCapture(event.pointerId);
  }

  // Follows the pointer that holds a handle; returns whether there is one.
  follow(event) {
    if (!this.held || this.held.let || this.held.by !== event.pointerId) return false;
    const { view } = this.plot;
    const at = this.plot.pointOf(event);
    this.move(view.atX(at.x - this.apart.x), view.atY(at.y - this.apart.y));
    return true;
  }

  release(event) {
    if (this.held && !this.held.let && this.held.by === event.pointerId) this.letGo();
  }

  hinder() { this.plot.say("The points cannot be moved while the specification has problems.", true); }

  press(event, id) {
    const step = ARROWS[event.key];
    if (this.inactive && (step || event.key === "Delete" || event.key === "Backspace")) {
      event.preventDefault();
      this.hinder();
      return;
    }
    if (step && !event.ctrlKey && !event.altKey && !event.metaKey) {
      event.preventDefault();
      if (this.held && this.held.by !== "keys") return;
      this.hold(id, "keys");
      const { view } = this.plot;
      const far = event.shiftKey ? LONG : 1;
      const handle = this.current;
      this.move(handle.x + (step[0] * far * view.x) / STEPS, handle.y + (step[1] * far * view.y) / STEPS);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      this.plot.remove(id);
    }
  }
}
