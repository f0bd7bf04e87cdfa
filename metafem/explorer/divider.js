// The line between the plots and the workshop: dragged by a pointer, moved by arrow keys. The browser keeps the height.
import { remember } from "metafem-workshop/remember.js";

const KEY = "metafem-height";
// The smallest heights of the workshop and of the plots, steps of the keys, and those with Shift [pixels].
const [LEAST, PLOTS, STEP, LONG] = [120, 240, 16, 80];

export default {
  template: `<div class="divider" role="separator" tabindex="0" aria-orientation="horizontal" aria-label="Height of the workshop"
    :aria-valuenow="height" :aria-valuemin="least" :aria-valuemax="most" title="Drag, or move with the arrow keys; a double click resets"
    @pointerdown="hold" @pointermove="follow" @pointerup="held = null" @pointercancel="held = null" @dblclick="set(null)" @keydown="key"></div>`,
  data() {
    return { height: 0, least: LEAST, most: 0 };
  },
  mounted() {
    this.held = null;
    const kept = Number(localStorage.getItem(KEY));
    if (kept > 0) this.set(kept);
    this.measure();
  },
  methods: {
    largest(page) { return Math.max(LEAST, Math.round(Math.min(page.clientHeight, innerHeight) - PLOTS)); }, // short windows scroll
    parts() { return [this.$el.parentElement, this.$el.nextElementSibling]; },
    measure() {
      const [page, below] = this.parts();
      this.height = Math.round(below.getBoundingClientRect().height);
      this.most = this.largest(page);
    },
    set(height) {  // null: the height of the style sheet
      const [page] = this.parts();
      if (height === null) {
        page.style.removeProperty("--below");
        localStorage.removeItem(KEY);
      } else {
        const chosen = Math.round(Math.max(LEAST, Math.min(height, this.largest(page))));
        page.style.setProperty("--below", `${chosen}px`);
        remember(KEY, chosen);
      }
      this.measure();
    },
    hold(event) {
      if (event.button !== 0) return;
      this.measure();
      this.held = { from: event.clientY, height: this.height };
      this.$el.setPointerCapture(event.pointerId);
    },
    follow(event) {
      if (this.held) this.set(this.held.height + this.held.from - event.clientY);
    },
    key(event) {
      const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (!way) return;
      event.preventDefault();
      this.measure();
      this.set(this.height + way * (event.shiftKey ? LONG : STEP));
    },
  },
};
