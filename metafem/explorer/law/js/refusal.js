// The reason of a refusal, in a box that covers no point of the target law and can be put away.
import { MARGIN } from "./view.js";

// Pixels between a point that is held and the box, between the box and the axes, and between it and other points.
const [APART, ROOM, CLEAR] = [18, 10, 14];

// Pages in one column, where a box covers most of the plot: there it stands below.
const NARROW = matchMedia("(max-width: 900px)");

export class Refusal {
  away = ""; // the reason that was put away

  constructor(box, paint) {
    this.box = box;
    this.stage = box.parentElement;
    this.reason = box.querySelector("span");
    box.querySelector(".law-away").addEventListener("click", () => {
      this.away = this.away ? "" : this.reason.textContent;
      paint();
    });
  }

  // Draws the reason; returns whether there is one.
  draw(view, data, hand) {
    const { box, reason } = this;
    box.hidden = data.refusal === "";
    if (box.hidden) this.away = "";
    if (box.hidden) return false;
    if (reason.textContent !== data.refusal) reason.textContent = data.refusal;
    const held = hand.held && hand.current;
    if (this.away !== data.refusal || held) this.away = ""; // another reason has not been read
    box.classList.toggle("away", this.away !== "");
    box.classList.toggle("passive", Boolean(held));
    const button = box.querySelector(".law-away");
    button.hidden = Boolean(held);
    button.textContent = this.away ? "Why refused?" : "✕";
    button.ariaLabel = this.away ? "Show the reason of the refusal" : "Put the reason away";
    box.querySelector(".law-use").hidden = data.nearest === null || Boolean(held);
    box.querySelector(".law-nearest").hidden = data.nearest === null || !held; // else in the legend
    const under = NARROW.matches && !held;
    if (under !== box.classList.contains("under")) {
      box.classList.toggle("under", under);
      if (under) this.stage.after(box);
      else this.stage.append(box);
    }
    const size = [box.offsetWidth, box.offsetHeight];
    const [left, top] = held ? beside(view, held, ...size) : free(view, hand.handles, ...size);
    box.style.left = `${Math.max(4, Math.min(left, view.width - size[0] - 4))}px`;
    box.style.top = `${Math.max(4, Math.min(top, view.height - size[1] - 4))}px`;
    return true;
  }
}

// Where a box covers no law, which rises from the left to the right: above it and to the left of a point, or
// below it and to the right.
function beside(view, handle, width, height) {
  const [x, y] = [view.px(handle.x), view.py(handle.y)];
  if (handle.x / view.x > handle.y / view.y) return [x + APART, y + APART];
  const left = x - width - APART;
  return left < MARGIN.left ? [left, y - height - APART] : [left, y - APART];
}

// The corner of the plot in which a box covers the fewest points.
function free(view, handles, width, height) {
  const lefts = [MARGIN.left + ROOM, view.right - width - ROOM];
  const tops = [MARGIN.top + ROOM, view.bottom - height - ROOM];
  const places = tops.flatMap((top) => lefts.map((left) => [left, top]));
  const within = (at, from, size) => at > from - CLEAR && at < from + size + CLEAR;
  const covered = ([left, top]) => handles.filter((each) => within(view.px(each.x), left, width) && within(view.py(each.y), top, height)).length;
  return places.reduce((best, place) => (covered(place) < covered(best) ? place : best));
}
