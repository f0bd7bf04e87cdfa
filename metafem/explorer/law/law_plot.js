// The element of the law: NiceGUI calls its methods with answers, and receives its events.
import { Plot } from "metafem-law/plot.js";

export default {
  template: `
    <div class="law-plot" data-answered="0">
      <div class="law-tools head"></div>
      <div class="law-stage">
        <svg class="law-svg" role="group" aria-label="Target law and achieved law. Points can be dragged, or moved with the arrow keys; the key a adds one, Delete removes one."></svg>
        <output class="law-readout" aria-hidden="true"></output>
      </div>
      <div class="law-dock"><ul class="law-legend" aria-label="Legend"></ul>
        <div class="law-refusal" hidden><button type="button" class="law-away"></button><em class="law-nearest" hidden><i></i>nearest law that can be designed</em><span></span><button type="button" class="law-use">Use the nearest law</button></div></div>
      <div class="law-live"><span aria-live="polite"></span><button type="button" class="law-drop" hidden title="Remove this point (Delete)">Remove the point</button><button type="button" class="law-use" hidden>Use the nearest law</button><button type="button" class="law-tour" hidden>Take a tour of a minute</button></div>
    </div>`,
  mounted() {
    this.plot = new Plot(this.$el, (name, data) => this.$emit(name, data));
    this.$nextTick(() => this.plot.connect()); // the socket is made when all elements are mounted
  },
  unmounted() { this.plot.close(); },
  methods: {
    draw(data) { this.plot.draw(data); },
    refuse(number, words) { this.plot.refuse(number, words); },
    say(words, wrong) { this.plot.say(words, wrong); },
    more(data) { this.plot.more(data); },
  },
};
