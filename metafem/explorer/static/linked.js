import { shallowReactive } from "vue";

// What the parts of the page share in the browser.
export const shared = shallowReactive({
  load: null, // { load, moving }: rescaled load [mm²] at which the contacts are shown; `moving` while it is dragged or played
  press: null, // { entry, exact }: rescaled load at which each site comes into contact; null while it is not known
  sites: [], // the sites under the pointer or in focus
  files: [], // files that were dropped, none of them a specification
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

// Files that were chosen or dropped, as texts: the characters of one as it is sent, where each end of a line has two: the server takes a megabyte.
export const LARGEST = 900_000;
const MOST = 40; // files

// The length of a text in a message.
export const sent = (text) => JSON.stringify(text).length;

async function textOf(file) {
  const large = { name: file.name, why: `is larger than ${LARGEST / 1000} kB, the limit for a file` };
  if (file.size > LARGEST) return large;
  try {
    const text = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
    return sent(text) > LARGEST ? large : { name: file.name, text };
  } catch (error) {
    return { name: file.name, why: error instanceof TypeError ? "is not a text in UTF-8" : "could not be read" };
  }
}

// Those that cannot be read say why; together they fit into one message.
export async function textsOf(files) {
  const texts = await Promise.all([...files].slice(0, MOST).map(textOf));
  if (sent(texts) <= LARGEST) return texts;
  return texts.map(({ name }) => ({ name, why: `is too large: all files together may have ${LARGEST / 1000} kB` }));
}
