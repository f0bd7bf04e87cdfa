// The surface: map and picture in three dimensions, with a menu for the sites that are selected.
import { Press, told, words } from "metafem/contacts.js";
import { ARROWS, Chosen, SAME, shared } from "metafem/linked.js";
import SiteMap, { neighbour } from "metafem/map.js";
import { placeIn } from "metafem/plot.js";

// First and largest exaggeration of the heights in 3D.
const EXAGGERATION = { first: 4, most: 20 };
// Milliseconds from the smallest to the largest load; steps of the slider; and steps instead of motion.
const [PLAY, SLIDER, STILL] = [6000, 250, 5];
// Most caps in 3D: more would be smaller than a pixel, and hold up a browser without a graphics card for seconds.
const MOST_CAPS = 20000;
// Distance of the tip from the pointer [pixels].
const GAP = 14;
const ACTIONS = { p: "pin", e: "empty", r: "release" };

export default {
  components: { SiteMap },
  template: `
    <div :class="['surface-view', 'fill', { old }]" data-answered="0">
      <div class="head"><h2>Surface</h2>
        <q-tabs v-model="tab" dense no-caps aria-label="View of the surface" @update:model-value="open"><q-tab name="map" label="Map"/><q-tab name="relief" label="3D" :disable="many"/></q-tabs>
        <label class="small">Colour <select class="text" v-model="what" @change="recolour" aria-label="Colour of the sites">
          <option value="height">height</option><option v-if="radii" value="radius">radius</option><option value="pressure">contact pressure</option><option value="sensitivity">sensitivity</option>
        </select></label>
      </div>
      <div class="small line" role="status"><p v-if="message" class="wrong">{{ message }}</p><p v-if="(line || note) && !(message && old)">{{ line }} {{ note }}</p></div>
      <div class="box fill" ref="box" @keydown.esc="close">
        <q-resize-observer debounce="0" @resize="picture()?.resize()"></q-resize-observer>
        <site-map v-show="tab === 'map'" ref="map" :marks="marks" @hover="hover" @pick="pick" @key="key" @enter="surface && go(marks.active ?? 0)"/>
        <div v-show="tab === 'relief'" class="layer" ref="relief"></div>
        <p v-if="tab === 'relief' && missing" class="note">{{ missing }}</p>
        <div class="row small" v-else-if="tab === 'relief'">
          <label>Heights × {{ times }} <input type="range" min="1" max="${EXAGGERATION.most}" step="0.5" v-model.number="times" @input="draw(true)" aria-label="Exaggeration of the heights"></label>
          <button type="button" class="act" @click="picture()?.reset()">Reset the view</button>
        </div>
        <div v-if="at && lines.length" class="tip" :style="at"><div v-for="each in lines">{{ each }}</div></div>
        <div v-if="menu" class="menu" role="dialog" :aria-label="menu.title" :style="menu.style" ref="menu">
          <b>{{ menu.title }}</b>
          <button type="button" class="away" aria-label="Close" @click="close">×</button>
          <button v-if="menu.filled" type="button" class="act" data-action="pin" @click="send('pin')">{{ menu.kept ? "Keep this height: " + menu.kept : "Keep these heights" }}</button>
          <button v-if="menu.asked" type="button" class="act" data-action="release" @click="send('release')">{{ menu.filled ? "Let the design choose" : "Fill " + menu.these }}</button>
          <form @submit.prevent="send('pin', typed)"><label>Height <input class="text" v-model="typed" required inputmode="decimal" :placeholder="menu.kept || '150.0 µm'" aria-label="Height in micrometres"></label>
            <button type="submit" class="act" data-action="type">Set</button></form>
          <button v-if="menu.filled" type="button" class="act" data-action="empty" @click="send('empty')">Leave {{ menu.these }} empty</button>
        </div>
      </div>
      <div class="press">
        <button type="button" class="act main" :disabled="!contacts" @click="play">{{ playing ? "❚❚ Pause" : "▶ Press it" }}</button>
        <input type="range" min="0" max="${SLIDER}" :value="place" :disabled="!contacts" aria-label="Load" :aria-valuetext="told" @input="slide($event, true)" @change="slide($event, false)">
        <span title="Load over the area of all contacts, and load">{{ playing && !press ? "The contacts at all loads are being computed …" : told }}</span>
      </div>
      <p class="legend" :class="{ spoken }" aria-live="polite"><template v-if="spoken">{{ spoken }}</template>
        <template v-else-if="tab === 'map'"><span><i class="disc"></i> contact, to scale</span> <span>■ kept height</span> <span><i class="ring"></i> empty site, × kept empty</span></template>
        <template v-else-if="!missing"><span><i class="disc coloured"></i> contact</span> <span>Caps are drawn undeformed, cut off at the glass.</span></template></p>
    </div>`,
  data() {
    return {
      tab: "map", what: "height", line: "", message: "", old: false, note: "", lines: [], at: null, shared, menu: null, typed: "",
      missing: "", times: EXAGGERATION.first, playing: false, place: 0,
      surface: null, contacts: null, // frozen, so that Vue does not follow thousands of numbers
    };
  },
  computed: {
    // What is said of the sites that are not at the pointer, where the tip says it.
    spoken() { return this.at ? "" : this.lines.join(", "); },
    press() { return this.shared.press; },
    many() { return (this.surface?.height.length ?? 0) > MOST_CAPS; },
    radii() { return Array.isArray(this.surface?.radius); },
    told() { return this.contacts ? told(this.contacts, this.surface.modulus) : ""; },
  },
  created() {
    // Not reactive, either.
    this.marks = { pointed: new Set(), selected: new Set(), active: null }; // pointed at: here, or at their tick of the law
    this.chosen = new Chosen();
  },
  unmounted() {
    this.playing = false;
    this.solid?.end();
  },
  watch: {
    "shared.load"(to) { this.move(to); },
    "shared.sites"(sites) { this.point(sites); },
    "$q.dark.isActive"() { this.draw(); },
  },
  methods: {
    picture() { return this.tab === "map" ? this.$refs.map : this.solid; },
    show(data) {
      if (data.layout) {
        this.layout = data.layout;
        this.menu = null;
        Object.assign(this.marks, { pointed: new Set(), selected: new Set(), active: null });
      }
      Object.assign(this, { message: data.message, old: data.old, number: data.number });
      if (data.height) { // otherwise it is as before
        this.surface = Object.freeze({ ...data, empty: new Set(data.empty) });
        this.chosen = new Chosen();
        shared.press = null;
        if (this.playing) shared.load = { load: Math.min(this.contacts.load, data.loads[1]), moving: false };
      }
      if (this.what === "radius" && !this.radii) {
        this.what = "height";
        this.recolour();
      }
      this.paint();
    },
    contact(data) {
      this.line = data.problem ?? "";
      this.note = data.note ?? "";
      if (this.chosen.isShownBy(data.load)) this.take(data.problem ? null : data);
    },
    // The contacts at all loads, for the surface that is shown.
    pressed(data) {
      shared.press = data.states.length ? Object.freeze(new Press(data)) : null;
      this.playing &&= Boolean(this.press);
      if (this.playing) this.run();
    },
    take(contacts) {
      this.contacts = Object.freeze(contacts);
      if (contacts) this.place = Math.round(SLIDER * this.partOf(contacts.load));
      this.draw();
    },
    // Follows the load, which is dragged here or in the law, or played.
    move(to) {
      this.chosen.take(to);
      this.playing = Boolean(to.playing);
      if (this.press) this.take(this.press.at(to.load));
    },
    // Part of the way from the smallest to the largest load.
    partOf(load) {
      const [first, last] = this.surface.loads;
      return (load - first) / (last - first || 1);
    },
    goTo(part, more) {
      const [first, last] = this.surface.loads;
      shared.load = { load: first + part * (last - first), ...more };
    },
    slide(event, moving) { this.goTo(event.target.value / SLIDER, { moving }); },
    async play() {
      if (this.playing) return this.goTo(this.partOf(this.contacts.load), { moving: false });
      this.playing = true;
      if (this.tab === "map" && !this.many) await this.open("relief");
      if (this.missing) this.open("map");
      if (this.press) this.run();
    },
    run() {
      cancelAnimationFrame(this.playedFrame);
      const at = this.partOf(this.contacts.load);
      const from = at < 1 - SAME ? at : 0; // from the start where the load is the largest, up to its last bits
      const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
      let start = null;
      const frame = (now) => {
        if (!this.playing) return;
        start ??= now - PLAY * from;
        let part = Math.min(1, (now - start) / PLAY);
        if (still) part = Math.ceil(STILL * part) / STILL;
        this.goTo(part, { moving: part < 1, playing: part < 1 });
        this.playedFrame = requestAnimationFrame(frame);
      };
      this.playedFrame = requestAnimationFrame(frame);
    },
    // Paints in the next frame; `now` also in three dimensions.
    draw(now = this.chosen.moving) {
      this.now ||= now;
      this.frame ??= requestAnimationFrame(() => this.paint());
    },
    paint() {
      cancelAnimationFrame(this.frame);
      this.frame = null;
      const { layout, surface, contacts } = this;
      if (layout && surface) {
        const fitting = contacts?.radius?.length === layout.x.length ? contacts : null;
        this.picture()?.show(layout, surface, fitting, { what: this.what, dark: this.$q.dark.isActive, times: this.times }, this.now);
        if (this.menu) Object.assign(this.menu, this.described());
        if (this.at || !this.chosen.moving) this.describe(); // not said with each frame of a play
      }
      this.now = false;
      if (this.number) this.$el.dataset.answered = this.number;
    },
    async open(tab) {
      this.close();
      this.tab = tab;
      if (tab === "relief") await (this.started ??= this.start());
      this.picture()?.resize();
      this.draw();
    },
    // The script of the picture in three dimensions is loaded when it is opened.
    async start() {
      try {
        const { Relief } = await import("metafem/relief.js");
        const relief = new Relief(this.$refs.relief);
        await relief.start();
        this.solid = relief;
      } catch (error) {
        console.warn(error);
        this.missing = "This browser has no WebGL, so the surface cannot be drawn in three dimensions. The map shows the same heights.";
      }
    },
    recolour() {
      this.$emit("colour", this.what);
      this.draw();
    },
    // Under the pointer, null where there is no site.
    hover(site, event) {
      const told = site !== null && this.surface && !this.menu;
      this.at = told ? this.beside(event) : null;
      shared.sites = told ? [site] : [];
    },
    // Above or below the pointer, where there is more room, and as far to the left as the pointer is to the right.
    beside(event) {
      const [{ x, y }, { clientWidth: width, clientHeight: height }] = [placeIn(this.$refs.box, event), this.$refs.box];
      return { left: `${x}px`, transform: `translateX(-${(100 * x) / width}%)`, ...(y > height / 2 ? { bottom: `${height - y + GAP}px` } : { top: `${y + GAP}px` }) };
    },
    // Marks the sites under the pointer, here or at their tick of the law.
    point(sites) {
      if (!this.surface) return;
      this.marks.pointed = new Set(sites);
      this.describe();
      this.$refs.map.mark();
    },
    describe() {
      const [first, ...others] = this.marks.pointed;
      if (others.length) this.lines = [`${others.length + 1} sites come into contact together`];
      else this.lines = first === undefined ? [] : words(first, this.surface, this.contacts, this.press);
    },
    pick(sites, add) {
      const { marks } = this;
      if (!add) marks.selected = new Set();
      const single = sites.length === 1 && marks.selected.has(sites[0]);
      sites.forEach((site) => (single ? marks.selected.delete(site) : marks.selected.add(site)));
      if (sites.length) marks.active = sites.at(-1);
      this.hover(null);
      if (marks.selected.size) this.openMenu(); else this.close();
      this.$refs.map.mark();
    },
    openMenu() {
      const [x, y] = this.$refs.map.placeOf(this.marks.active);
      const { clientWidth: width, clientHeight: height } = this.$refs.box;
      this.typed = "";
      // in the corner away from the site, where the sites around it stay free
      this.menu = { style: { [x > width / 2 ? "left" : "right"]: 0, [y > height / 2 ? "top" : "bottom"]: 0 }, ...this.described() };
    },
    described() {
      const { surface } = this;
      const sites = [...this.marks.selected];
      const single = sites.length === 1;
      const height = single ? surface.height[sites[0]] : null;
      return {
        title: single ? `Site ${sites[0] + 1}` : `${sites.length} sites`,
        these: single ? "this site" : "these sites",
        filled: sites.some((i) => surface.height[i] !== null && !surface.empty.has(i)),
        asked: sites.some((i) => surface.empty.has(i) || surface.pinned[i] !== undefined),
        kept: height === null ? "" : `${height.toFixed(1)} µm`,
      };
    },
    close() {
      const inside = this.$refs.menu?.contains(document.activeElement);
      this.menu = null;
      this.marks.selected = new Set();
      this.$refs.map.mark();
      if (inside) this.$refs.map.$refs.svg.focus();
    },
    send(action, height = "") {
      const { selected, active } = this.marks;
      const sites = selected.size ? [...selected] : active === null ? [] : [active];
      if (sites.length) this.$emit("sites", { action, sites, height });
      this.close();
    },
    go(site, select) {
      const { marks } = this;
      if (select) [marks.active, site].forEach((each) => marks.selected.add(each));
      marks.active = site;
      this.at = null;
      shared.sites = [site];
    },
    key(event) {
      const { marks } = this;
      if (event.ctrlKey || event.metaKey || event.altKey || !this.surface) return;
      if (ARROWS[event.key]) this.go(neighbour(this.layout, marks.active ?? 0, ...ARROWS[event.key]), event.shiftKey);
      else if (event.key === "Enter" && marks.active !== null) {
        marks.selected.add(marks.active);
        this.openMenu();
        this.$nextTick(() => this.$refs.menu.querySelector("button[data-action], input").focus());
      } else if (ACTIONS[event.key]) this.send(ACTIONS[event.key]);
      else if (event.key === "Escape") this.close();
      else return;
      event.preventDefault();
    },
  },
};
