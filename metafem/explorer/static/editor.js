// The specification as text. What is typed is used half a second after the last key, or when the editor is left.
import { LARGEST, sent, textsOf } from "metafem/linked.js";

const PAUSE = 500;
// Colours by the names of syntax tags: sections, values, remarks.
const COLOURS = [
  [["comment"], { color: "var(--quiet)", fontStyle: "italic" }],
  [["string"], { color: "var(--good)" }],
  [["atom", "literal", "keyword"], { color: "var(--accent)", fontWeight: "600" }],
];

export default {
  template: `
    <div class="editor">
      <div class="row">
        <button type="button" class="act" @click="$refs.files.click()">Load…</button>
        <input ref="files" type="file" hidden multiple accept=".toml,.csv,.txt,.tsv" aria-label="Specification and tables" @change="chosen">
        <span v-if="tables.length" class="quiet small">with {{ tables.join(", ") }}</span>
        <span class="quiet small">A specification and its tables can be dropped onto the page.</span>
      </div>
      <div class="both">
        <div ref="frame" class="frame"></div>
        <ul v-if="problems.length" class="problems warn" aria-label="Problems of the specification">
          <li v-for="each in problems" :key="each.words"><button v-if="each.line" type="button" class="act" @click="jump(each.line)">Line {{ each.line }}</button>
            {{ each.words }}</li></ul>
      </div>
    </div>`,
  data() {
    return { problems: [], tables: [] };
  },
  async mounted() {
    this.count = 0; // of the texts that were sent
    this.CM = await import("nicegui-codemirror");
    if (!this.$refs.frame) return;
    this.editor = new this.CM.EditorView({ doc: "", parent: this.$refs.frame, extensions: this.extensions() });
    this.$emit("ready");
  },
  deactivated() { this.use(); },
  beforeUnmount() {
    clearTimeout(this.timer);
    this.editor?.destroy();
  },
  methods: {
    extensions() {
      const CM = this.CM;
      const styles = CM.defaultHighlightStyle.specs.flatMap(({ tag }) => [tag].flat()).flatMap((tag) =>
        COLOURS.filter(([names]) => names.includes(String(tag))).map(([, style]) => ({ tag, ...style })));
      const language = new CM.Compartment();
      CM.languages.find(({ name }) => name === "TOML").load().then((toml) => this.editor?.dispatch({ effects: language.reconfigure(toml) }));
      return [
        CM.Prec.high(CM.syntaxHighlighting(CM.HighlightStyle.define(styles))), CM.basicSetup, language.of([]),
        CM.EditorView.contentAttributes.of({ "aria-label": "Specification" }),
        CM.EditorView.updateListener.of((update) => { if (update.docChanged && !this.showing) this.typed(); }),
        CM.EditorView.domEventHandlers({ blur: () => this.use() }),
      ];
    },
    typed() {
      this.dirty = true;
      clearTimeout(this.timer);
      this.timer = setTimeout(this.use, PAUSE);
    },
    use() {
      clearTimeout(this.timer);
      if (!this.dirty) return;
      const text = this.editor.state.doc.toString();
      if (sent(text) > LARGEST) {
        this.problems = [{ line: 0, words: `The text is larger than ${LARGEST / 1000} kB, so it is not used. Undo, or delete some of it.` }];
        return;
      }
      this.dirty = false;
      this.count += 1;
      this.$emit("changed", { text, count: this.count });
    },
    show({ text, problems, tables, taken }) {
      if (!this.editor || this.dirty || taken < this.count) return;  // what is typed, or sent but not yet taken, stays
      Object.assign(this, { problems, tables });
      this.replace(text.replaceAll("\r\n", "\n"));
    },
    replace(text) {  // only what differs, so that the cursor and the scrolled place stay
      const old = this.editor.state.doc.toString();
      if (old === text) return;
      let [from, end] = [0, 0];
      const least = Math.min(old.length, text.length);
      while (from < least && old[from] === text[from]) from++;
      while (end < least - from && old.at(-1 - end) === text.at(-1 - end)) end++;
      this.showing = true;
      this.editor.dispatch({
        changes: { from, to: old.length - end, insert: text.slice(from, text.length - end) },
        annotations: this.CM.Transaction.addToHistory.of(false),
      });
      this.showing = false;
    },
    jump(number) {
      const line = this.editor.state.doc.line(Math.min(number, this.editor.state.doc.lines));
      this.editor.dispatch({ selection: { anchor: line.from, head: line.to }, effects: this.CM.EditorView.scrollIntoView(line.from, { y: "center" }) });
      this.editor.focus();
    },
    async chosen(event) {
      const files = [...event.target.files];
      event.target.value = "";
      this.$emit("load", { files: await textsOf(files) });
    },
  },
};
