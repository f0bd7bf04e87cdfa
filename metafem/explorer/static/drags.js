// The drags of handles as numbered requests. While one is under way, the newest move waits. A drag that was let go rests
// until its last place is decided; then its end is asked for as a step of the history, and the answer to this closes it.
// It ends at its last place. If no surface reaches that, it ends at the last place that one reaches, or at its start.
export class Drags {
  sent = 0; // number of the last request
  received = 0; // number of the newest request with an answer
  decided = true; // whether that answer is final; an undecided one is followed by another one to the same request
  waiting = null;
  now = null; // the drag, if there is one

  // `ask` sends a request; `ended` is called with a drag whose end is asked for.
  constructor(ask, ended) { Object.assign(this, { ask, ended }); }

  // `by` is the pointer that drags, or the keys, which go on with their own drag; `stuck` says that the law was refused
  // before, when a drag that ends refused takes the nearest law.
  begin({ id, x, y }, by, stuck) {
    const { now } = this;
    if (now?.id === id && now.by === "keys" && by === "keys" && !now.last) now.resting = false;
    else {
      this.end();
      this.now = { id, by, stuck, start: { x, y }, place: { x, y }, first: 0, last: 0, reached: null, refusal: "", back: false, resting: false };
    }
  }

  // Whether a pointer, or the keys, drags and has not let go.
  by(by) { return this.now?.by === by && !this.now.resting && !this.now.last; }

  move(place) {
    this.now.place = place;
    this.now.first ||= this.sent + 1;
    this.next({ id: this.now.id, ...place, released: false });
  }

  // Sends a move, or the one that waits.
  next(request = this.waiting) {
    this.waiting = request;
    if (request && this.received === this.sent) this.send(request);
  }

  send(request) {
    this.waiting = null;
    this.sent += 1;
    this.ask({ ...request, number: this.sent });
  }

  rest() {
    this.now.resting = true;
    if (!this.now.first) this.now = null; // nothing was moved
    this.settle();
  }

  settle() { if (this.now?.resting && this.decided && this.received === this.sent && !this.waiting) this.end(); }

  end() {
    const { now } = this;
    if (!now?.first || now.last) return;
    now.back = now.refusal !== "" && !now.reached; // the text stays as it was
    if (now.refusal) now.place = now.reached ?? now.start;
    now.last = this.sent + 1;
    this.send({ id: now.id, ...now.place, released: true, back: now.back });
    this.ended(now);
  }

  // Takes an answer to the requests up to a number; returns the drag that it closes, or null.
  take(number, { refusal, handles, undecided }) {
    const { now } = this;
    const closed = now?.last && number >= now.last ? now : null;
    Object.assign(this, { received: number, decided: !undecided });
    if (closed) this.now = null;
    else if (now?.first && !now.last && number >= now.first) {
      const there = handles?.find(({ id }) => id === now.id);
      now.refusal = refusal;
      if (!refusal && there) now.reached = { x: there.x, y: there.y };
    }
    this.settle();
    this.next();
    return closed;
  }
}
