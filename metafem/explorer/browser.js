// The history of the page, kept by the browser as long as its tab is open.
const KEY = "metafem";

export default {
  template: "<span hidden></span>",
  mounted() {
    // A reload and a restarted server find the history here.
    this.$emit("stored", sessionStorage.getItem(KEY) ?? "");
  },
  methods: {
    keep(history, number) {
      sessionStorage.setItem(KEY, history);
      this.$el.dataset.asked = number;  // tests wait until the pictures show this answer
    },
  },
};
