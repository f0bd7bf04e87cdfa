// The warnings that belong to a part of the page: how many, and their words when they are opened, over the
// picture, which keeps its size.
export default {
  template: `
    <details ref="box" class="place-warnings" :hidden="!texts.length" @keydown.esc="shut">
      <summary><span class="chip warn"><span aria-hidden="true">▲</span>{{ texts.length }} {{ texts.length > 1 ? "warnings" : "warning" }}</span>
        <span class="small">{{ brief }}</span></summary>
      <div class="over"><p v-for="text in texts" :key="text" class="warn small">{{ text }}</p></div>
    </details>`,
  data() {
    return { texts: [] };
  },
  computed: {
    brief() { return (this.texts[0] ?? "").split(/[.:;] /)[0]; },
  },
  methods: {
    shut() {
      this.$refs.box.open = false;
      this.$refs.box.querySelector("summary").focus();
    },
    show({ texts }) { this.texts = texts.map((text) => text[0].toUpperCase() + text.slice(1)); },
  },
};
