// The head of the page: the target in words, the status, the model, undo and redo, and the menu.
// It also takes the files that are dropped.
import { uploader } from "metafem/linked.js";

const THEMES = { light: "Light", auto: "Auto", dark: "Dark" };
const CALM = 700;  // milliseconds without a new status, after which screen readers are told
const THEME = "metafem-theme";

// Whether keys that are typed belong to an element. A field in which nothing has been typed leaves undo to the page.
const TEXTS = "input:not([type=checkbox], [type=radio], [type=range], [data-clean]), textarea, [contenteditable='true'], .cm-editor";
const typing = (element) => element?.closest?.(TEXTS) != null;
const writing = (element) => typing(element) || element?.matches?.("[data-clean], select");

export default {
  template: `
    <header class="bar">
      <h1>metafem</h1>
      <p class="title" :title="title">{{ title }}</p>
      <span class="status">
        <span class="told"><span :class="['chip', part ? 'warn' : kind]" tabindex="0" :title="details" aria-describedby="status-details">{{ words }}</span>
          <span id="status-details" class="details">{{ details }}</span></span>
        <button v-if="stopped && !late" class="act stop" @click="$emit('compute')">Compute again</button>
        <button v-else :class="['act', 'stop', { idle: !late }]" title="Stop this computation, and return to what is shown" @click="$emit('stop')">Stop</button>
      </span>
      <span class="unseen" role="status">{{ announced }}</span>
      <span class="tools">
        <label class="row"><span>Model</span>
          <select :class="['text', { pending: model !== solved }]" aria-label="Model" :value="model" :title="model === solved ? '' : 'Being computed; what is shown is the law under ' + solved" @change="model = $event.target.value; $emit('model', model)">
            <option v-if="!models.includes(model)" :value="model">{{ model }}</option>
            <option v-for="each in models" :key="each" :value="each">{{ each }}</option>
          </select>
        </label>
        <span class="row pair">
          <button class="act icon" :aria-disabled="!undo" title="Undo (Ctrl+Z)" aria-label="Undo" @click="undo && $emit('undo')">↶</button>
          <button class="act icon" :aria-disabled="!redo" title="Redo (Ctrl+Shift+Z)" aria-label="Redo" @click="redo && $emit('redo')">↷</button>
        </span>
        <button class="act" title="A part of your own from a few values; undo brings back what was" @click="$emit('part')">New part</button>
        <button class="act" aria-haspopup="true" :aria-expanded="opened">Menu
          <q-menu v-model="opened" class="bar-menu" anchor="bottom right" self="top right" transition-duration="0">
            <div role="group" aria-labelledby="menu-starts"><h3 id="menu-starts">Start over</h3>
              <button v-for="name in starts" :key="name" v-close-popup title="Undo brings back what was" @click="$emit('begin', name)">{{ name }}</button></div>
            <div role="group" aria-labelledby="menu-colours"><h3 id="menu-colours">Colours of the page</h3>
              <button v-for="(word, name) in themes" :key="name" v-close-popup :aria-pressed="theme === name" @click="choose(name)">{{ word }}</button></div>
            <div role="group" aria-labelledby="menu-help"><h3 id="menu-help">How to use it</h3>
              <button v-close-popup @click="open">Help: mouse, touch and keys (?)</button></div></q-menu></button>
      </span>
      <dialog ref="dialog" aria-labelledby="help-title" closedby="any">
        <div class="head"><h2 id="help-title">Mouse, touch and keys</h2><button class="act" autofocus @click="$refs.dialog.close()">Close</button></div>
        <div v-html="help"></div>
      </dialog>
    </header>`,
  props: { models: Array, starts: Array, help: String },
  data() {
    return {
      title: "", status: "designing …", kind: "", meaning: "", part: "", announced: "", model: this.models[0], solved: this.models[0], late: false, stopped: false,
      undo: false, redo: false, opened: false, theme: localStorage.getItem(THEME) ?? "auto", themes: THEMES,
    };
  },
  computed: {
    words() { return this.part ? `${this.status}; no part can be made` : this.status; },
    details() { return [this.meaning, this.part].filter(Boolean).join(" "); },
  },
  mounted() {
    this.choose(this.theme in THEMES ? this.theme : "auto");
    document.addEventListener("keydown", this.key);
    document.addEventListener("dragover", this.over);
    document.addEventListener("drop", this.drop, { capture: true });
  },
  watch: {
    words() {  // once for a drag or some keys
      clearTimeout(this.timer);
      this.timer = setTimeout(() => { this.announced = this.words; }, CALM);
    },
  },
  methods: {
    show(data) { Object.assign(this, data); },
    choose(theme) {
      this.theme = theme;
      localStorage.setItem(THEME, theme);
      Quasar.Dark.set(theme === "auto" ? "auto" : theme === "dark");
    },
    key(event) {
      if (event.altKey || event.defaultPrevented || typing(event.target)) return;
      const [name, control] = [event.key.toLowerCase(), event.ctrlKey || event.metaKey];
      if (event.key === "?" && !control && !writing(event.target)) this.open();
      else if (control && (name === "y" || (name === "z" && event.shiftKey))) this.$emit("redo");
      else if (control && name === "z") this.$emit("undo");
      else return;
      event.preventDefault();
    },
    open() { if (!this.$refs.dialog.open) this.$refs.dialog.showModal(); },
    over(event) {
      if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
    },
    drop(event) {  // the browser would leave the page and open the file
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      event.stopPropagation();
      uploader().addFiles(event.dataTransfer.files);
    },
  },
};
