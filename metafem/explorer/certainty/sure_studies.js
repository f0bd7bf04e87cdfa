// Studies that run beside the page: a button, the progress, and what they found. The browser keeps what they found,
// so that a reload does not lose minutes of work; a result of another state than the one shown is marked.
import { kept, remember } from "metafem-page/linked.js";

const KEY = "metafem-studies";

export default {
  template: `
    <section class="sure-studies" aria-label="Longer studies">
      <p class="quiet small">The page can be used while a study runs.</p>
      <article v-for="study in studies" :key="study.key" class="card" :data-study="study.key">
        <div class="row">
          <h3>{{ study.title }}</h3>
          <button v-if="!of(study).running" class="act" :disabled="!!hindered[study.key]" :aria-label="(of(study).found ? 'Run again: ' : 'Run: ') + study.title"
                  @click="$emit('start', study.key)">{{ of(study).found ? "Run again" : "Run" }}</button>
          <button v-else class="act" :aria-label="'Stop: ' + study.title" @click="$emit('stop', study.key)">Stop</button>
        </div>
        <p class="quiet small">{{ study.question }} Takes {{ study.duration }}.</p>
        <p v-if="hindered[study.key]" class="small">{{ hindered[study.key] }}</p>
        <div v-if="of(study).running" class="progress">
          <progress max="1" :value="of(study).done ?? undefined" :aria-label="study.title"></progress>
          <span class="small">{{ time(study) }}</span>
          <p class="quiet small step">{{ of(study).step }}</p>
        </div>
        <p v-else-if="of(study).step" class="quiet small" role="status">{{ of(study).step }}</p>
        <p v-if="of(study).error" class="warn" role="alert">{{ of(study).error }}</p>
        <div v-if="of(study).found" :class="{ stale: stale(study) }" role="status">
          <p v-if="stale(study)" class="chip warn">▲ found for another specification</p>
          <p v-if="of(study).found.answer" class="answer">{{ of(study).found.answer }}</p>
          <figure v-if="of(study).found.picture" v-html="of(study).found.picture"></figure>
          <details>
            <summary>{{ of(study).found.title }}</summary>
            <div class="scroll"><table class="figure-table small">
              <thead><tr><th v-for="name in of(study).found.columns" :key="name">{{ name }}</th></tr></thead>
              <tbody><tr v-for="(row, i) in of(study).found.rows" :key="i"><td v-for="(cell, j) in row" :key="j">{{ cell }}</td></tr></tbody>
            </table></div>
            <p v-for="note in of(study).found.notes" :key="note.text" :class="['small', note.level === 'warning' ? 'warn' : 'note']">{{ note.text }}.</p>
          </details>
        </div>
      </article>
    </section>`,
  props: { studies: Array },
  data() {
    return { states: kept(KEY), hindered: {}, shown: "", now: 0 };
  },
  mounted() {
    // The time that has passed is shown also while a step takes long.
    this.clock = setInterval(() => { this.now = performance.now(); }, 1000);
    this.$emit("ready");
  },
  unmounted() { clearInterval(this.clock); },
  methods: {
    of(study) { return this.states[study.key] ?? {}; },
    stale(study) { return this.of(study).found.of !== this.shown; },
    follow({ shown, hindered }) { Object.assign(this, { shown, hindered }); },
    change(key, change) {
      const before = this.states[key] ?? {};
      const begun = change.running ? performance.now() : before.begun;
      if (change.found) Object.freeze(change.found);
      this.states[key] = { ...before, ...change, begun };
      if (change.found) this.keep();
    },
    time(study) {
      const { begun, done } = this.of(study);
      const passed = Math.max(0, (Math.max(this.now, begun) - begun) / 1000);
      const left = done > 0.05 && passed > 1 ? `, about ${Math.max(1, Math.ceil(passed / done - passed))} s left` : "";
      return `${Math.round(passed)} s${left}`;
    },
    keep() {
      const found = Object.entries(this.states).filter(([, state]) => state.found).map(([key, state]) => [key, { found: state.found }]);
      remember(KEY, JSON.stringify(Object.fromEntries(found)), sessionStorage);
    },
  },
};
