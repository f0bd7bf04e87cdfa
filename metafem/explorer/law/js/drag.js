// A drag of a handle, from the press to the answer that ends it. It is in one of three states:
//   HELD     a pointer or keys move the handle; every place is asked for
//   RESTING  let go, but the answer that decides whether a surface reaches the last place has not come
//   ENDED    the end is asked for as a step of the history; the answer to this request closes the drag
// A drag ends at its last place. If no surface reaches that, it ends at the last place that one reaches, or at its start.
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
