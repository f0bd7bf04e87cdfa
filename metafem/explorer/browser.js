// What the browser keeps of the page as long as its tab is open: the history, one entry for each state.
// A reload, and a server that was started again, find it here.
import { kept, tell } from "metafem-page/linked.js";

const KEY = "metafem";
const entry = (number) => `${KEY}.${number}`;

// A history is sent to the server in parts of so many characters: NiceGUI drops messages of a megabyte, and the escapes
// of a text can double its length.
const PART = 400_000;

// The numbers of the states that are kept, in their order.
const numbers = () => Object.keys(sessionStorage).filter((key) => key.startsWith(entry(""))).map((key) => Number(key.slice(entry("").length))).sort((a, b) => a - b);

// Keeps a text. A full store loses its oldest states but the one `at`, which a reload then no longer finds. Returns ""
// or why the text cannot be kept.
function store(key, text, at) {
  for (;;) {
    try {
      sessionStorage.setItem(key, text);
      return "";
    } catch (error) {
      const oldest = numbers().find((number) => number !== at);
      if (oldest === undefined) return error.message;
      sessionStorage.removeItem(entry(oldest));
    }
  }
}

// The states that are kept around the one that is shown, without a gap between them.
function restored() {
  const { first, end, at } = kept(KEY); // if it is damaged, the address has the state, too
  const state = (number) => (number >= first && number < end ? sessionStorage.getItem(entry(number)) : null);
  let low = at;
  while (state(low - 1) !== null) low--;
  const states = [];
  for (let text, number = low; (text = state(number)) !== null; number++) states.push(text);
  return { first: low, at, states };
}

export default {
  template: `<div>
    <div role="alert" class="lost" :hidden="!lost">
      The connection to the server is lost. What you see is kept by this browser. If the server has stopped, run <code>metafem explore</code> again, and this page goes on.
    </div>
    <div role="status" class="lost" :hidden="!full">{{ full }}</div>
  </div>`,
  data() {
    return { lost: false, full: "" };
  },
  watch: {
    lost(lost) { tell("lost", lost); },
  },
  mounted() {
    this.tell("stored", { ...restored(), link: location.hash.slice(1) });
    addEventListener("hashchange", this.linked);
    this.$nextTick(() => { // the socket is made when all elements are mounted
      window.socket.on("disconnect", () => { this.lost = true; });
      window.socket.on("connect", () => { this.lost = false; });
    });
  },
  unmounted() {
    removeEventListener("hashchange", this.linked);
  },
  methods: {
    // Another link was pasted into the address.
    linked() {
      this.tell("linked", location.hash.slice(1));
    },
    // Sends a value to the server in parts, which can arrive in another order.
    tell(name, value) {
      const code = (character) => `\\u${character.charCodeAt(0).toString(16).padStart(4, "0")}`;
      const text = JSON.stringify(value).replace(/[^ -~]/g, code); // plain, so that a part has as many bytes as characters
      const count = Math.ceil(text.length / PART);
      this.told = (this.told ?? 0) + 1;
      for (let i = 0; i < count; i++) {
        this.$emit("part", { name, number: this.told, i, count, text: text.slice(i * PART, (i + 1) * PART) });
      }
    },
    // The number of the last change; tests wait until the pictures show its answer.
    asks(number) { this.$el.dataset.asked = number; },
    // Keeps the state that is shown, of the number `at`; the history holds those from `first` to before `end`.
    keep({ first, end, at, state, link }) {
      for (const old of numbers()) if (old < first || old >= end) sessionStorage.removeItem(entry(old));
      const why = store(entry(at), state, at) || store(KEY, JSON.stringify({ first, end, at }), at);
      if (why) console.info(`The history of this page cannot be kept by the browser: ${why}`);
      const size = (state.length / 1e6).toFixed(1);
      this.full = !why || link ? "" : `This browser cannot keep a state of ${size} MB: a reload of the page loses it. Take the specification first.`;
      try {
        history.replaceState(null, "", link ? `#${link}` : location.pathname);
      } catch {
        // some browsers allow so many changes of the address in a time; the next step changes it again
      }
    },
  },
};
