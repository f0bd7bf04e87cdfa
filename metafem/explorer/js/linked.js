// What the parts of the page tell each other in the browser. Events:
//   load     { load, moving }   rescaled load [mm²] at which the contacts are shown; `moving` while it is dragged or played
//   entries  { entry, exact }   rescaled load at which each site comes into contact; null while it is not known
//   sites    sites              the sites under the pointer or in focus
//   table    files              files that were dropped onto the plot of the law
const links = new EventTarget();

export function tell(name, detail) { links.dispatchEvent(new CustomEvent(name, { detail })); }

export function hear(name, call, signal) { links.addEventListener(name, (event) => call(event.detail), { signal }); }

// Part of a load within which two are the same: the digits of a drawn law.
const SAME = 1e-4;

// The load that a hand has chosen. Answers to choices before it, which come later, are not shown.
export class Chosen {
  asked = null;
  moving = false;

  take({ load, moving }) { Object.assign(this, { asked: load, moving }); }

  isShownBy(load) {
    if (this.moving) return false;
    const shown = this.asked === null || Math.abs(load - this.asked) <= SAME * this.asked;
    if (shown) this.asked = null;
    return shown;
  }
}

// Keeps a text in the browser. A full or forbidden store forgets, and nothing else.
export function remember(key, text) {
  try {
    localStorage.setItem(key, text);
  } catch (error) {
    console.info(`${key} cannot be kept by the browser: ${error.message}`);
  }
}

// Directions of the arrow keys: to the right and up.
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
