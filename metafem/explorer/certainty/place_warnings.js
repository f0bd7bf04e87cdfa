// The warnings that belong to a part of the page: how many, and their words when they are opened.
export default {
  template: `
    <details class="place-warnings" :hidden="!texts.length">
      <summary><span class="chip warn"><span aria-hidden="true">▲</span>{{ texts.length }} {{ texts.length > 1 ? "warnings" : "warning" }}</span>
        <span class="small">{{ brief }}</span></summary>
      <p v-for="text in texts" :key="text" class="warn small">{{ text }}</p>
    </details>`,
  data() {
    return { texts: [] };
  },
  computed: {
    brief() { return (this.texts[0] ?? "").split(/[.:;] /)[0]; },
  },
  methods: {
    show(texts) { this.texts = texts.map((text) => text[0].toUpperCase() + text.slice(1)); },
  },
};
