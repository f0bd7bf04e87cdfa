// What the browser keeps of the page as long as its tab is open: the history, one entry for each state.
// A reload, and a server that was started again, find it here.
const KEY = "metafem";
const entry = (number) => `${KEY}.${number}`;

// A full or forbidden store loses the history at the next reload, and nothing else.
function store(key, text) {
  try {
    sessionStorage.setItem(key, text);
  } catch (error) {
    console.info(`The history of this page cannot be kept by the browser: ${error.message}`);
  }
}

export default {
  template: `<div ref="lost" role="alert" class="lost" hidden>
    The server has stopped. What you see is kept by this browser. Run <code>metafem explore</code> again, and this page goes on.
  </div>`,
  mounted() {
    const { first, end, at } = JSON.parse(sessionStorage.getItem(KEY) ?? "{}");
    const states = [];
    for (let number = first; number < end; number++) states.push(sessionStorage.getItem(entry(number)));
    this.$emit("stored", { first, at, states, link: location.hash.slice(1) });
    addEventListener("hashchange", this.linked);
    this.$nextTick(() => { // the socket is made when all elements are mounted
      window.socket.on("disconnect", () => { this.$refs.lost.hidden = false; });
      window.socket.on("connect", () => { this.$refs.lost.hidden = true; });
    });
  },
  unmounted() {
    removeEventListener("hashchange", this.linked);
  },
  methods: {
    // Another link was pasted into the address.
    linked() {
      this.$emit("linked", location.hash.slice(1));
    },
    // Whether a change is computed; tests wait until none is.
    wait(busy) { this.$el.dataset.busy = busy; },
    // Keeps the state that is shown, of the number `at`; the history holds those from `first` to before `end`.
    keep({ first, end, at, state, link, asked }) {
      const before = JSON.parse(sessionStorage.getItem(KEY) ?? "{}");
      for (let old = before.first ?? first; old < (before.end ?? first); old++) {
        if (old < first || old >= end) sessionStorage.removeItem(entry(old));
      }
      store(entry(at), state);
      store(KEY, JSON.stringify({ first, end, at }));
      history.replaceState(null, "", link ? `#${link}` : location.pathname);
      this.$el.dataset.asked = asked; // tests wait until the pictures show this answer
    },
  },
};
