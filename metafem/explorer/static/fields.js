// The form of the workshop. What is typed stays in `drafts` until it is used; `values` are those of the specification.

// The unit behind a number.
const UNIT = /[^\d\s.,+-].*$/;

export default {
  template: `
    <form class="fields" @submit.prevent @focusin="told = $event.target.dataset.key ?? told" :aria-busy="busy">
      <p v-if="broken" class="warn">The text of the specification cannot be read, so its fields are locked: {{ broken }}
        <button type="button" class="act" @click="edit">Edit the text</button></p>
      <p v-for="each in loose" :key="each" class="warn">{{ each }}</p>
      <div class="parts">
        <details v-for="part in sections" :key="part.name" class="part" :data-section="part.name"
                 :open="opened[part.name] ?? part.open" @toggle="opened[part.name] = $event.target.open">
          <summary class="title"><h3>{{ part.title }}</h3><span v-if="!(opened[part.name] ?? part.open)" class="quiet small brief">{{ brief(part) }}</span></summary>
          <p v-if="problems[part.name]" class="wrong" role="alert">{{ problems[part.name] }}</p>
          <p v-if="!part.has" class="quiet small meaning">{{ part.meaning }}.</p>
          <div v-if="part.kinded" class="field">
            <label :for="id(part.name + '.kind')">kind</label>
            <div><select class="text" :aria-label="part.title + ', kind'" :id="id(part.name + '.kind')" :data-key="part.name + '.kind'" :disabled="!!broken" :value="part.kind"
                    @change="$emit('kind', { section: part.name, kind: $event.target.value })">
              <option v-if="part.optional" value="">default ({{ Object.keys(part.kinds)[0] }})</option>
              <option v-if="part.kind ? !(part.kind in part.kinds) : !part.optional" :value="part.kind">{{ part.kind || "choose" }}</option>
              <option v-for="(words, name) in part.kinds" :key="name" :value="name" :title="words">{{ part.kind_names[name] ?? name }}</option></select>
              <p class="quiet small">{{ part.kinds[part.kind] ?? part.kinds[Object.keys(part.kinds)[0]] }}</p>
              <p v-if="problems[part.name + '.kind']" class="wrong" role="alert">{{ problems[part.name + ".kind"] }}</p></div>
          </div>
          <div v-if="part.choices.size > 1" class="field wide">
            <label :for="id(part.name + '.given')">given by</label>
            <select class="text" :id="id(part.name + '.given')" :disabled="!!broken" :value="part.choice"
                    @change="$emit('choice', { section: part.name, choice: Number($event.target.value) })">
              <option v-for="[number, fields] in part.choices" :key="number" :value="number">{{ fields.map(({ label }) => label).join(", ") }}</option></select>
          </div>
          <div v-for="field in part.fields" :key="field.key"
               :class="['field', { wide: field.listed && field.units.length }]" :title="field.help">
            <label :for="id(field.key)">{{ field.label }}</label>
            <div>
              <select v-if="field.options.length" class="text" :id="id(field.key)" :data-key="field.key" :disabled="!!broken"
                      :aria-invalid="!!problem(field)" :value="values[field.key] ?? ''" @change="use(field, $event.target.value)">
                <option v-if="!field.options.some(([value]) => value === (values[field.key] ?? ''))" :value="values[field.key]">{{ values[field.key] }}</option>
                <option v-for="[value, words] in field.options" :key="value" :value="value">{{ words }}</option></select>
              <input v-else class="text" type="text" maxlength="100000" autocomplete="off" spellcheck="false" :id="id(field.key)" :data-key="field.key" :disabled="!!broken"
                     :value="drafts[field.key] ?? values[field.key] ?? ''" :placeholder="field.placeholder" :data-clean="field.key in drafts ? null : ''" :aria-invalid="!!problem(field)"
                     :aria-describedby="id(field.key) + '-help ' + id(field.key) + '-wrong'" @input="drafts[field.key] = $event.target.value"
                     @change="leave(field)" @blur="leave(field)" @keydown.enter="leave(field)" @keydown.esc="restore(field)">
              <span :id="id(field.key) + '-help'" class="unseen">{{ field.help }}</span>
              <p v-for="each in warnings[field.key]" :key="each" class="cautious small">{{ each }}</p>
              <p :id="id(field.key) + '-wrong'" v-if="problem(field)" class="wrong" role="alert">{{ problem(field) }}</p>
              <button v-if="remedy(field)" type="button" class="act" @click="use(field, remedy(field))">Use {{ remedy(field) }}</button>
            </div></div>
          <button v-if="part.optional && !part.kinded && (!part.always || present.includes(part.name))" type="button" class="act" :disabled="!!broken" :aria-label="(part.has ? 'Remove ' : 'Add ') + part.title"
                  @click="$emit(part.has ? 'removed' : 'added', part.name)">{{ part.has ? "Remove" : "Add" }}</button>
        </details>
      </div>
      <p class="told small" aria-hidden="true">{{ telling }}</p>
    </form>`,
  props: { parts: Array },
  data() {
    return { values: {}, present: [], problems: {}, offers: {}, warnings: {}, refused: {}, drafts: {}, opened: {}, broken: "", told: "", busy: true };
  },
  computed: {
    // The sections that are shown, with their kinds and fields. One inside another section is shown if that one is of a
    // kind with it.
    sections() {
      const { values, present } = this;
      const radius = "lattice.radius" in values || !present.includes("tools");
      return this.parts.filter(({ inner }) => !inner || values[inner.key] === inner.kind).map((part) => {
        const [kinded, kind] = [Object.keys(part.kinds).length > 0, values[`${part.name}.kind`] ?? ""];
        const has = part.always || present.includes(part.name);
        const keys = (has && part.keys[kinded ? kind : ""]) || [];
        const chosen = keys.filter((field) => field.choice !== null);
        const choice = chosen.find(({ key }) => key in values)?.choice ?? 0; // the one of which a key is given
        const fields = keys.filter(({ key, choice: of }) => (key !== "lattice.radius" || radius) && (of === null || of === choice || key in values));
        return { ...part, kinded, kind, has, choices: Map.groupBy(chosen, (field) => field.choice), choice, fields };
      });
    },
    fields() { return this.sections.flatMap((part) => part.fields); },
    loose() {  // what belongs to none of the fields that are shown
      const places = [...this.sections.flatMap(({ name }) => [name, `${name}.kind`]), ...this.fields.map(({ key }) => key)];
      return this.broken ? [] : Object.entries(this.problems).filter(([key]) => !places.includes(key)).map(([, words]) => words);
    },
    telling() { // a key can mean something else in another kind
      return this.fields.find(({ key }) => key === this.told)?.help ?? "Each value is used with Enter or on leaving its field.";
    },
  },
  methods: {
    show(data) {
      const named = (each) => Object.keys({ ...each.problems, ...each.offers });
      for (const key of named(data).filter((each) => !named(this).includes(each))) { // a new one is seen
        for (const { name } of this.parts) if (key === name || key.startsWith(`${name}.`)) this.opened[name] = true;
      }
      Object.assign(this, data);
      if (data.values) this.refused = {};
      this.busy = false;
    },
    edit() {
      const tab = [...document.querySelectorAll("[role=tab]")].find((each) => each.textContent.trim() === "Specification");
      tab?.click();
      tab?.focus(); // this button is gone
    },
    refuse({ key, words }) { this.refused[key] = words; },
    id(key) { return `field-${key.replaceAll(".", "-")}`; },
    problem(field) { return this.refused[field.key] ?? this.problems[field.key]; },
    brief(part) {  // what a closed section holds
      if (!this.present.includes(part.name)) return "not used";
      const told = (field) => { // a number without a unit needs its name
        const value = this.values[field.key];
        return value && !UNIT.test(value) ? `${field.label} ${value}` : value;
      };
      return part.fields.map(told).filter(Boolean).join(" · ");
    },
    remedy(field) {  // a number without a unit, with the one of the example, or the value that the server offers
      const given = (this.values[field.key] ?? "").trim();
      const unit = UNIT.exec(field.example.split(",")[0])?.[0];
      const bare = this.problem(field) && field.units.length && unit && /^[+-]?(\d+\.?\d*|\.\d+)$/.test(given);
      return bare ? `${Number(given)} ${unit}` : this.offers[field.key];
    },
    restore({ key }) {
      delete this.drafts[key];
      delete this.refused[key];
    },
    use(field, text) {
      this.restore(field);
      this.values = { ...this.values, [field.key]: text };
      this.$emit("typed", { key: field.key, text });
    },
    leave(field) {
      const text = this.drafts[field.key];
      if (text === undefined) return;
      if (text === (this.values[field.key] ?? "") && !this.problem(field)) delete this.drafts[field.key];
      else this.use(field, text);
    },
  },
};
