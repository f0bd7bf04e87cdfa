// A tour of five steps, each beside the element of which it speaks; the page can be used meanwhile. This module is
// loaded when the tour is taken.
import { createApp } from "vue";

const STEPS = [
  [".law-svg .handle", "Drag a point", "These are points of the target law: how much friction there is at a load. Drag one up or down."],
  [".surface-view .fill", "The heights follow", "The surface is designed anew for each law. A circle is an asperity; its colour is its height."],
  [".bar select[aria-label='Model']", "Choose another model", "“independent” is the quickest. “layer” includes how the asperities sink together on the block."],
  ["[role=tab][data-tour='How sure']", "How sure", "What the design leaves out, how made surfaces scatter, and when the base touches, each with its bound."],
  ["[role=tab][data-tour='Take it']", "Take the files", "The mould table, the solids, a report, and the specification that repeats all of it."],
];
// Distance from the element, and from the edges of the window [pixels].
const [GAP, EDGE] = [12, 8];
const px = (values) => Object.fromEntries(Object.entries(values).map(([name, value]) => [name, `${Math.round(value)}px`]));

const Tour = {
  template: `
    <div class="tour"><template v-if="at !== null">
      <div class="tour-ring" :style="ring"></div>
      <div class="tour-words" role="dialog" aria-labelledby="tour-title" aria-describedby="tour-words" ref="box" :style="place" @keydown.esc="leave">
        <h2 id="tour-title">{{ steps[at][1] }}</h2><p id="tour-words">{{ steps[at][2] }}</p>
        <div class="row"><button type="button" class="act main" ref="next" @click="go(at + 1)">{{ at + 1 < steps.length ? "Next" : "Done" }}</button>
          <button type="button" class="act" @click="leave">Leave</button><span class="quiet small">{{ at + 1 }} of {{ steps.length }}</span></div>
      </div></template>
    </div>`,
  data() {
    return { at: null, ring: {}, place: {}, steps: STEPS };
  },
  methods: {
    leave() {  // the button in focus is about to go
      this.at = null;
      document.querySelector(".law").focus({ preventScroll: true });
    },
    async go(at) {
      if (at === STEPS.length) return this.leave();
      this.at = at;
      await this.$nextTick();
      document.querySelector(STEPS[at][0])?.scrollIntoView({ block: "nearest" });
      this.$refs.next.focus({ preventScroll: true });
      this.follow(at);
    },
    follow(at) {  // in each frame, as the element moves while it is dragged or the page is scrolled
      const { box } = this.$refs;
      if (this.at !== at || !box) return;
      const { left, top, bottom, width, height } = document.querySelector(STEPS[at][0])?.getBoundingClientRect() ?? new DOMRect(EDGE, EDGE);
      const below = bottom + GAP + box.offsetHeight < innerHeight;
      const y = below ? bottom + GAP : Math.max(EDGE, top - GAP - box.offsetHeight);
      this.ring = px({ left: left - EDGE, top: top - EDGE, width: width + 2 * EDGE, height: height + 2 * EDGE });
      this.place = px({ left: Math.max(EDGE, Math.min(left, innerWidth - box.offsetWidth - EDGE)), top: y });
      requestAnimationFrame(() => this.follow(at));
    },
  },
};

const tour = createApp(Tour).mount(document.body.appendChild(document.createElement("div")));

export const start = () => tour.go(0);
