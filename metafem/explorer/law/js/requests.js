// At most one request is under way, and only the newest waits behind it.

// Milliseconds after which the next request is sent although no answer has come: the server may have dropped
// the one under way, or be busy with a hard law, which it ends for a newer one.
const PATIENCE = 150;

export class Requests {
  number = 0; // of the last request that was sent
  underWay = false;
  waiting = null;
  places = new Map(); // number of a request that was sent -> what it asked for
  timer = null;

  constructor(send) { this.send = send; }

  // Sends a request, or keeps it until the one under way is answered.
  put(request) {
    this.waiting = request;
    if (!this.underWay) this.next();
  }

  // Sends a request at once, and forgets the one that waits; returns its number.
  now(request) {
    this.waiting = request;
    this.next();
    return this.number;
  }

  next() {
    clearTimeout(this.timer);
    const request = this.waiting;
    this.waiting = null;
    this.underWay = request !== null;
    if (request === null) return;
    this.number += 1;
    this.places.set(this.number, request);
    this.timer = setTimeout(() => this.next(), PATIENCE);
    this.send({ ...request, number: this.number });
  }

  // Takes the answer to a request; returns what was asked, or undefined for an answer to something else. An undecided
  // answer is followed by another one to the same request.
  answered(number, undecided = false) {
    const asked = this.places.get(number);
    for (const each of this.places.keys()) if (each < number || (each === number && !undecided)) this.places.delete(each);
    if (number === this.number) this.next();
    return asked;
  }

  // Whether the last place that was asked for has been answered.
  get idle() { return this.waiting === null && !this.places.has(this.number); }

  close() { clearTimeout(this.timer); }
}
