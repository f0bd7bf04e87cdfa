// How sure the design is: one row for each figure, and the notes of the design.
const MARKS = { good: "✓", warning: "▲", remark: "●", unknown: "?" };
const TINTS = { good: "good", warning: "warn" };

export default {
  template: `
    <section class="sure-figures" aria-label="How sure" :aria-busy="!given">
      <p v-if="given?.words" class="warn">{{ given.words }}</p>
      <table class="figure-table">
        <thead class="unseen"><tr><th>state</th><th>figure</th><th>value and bound</th></tr></thead>
        <tbody>
          <tr v-for="row in given?.rows ?? []" :key="row.name" :data-standing="row.standing">
            <td><span :class="['chip', tint(row.standing)]"><span aria-hidden="true">{{ mark(row.standing) }}</span>{{ row.standing }}</span></td>
            <th scope="row">{{ capital(row.name) }}<span class="quiet small">{{ joined(row.sentence) }}</span></th>
            <td class="number">{{ row.value }}<span class="quiet small">{{ row.bound }}</span></td>
          </tr>
        </tbody>
      </table>
      <p v-if="given?.band" class="quiet small">Band of the law: {{ given.band }}.</p>
      <details v-if="given?.notes.length" open>
        <summary>{{ count }}</summary>
        <p v-for="note in given.notes" :key="note.text" :class="note.warns ? 'warn' : 'note'"><strong>{{ note.warns ? "Warning" : "Note" }}:</strong> {{ note.text }}</p>
      </details>
    </section>`,
  data() {
    return { given: null };
  },
  computed: {
    count() {
      const warnings = this.given.notes.filter((note) => note.warns).length;
      const parts = [[warnings, "warning"], [this.given.notes.length - warnings, "note"]];
      return parts.filter(([n]) => n).map(([n, word]) => `${n} ${word}${n > 1 ? "s" : ""}`).join(", ") + " of the design";
    },
  },
  methods: {
    show(given) { this.given = Object.freeze(given); },
    joined(text) { return text.replaceAll(" %", "\u00a0%"); }, // a number and its unit stay on one line
    mark(standing) { return MARKS[standing]; },
    tint(standing) { return TINTS[standing] ?? ""; },
    capital(text) { return text[0].toUpperCase() + text.slice(1); },
  },
};
