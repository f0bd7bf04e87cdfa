import { shallowReactive } from "vue";

// What the parts of the page share in the browser.
export const shared = shallowReactive({
  load: null, // { load, moving }: rescaled load [mm²] at which the contacts are shown; `moving` while it is dragged or played
  press: null, // { entry, exact }: rescaled load at which each site comes into contact; null while it is not known
  sites: [], // the sites under the pointer or in focus
});

// Part of a load within which two are the same: the digits of a drawn law.
export const SAME = 1e-4;

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

// Directions of the arrow keys: to the right and up.
export const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

// The element that hands files to the server, which tells specifications, their tables and measured laws apart.
export const uploader = () => getElement(document.querySelector(".q-uploader")).$refs.qRef;
