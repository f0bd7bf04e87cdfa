// The head of the page: the target in words, the status, the model, undo and redo, the colours, help.
// It also takes the files that are dropped, and hands those on the plot of the law to it.
import { hear, remember, tell } from "metafem-page/linked.js";

const THEMES = { light: "Light", auto: "Auto", dark: "Dark" };
const CALM = 700;  // milliseconds without a new status, after which screen readers are told
const THEME = "metafem-theme";
const MAC = navigator.platform.startsWith("Mac");
const CTRL = MAC ? "⌘" : "Ctrl+";

// Whether keys that are typed belong to an element. A field in which nothing has been typed leaves undo to the page.
const TEXTS = "input:not([type=checkbox], [type=radio], [type=range], [data-clean]), textarea, [contenteditable='true'], .cm-editor";
const typing = (element) => element?.closest?.(TEXTS) != null;
const writing = (element) => typing(element) || element?.matches?.("[data-clean], select");

export default {
  template: `
    <header class="bar">
      <a class="skip act" href="#law" @click.prevent="skip">Skip to the law</a>
      <h1>metafem</h1>
      <p class="title" :title="title">{{ title }}</p>
      <span class="status">
        <span v-if="lost" class="chip lost-chip" title="What is shown is the last answer. It can be changed again as soon as metafem explore runs.">no server: changes must wait</span>
        <span v-else :class="['chip', kind]" :title="meaning">{{ status }}<span v-if="measure" :key="status" class="measure"> ({{ measure }})</span></span>
        <span v-if="part && !lost" class="chip warn part" :title="part">no part can be made</span>
        <button :class="['act', 'stop', { idle: !late || lost }]" title="Stop this computation, and return to what is shown" @click="$emit('stop')">Stop</button>
      </span>
      <span class="unseen" role="status">{{ announced }}</span>
      <span class="tools">
        <label class="row"><span>Model</span>
          <select :class="['text', { pending: model !== solved }]" aria-label="Model" :disabled="lost" :value="model" :title="model === solved ? '' : 'Being computed; what is shown is the law under ' + solved" @change="model = $event.target.value; $emit('model', model)">
            <option v-if="!models.includes(model)" :value="model">{{ model }}</option>
            <option v-for="each in models" :key="each" :value="each">{{ each }}</option>
          </select>
        </label>
        <span class="row pair">
          <button class="act icon" :aria-disabled="!undo || lost" title="Undo (${CTRL}Z)" aria-label="Undo" @click="undo && !lost && $emit('undo')">↶</button>
          <button class="act icon" :aria-disabled="!redo || lost" title="Redo (${CTRL}${MAC ? "⇧" : "Shift+"}Z)" aria-label="Redo" @click="redo && !lost && $emit('redo')">↷</button>
        </span>
        <select class="text anew" aria-label="Start over" :disabled="lost" title="Start over from an example; undo brings back what was" @change="begin">
          <option value="">Start over</option><option value="first">as this page began</option>
          <option v-for="name in demos" :key="name" :value="name">{{ name }}</option></select>
        <button class="act" title="A part of your own from a few values; undo brings back what was" :disabled="lost" @click="$emit('part')">New part</button>
        <slot></slot>
        <span class="choice" role="group" aria-label="Colours of the page">
          <button v-for="(word, name) in themes" :key="name" :aria-pressed="theme === name" @click="choose(name)">{{ word }}</button>
        </span>
        <button class="act" title="Mouse, touch and keys (?)" @click="open">Help</button>
      </span>
      <dialog ref="dialog" aria-labelledby="help-title" @click="outside">
        <div class="head"><h2 id="help-title">Mouse, touch and keys</h2><button class="act" @click="tour">Tour of a minute</button><button class="act" autofocus @click="$refs.dialog.close()">Close</button></div>
        <div v-html="keys"></div>
      </dialog>
    </header>`,
  props: { models: Array, first: String, demos: Array, help: String },
  data() {
    return {
      title: "", status: "designing …", kind: "", measure: "", meaning: "", part: "", announced: "", model: this.first, solved: this.first, late: false, undo: false, redo: false,
      theme: localStorage.getItem(THEME) ?? "auto", lost: false, themes: THEMES,
    };
  },
  computed: {
    keys() { return MAC ? this.help.replaceAll("Ctrl+Shift+", "⌘⇧").replaceAll("Ctrl+", "⌘") : this.help; },
  },
  mounted() {
    this.choose(this.theme in THEMES ? this.theme : "auto");
    this.closed = new AbortController();
    const { signal } = this.closed;
    document.addEventListener("keydown", this.key, { signal });
    document.addEventListener("dragover", this.over, { signal });
    document.addEventListener("drop", this.drop, { signal, capture: true });
    hear("lost", this.wait, signal);
  },
  unmounted() {
    this.closed.abort();
    clearTimeout(this.timer);
  },
  watch: {
    status() {  // once for a drag or some keys
      clearTimeout(this.timer);
      this.timer = setTimeout(() => { this.announced = this.status; }, CALM);
    },
  },
  methods: {
    show(data) { Object.assign(this, data); },
    choose(theme) {
      this.theme = theme;
      remember(THEME, theme);
      Quasar.Dark.set(theme === "auto" ? "auto" : theme === "dark");
    },
    key(event) {
      if (event.altKey || event.defaultPrevented || typing(event.target)) return;
      const [name, control] = [event.key.toLowerCase(), event.ctrlKey || event.metaKey];
      if (event.key === "?" && !control && !writing(event.target)) this.open();
      else if (this.lost) return;
      else if (control && (name === "y" || (name === "z" && event.shiftKey))) this.$emit("redo");
      else if (control && name === "z") this.$emit("undo");
      else return;
      event.preventDefault();
    },
    open() {
      if (!this.$refs.dialog.open) this.$refs.dialog.showModal();
    },
    async tour() {
      this.$refs.dialog.close();
      (await import("metafem-page/tour.js")).start();
    },
    outside(event) {  // the ground behind the dialog is the dialog itself
      if (event.target === this.$refs.dialog) this.$refs.dialog.close();
    },
    over(event) {
      if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
    },
    async drop(event) {  // the browser would leave the page and open the file
      if (!event.dataTransfer?.types.includes("Files")) return;
      // taken before the first wait: the browser empties the transfer afterwards
      const files = [...event.dataTransfer.files];
      const folder = [...event.dataTransfer.items ?? []].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
      event.preventDefault();
      event.stopPropagation();
      event.target.closest?.(".dropping")?.dispatchEvent(new Event("dragleave"));
      const given = folder || files.some((file) => /\.toml$/i.test(file.name));
      if (event.target.closest?.(".law-plot") && !given) return tell("table", files);
      const { textsIn, textsOf } = await import("metafem-workshop/files.js");
      this.$emit("load", { files: await (folder ? textsIn(folder) : textsOf(files)) });
    },
    wait(lost) {  // a server that is started again knows no change that was made meanwhile
      this.lost = lost;
      document.querySelector(".explorer").inert = lost;
    },
    begin(event) {
      if (event.target.value) this.$emit("begin", event.target.value);
      event.target.value = "";
    },
    skip() {  // not by the fragment of the address, which holds the state
      document.querySelector(".explorer > .law")?.focus();
    },
  },
};
