// The element of the law: the choices above the plot and the words below it. NiceGUI calls its methods with answers, and
// receives its events.
import { hear, remember } from "metafem-page/linked.js";
import { Plot } from "metafem-law/plot.js";

// What the line below the plot says at the first visit.
const [HINT, WELCOME] = ["metafem-hint", "Drag the points of the target law: the heights follow. “Take it” has the mould table, and “Menu” the help."];
// Buttons in the legend: their words, and the event that they emit.
const ACTS = {
  achieved: [["Pin", "pin", { on: true }]],
  pinned: [["Unpin", "pin", { on: false }]],
  measured: [["Remove", "measured", {}]],
};

export default {
  template: `
    <div :class="['law-plot', { dropping }]" data-answered="0" @dragover="dropping = $event.dataTransfer?.types.includes('Files')" @dragleave="dropping = false">
      <div class="law-tools head"><h2>Law</h2>
        <span class="choice law-axes" role="group" aria-label="Axes">
          <button type="button" title="Load P and friction F in newtons" :aria-pressed="newtons" :aria-disabled="tools.no_forces !== ''" @click="forces">N</button>
          <button type="button" title="Load P/E* and friction F/(σB), rescaled" :aria-pressed="!newtons" @click="$emit('axes', { newtons: false })">mm²</button>
        </span>
        <span class="choice" role="group" aria-label="Zoom">
          <button type="button" aria-label="Zoom out" title="Show more of the axes (−)" @click="plot.zoom(1.25)">−</button>
          <button type="button" aria-label="Zoom in" title="Show less of the axes (+); also Ctrl and the wheel" @click="plot.zoom(0.8)">+</button>
          <button type="button" title="Fit the axes to target and law (0)" @click="plot.zoom(0)">Fit</button>
        </span>
        <button type="button" class="act law-beside" aria-haspopup="dialog">Other models
          <q-menu class="law-models" role="dialog" aria-label="Other models" anchor="bottom right" self="top right" transition-duration="0">
            <label v-for="{ name, on } in tools.models" :key="name"><input type="checkbox" :name="name" :checked="on" @change="$emit('model', { name, on: $event.target.checked })"> {{ name }}</label></q-menu></button>
        <button type="button" class="act law-choose" title="Show a CSV table of a measured law; it can also be dropped onto the plot. Its first line names the columns with their units: load_N,friction_force_N or load_mN,area_mm2." @click="$refs.file.click()">Measured points…</button>
        <input ref="file" type="file" accept=".csv,.tsv,.txt,text/csv" hidden @change="choose">
      </div>
      <div class="law-stage" ref="stage">
        <svg class="law-svg" ref="svg" role="group" aria-label="Target law and achieved law. Points can be dragged, or moved with the arrow keys; the key a adds one, Delete removes one; + and - zoom, 0 shows all."></svg>
        <q-resize-observer debounce="0" @resize="plot?.resize()"></q-resize-observer>
        <output class="law-readout" ref="readout" aria-hidden="true"></output>
      </div>
      <div class="law-dock">
        <ul :key="legend.join()" class="law-legend" aria-label="Legend"><li v-for="[kind, words, more] in legend" :key="words" :title="more || null"><span :class="['key', kind]"></span>{{ words }}
          <button v-for="[act, name, event] in acts[kind]" :key="act" type="button" @click="$emit(name, event)">{{ act }}</button></li></ul>
        <div :class="['law-refusal', { away }]" :hidden="!refusal">
          <button type="button" class="law-away" :hidden="held" :aria-label="away ? 'Show the reason of the refusal' : 'Put the reason away'" @click="away = !away">{{ away ? "Why?" : "✕" }}</button>
          <em class="law-nearest" :hidden="!nearest"><i></i>nearest law that can be designed</em><span>{{ refusal }}</span>
          <button type="button" class="law-use" :hidden="!usable || held" @click="use">{{ offer }}</button></div>
      </div>
      <div :class="['law-live', { wrong }]"><span :aria-live="live">{{ words }}</span>
        <button type="button" class="law-drop" :hidden="!pointed" title="Remove this point (Delete)" @click="plot.remove(pointed)">Remove the point</button>
        <button type="button" class="law-use" :hidden="!offered" @click="use">{{ offer }}</button></div>
    </div>`,
  data() {
    return {
      tools: { models: [], no_forces: "" }, dropping: false, legend: [], acts: ACTS,
      refusal: "", away: false, held: false, nearest: false, usable: false, offer: "Use the nearest law", // the words of the button
      words: "", wrong: false, live: "polite", pointed: "", offered: false,
    };
  },
  computed: {
    newtons() { return Boolean(this.tools.newtons && !this.tools.no_forces); },
  },
  mounted() {
    this.plot = new Plot(this);
    if (!localStorage.getItem(HINT)) this.words = WELCOME;
    remember(HINT, "seen");
    hear("table", this.read, this.plot.closed.signal);
  },
  unmounted() { this.plot.close(); },
  methods: {
    draw(data) { this.plot.draw(data); },
    refuse(number, words) { this.plot.refuse(number, words); },
    say(words, wrong) { this.plot.say(words, wrong); },
    more(data) { this.plot.more(data); },
    use() {
      this.plot.offer = false;
      this.$emit("nearest", {});
    },
    forces() {
      if (this.tools.no_forces) this.say(this.tools.no_forces, true);
      else this.$emit("axes", { newtons: true });
    },
    choose({ target }) {
      if (target.files.length) this.read([...target.files]);
      target.value = ""; // the same file can be chosen again
    },
    async read(files) {
      this.dropping = false;
      const { textsOf } = await import("metafem-workshop/files.js");
      const [table, ...others] = await textsOf(files);
      if (table.why || others.length) this.say(others.length ? "Drop one file: a table with columns such as load_N,friction_force_N." : `${table.name} ${table.why}.`, true);
      else this.$emit("dropped", table);
    },
  },
};
