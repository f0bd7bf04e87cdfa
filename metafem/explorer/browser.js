// The history of the page, kept by the browser as long as its tab is open.
const KEY = "metafem";

export default {
  template: "<span hidden></span>",
  mounted() {
    // A reload and a restarted server find the history here.
    this.$emit("stored", sessionStorage.getItem(KEY) ?? "");
  },
  methods: {
    keep(history) {
      sessionStorage.setItem(KEY, history);
    },
  },
};
