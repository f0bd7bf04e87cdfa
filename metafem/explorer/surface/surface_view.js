// The surface: map and picture in three dimensions, with a menu for the sites that are selected.
import { ARROWS, Chosen, hear, tell } from "metafem-page/linked.js";
import { Press, told, words } from "metafem-surface/contacts.js";
import { SiteMap } from "metafem-surface/map.js";

// First and largest exaggeration of the heights in 3D.
const EXAGGERATION = { first: 4, most: 20 };

// Milliseconds from the smallest to the largest load; steps of the slider; and steps instead of motion.
const [PLAY, SLIDER, STILL] = [6000, 250, 5];

const HELP = "Arrow keys move between the sites, with Shift they select. Enter opens the menu, p keeps the height, e leaves the site empty, r lets the design choose, Escape ends the selection.";

// Room beside a site that the menu needs [pixels].
const MENU = 270;

export default {
  template: `
    <div :class="['surface-view', 'fill', { old }]" data-answered="0">
      <div class="head"><h2>Surface</h2>
        <div class="choice" role="tablist" aria-label="View of the surface" @keydown.left.prevent="turn($event)" @keydown.right.prevent="turn($event)">
          <button v-for="[name, label] in [['map', 'Map'], ['relief', '3D']]" type="button" role="tab" :aria-selected="tab === name ? 'true' : 'false'" :tabindex="tab === name ? 0 : -1"
                  @click="open(name)">{{ label }}</button>
        </div>
        <label class="small">Colour <select class="text" v-model="what" @change="recolour" aria-label="Colour of the sites">
          <option value="height">height</option><option v-if="radii" value="radius">radius</option><option value="pressure">contact pressure</option><option value="sensitivity">sensitivity</option><option v-if="compared" value="difference">difference from A</option>
        </select> <select class="text" v-model="spread" @change="recolour" aria-label="Spread of the colours"><option value="value">by value</option><option value="quantile">by quantile</option></select></label>
      </div>
      <div class="small line" role="status"><p v-if="message" class="wrong">{{ message }}</p><p v-if="(line || note) && !(message && old)">{{ line }} {{ note }}</p></div>
      <div class="box fill" ref="map" v-show="tab === 'map'" @keydown.esc="close">
        <q-resize-observer debounce="0" @resize="views.map?.resize()"></q-resize-observer>
        <div v-if="tip" class="tip" :style="tip.style"><div v-for="each in tip.lines">{{ each }}</div></div>
        <div v-if="menu" class="menu" role="dialog" :aria-label="menu.title" :style="menu.style" ref="menu">
          <b>{{ menu.title }}</b>
          <button type="button" class="away" aria-label="Close" @click="close">×</button>
          <button v-if="menu.filled" type="button" class="act" data-action="pin" @click="send('pin')">{{ menu.kept ? "Keep this height: " + menu.kept : "Keep these heights" }}</button>
          <button v-if="menu.asked" type="button" class="act" data-action="release" @click="send('release')">{{ menu.filled ? "Let the design choose" : "Fill " + menu.these }}</button>
          <form @submit.prevent="send('pin', typed)"><label>Height <input class="text" v-model="typed" required inputmode="decimal" :placeholder="menu.kept || '150.0 µm'" aria-label="Height in micrometres"></label>
            <button type="submit" class="act" data-action="type">Set</button></form>
          <button v-if="menu.filled" type="button" class="act" data-action="empty" @click="send('empty')">Leave {{ menu.these }} empty</button>
          <label class="small"><input type="checkbox" v-model="adding"> Select more sites</label>
        </div>
      </div>
      <div class="box fill" ref="relief" v-show="tab === 'relief'">
        <q-resize-observer debounce="0" @resize="views.relief?.resize()"></q-resize-observer>
        <p v-if="missing" class="note">{{ missing }}</p>
        <div class="row small" v-else>
          <label>Heights × {{ times }} <input type="range" min="1" :max="most" step="0.5" v-model.number="times" @input="exaggerate" aria-label="Exaggeration of the heights"></label>
          <button type="button" class="act" :disabled="times === 1" @click="times = 1; exaggerate()">True proportions</button>
          <button type="button" class="act" @click="reset">Reset the view</button>
        </div>
      </div>
      <div class="press">
        <button type="button" class="act main" :disabled="!ready" @click="play">{{ playing ? "❚❚ Pause" : "▶ Press it" }}</button>
        <input type="range" min="0" :max="steps" :value="place" :disabled="!ready" aria-label="Load" :aria-valuetext="told" @input="slide($event, true)" @change="slide($event, false)">
        <span title="Load over the area of all contacts, and load">{{ playing && !known ? "The contacts at all loads are being computed …" : told }}</span>
      </div>
      <p class="legend spoken" v-if="tab === 'map' && spoken">{{ spoken }}</p>
      <p class="legend" v-else-if="tab === 'map'"><span><i class="disc"></i> contact, to scale</span> <span>◆ kept height</span> <span><i class="ring"></i> empty site, × kept empty</span></p>
      <p class="legend" v-else-if="!missing"><span><i class="disc coloured"></i> contact</span> <span>Caps are drawn undeformed, cut off at the glass. {{ part }}</span></p>
      <span class="unseen" aria-live="polite">{{ spoken }}</span>
    </div>`,
  data() {
    return {
      tab: "map", what: "height", line: "", message: "", old: false, note: "", tip: null, menu: null,
      typed: "", adding: false, missing: "", times: EXAGGERATION.first, most: EXAGGERATION.most, spoken: "",
      radii: false, compared: false, part: "", spread: "value", ready: false, known: false, playing: false, running: false, steps: SLIDER, place: 0, told: "",
    };
  },
  created() {
    // Not reactive: thousands of numbers.
    this.views = {};
    this.layout = this.surface = this.contacts = this.press = null;
    this.chosen = new Chosen();
    this.closed = new AbortController();
    hear("load", (to) => this.move(to), this.closed.signal);
    hear("sites", (sites) => this.point(sites), this.closed.signal);
  },
  mounted() {
    const map = new SiteMap(this.$refs.map, { hover: (site, event) => this.hover(site, event), pick: (sites, add) => this.pick(sites, add), key: (event) => this.key(event) });
    map.svg.setAttribute("aria-label", `Map of the heights. ${HELP}`);
    map.svg.addEventListener("focus", () => { if (!map.from) this.go(map.active ?? map.next(0, 0)); }); // not by a click
    map.svg.addEventListener("blur", () => tell("sites", []));
    this.views.map = map;
  },
  unmounted() {
    this.playing = false;
    this.closed.abort();
    this.views.relief?.end();
  },
  watch: {
    "$q.dark.isActive"() { this.draw(); },
  },
  methods: {
    show(data) {
      if (data.layout) this.layout = data.layout;
      this.message = data.message;
      this.old = data.old;
      this.number = data.number;
      if (data.height) { // otherwise it is as before
        this.surface = { ...data, empty: new Set(data.empty) };
        this.press = null;
        this.known = false;
        this.chosen = new Chosen();
        tell("entries", null);
        if (this.playing) tell("load", { load: Math.min(this.contacts.load, data.loads[1]), moving: false });
        this.radii = typeof data.radius !== "number";
      }
      if (this.surface) this.surface.difference = data.difference;
      this.compared = Boolean(data.difference);
      if ({ radius: !this.radii, difference: !this.compared }[this.what]) {
        this.what = "height";
        this.recolour();
      }
      this.draw();
    },
    contact(data) {
      this.line = data.problem ?? "";
      this.note = data.note ?? "";
      if (this.chosen.isShownBy(data.load)) this.take(data.problem ? null : data);
    },
    // The contacts at all loads, for the surface that is shown.
    pressed(data) {
      this.press = data.states.length ? new Press(data) : null;
      this.known = true;
      tell("entries", this.press);
      this.playing &&= Boolean(this.press);
      if (this.playing) this.run();
    },
    take(contacts) {
      this.contacts = contacts;
      this.ready = Boolean(contacts);
      this.told = contacts ? told(contacts, this.surface.modulus) : "";
      const [first, last] = this.surface.loads;
      if (contacts) this.place = Math.round((SLIDER * (contacts.load - first)) / (last - first || 1));
      this.draw();
    },
    // Follows the load, which is dragged here or in the law, or played.
    move(to) {
      this.chosen.take(to);
      this.playing = Boolean(to.playing);
      if (this.press) this.take(this.press.at(to.load));
    },
    slide(event, moving) {
      const [first, last] = this.surface.loads;
      tell("load", { load: first + (event.target.value / SLIDER) * (last - first), moving });
    },
    async play() {
      if (this.playing) return tell("load", { load: this.contacts.load, moving: false });
      this.playing = true;
      await this.open("relief");
      if (this.missing) this.tab = "map";
      if (this.press) this.run();
    },
    run() {
      if (this.running) return;
      const [first, last] = this.surface.loads;
      const from = this.contacts.load < last ? this.contacts.load : first;
      const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
      let start = null;
      const frame = (now) => {
        this.running = this.playing;
        if (!this.playing) return;
        start ??= now - (PLAY * (from - first)) / (last - first || 1);
        let part = Math.min(1, (now - start) / PLAY);
        if (still) part = Math.ceil(STILL * part) / STILL;
        tell("load", { load: first + part * (last - first), moving: part < 1, playing: part < 1 });
        requestAnimationFrame(frame);
      };
      this.running = true;
      requestAnimationFrame(frame);
    },
    // Once for each frame, after the law.
    draw() {
      if (this.frame) return;
      this.frame = requestAnimationFrame(() => {
        this.frame = null;
        const { layout, surface, contacts } = this;
        if (layout && surface) {
          const fitting = contacts?.radius?.length === layout.x.length ? contacts : null;
          const look = { what: this.what, spread: this.spread, dark: this.$q.dark.isActive };
          this.views[this.tab]?.show(layout, surface, fitting, look, this.chosen.moving);
          this.part = this.views.relief?.left(layout.x.length) ?? "";
          if (this.menu) Object.assign(this.menu, this.described());
          if (this.tip) this.tip.lines = this.words(this.tip.site);
          if (this.spoken && !this.chosen.moving) this.speak(); // not with each frame of a play
        }
        if (this.number) this.$el.dataset.answered = this.number;
      });
    },
    turn(event) {  // an arrow key on the tab in focus
      const next = event.target.nextElementSibling ?? event.target.previousElementSibling;
      next.focus();
      next.click();
    },
    async open(tab) {
      this.tab = tab;
      this.close();
      if (tab === "relief") await (this.started ??= this.start());
      this.draw();
    },
    async start() {
      try {
        const { Relief } = await import("metafem-surface/relief.js");
        const relief = new Relief(this.$refs.relief, this.times);
        await relief.start();
        this.views.relief = relief;
      } catch (error) {
        console.warn(error);
        this.missing = "This browser has no WebGL, so the surface cannot be drawn in three dimensions. The map shows the same heights.";
      }
    },
    recolour() {
      this.$emit("colour", this.what);
      this.draw();
    },
    reset() { this.views.relief?.reset(); },
    exaggerate() { this.views.relief?.exaggerate(this.times); },
    words(site) { return words(site, this.surface, this.contacts, this.press); },
    hover(site, event) {
      if (this.menu || !this.surface) site = null;
      tell("sites", site === null ? [] : [site]);
      this.tip = null;
      if (site === null) return;
      const box = this.$refs.map.getBoundingClientRect();
      this.spoken = "";
      this.tip = { site, lines: this.words(site), style: this.beside(event.clientX - box.left, event.clientY - box.top) };
    },
    // Marks the sites under the pointer, here or at their tick of the law.
    point(sites) {
      const { map } = this.views;
      if (!this.surface || sites.join() === [...map.pointed].join()) return;
      map.pointed = new Set(sites);
      this.speak();
      map.draw();
    },
    speak() {
      const [first, ...others] = this.views.map.pointed;
      this.spoken = first === undefined ? "" : others.length ? `${others.length + 1} sites come into contact together` : this.words(first).join(", ");
    },
    // Beside a point, on the side where there is room; or in the corner away from it, where the sites around it stay free.
    beside(x, y, away = false) {
      const { clientWidth: width, clientHeight: height } = this.$refs.map;
      if (away) return { [x > width / 2 ? "left" : "right"]: 0, [y > height / 2 ? "top" : "bottom"]: 0 };
      return {
        ...(x > width / 2 ? { right: `${width - x + 14}px` } : { left: `${x + 14}px` }),
        ...(y > height / 2 ? { bottom: `${Math.max(0, height - y - 10)}px` } : { top: `${Math.max(0, y - 10)}px` }),
      };
    },
    pick(sites, add) {
      const { map } = this.views;
      if (!(add || this.adding)) map.selected = new Set();
      const single = sites.length === 1 && map.selected.has(sites[0]);
      sites.forEach((site) => (single ? map.selected.delete(site) : map.selected.add(site)));
      if (sites.length) map.active = sites.at(-1);
      this.tip = null;
      this.spoken = "";
      if (map.selected.size) this.openMenu(); else this.close();
      map.draw();
    },
    openMenu() {
      const { map } = this.views;
      this.typed = "";
      const x = map.view.px(this.layout.x[map.active]);
      const room = Math.max(x, this.$refs.map.clientWidth - x);
      const style = this.beside(x, map.view.py(this.layout.y[map.active]), map.selected.size > 1 || room < MENU);
      this.menu = { style, ...this.described() };
    },
    described() {
      const { surface, views: { map } } = this;
      const sites = [...map.selected];
      const single = sites.length === 1;
      const height = single ? surface.height[sites[0]] : null;
      return {
        title: single ? `Site ${sites[0]}` : `${sites.length} sites`,
        these: single ? "this site" : "these sites",
        filled: sites.some((i) => surface.height[i] !== null && !surface.empty.has(i)),
        asked: sites.some((i) => surface.empty.has(i) || surface.pinned[i] !== undefined),
        kept: height === null ? "" : `${height.toFixed(1)} µm`,
      };
    },
    close() {
      const { map } = this.views;
      const inside = this.$refs.menu?.contains(document.activeElement);
      this.menu = null;
      this.adding = false;
      map.selected = new Set();
      map.draw();
      if (inside) map.svg.focus();
    },
    send(action, height = "") {
      const { map } = this.views;
      const sites = map.selected.size ? [...map.selected] : map.active === null ? [] : [map.active];
      if (sites.length) this.$emit("sites", { action, sites, height });
      this.close();
    },
    go(site, select) {
      const { map } = this.views;
      if (site === null || !this.surface) return;
      if (select) [map.active, site].forEach((each) => map.selected.add(each));
      map.active = site;
      this.tip = null;
      tell("sites", [site]);
      this.speak();
      map.draw();
    },
    key(event) {
      const { map } = this.views;
      const actions = { p: "pin", e: "empty", r: "release" };
      if (event.ctrlKey || event.metaKey || event.altKey || !this.layout) return;
      if (ARROWS[event.key]) this.go(map.next(...ARROWS[event.key]), event.shiftKey);
      else if (event.key === "Enter" && map.active !== null) {
        map.selected.add(map.active);
        this.openMenu();
        this.$nextTick(() => this.$refs.menu.querySelector("button[data-action], input").focus());
      } else if (actions[event.key]) this.send(actions[event.key]);
      else if (event.key === "Escape") this.close();
      else return;
      event.preventDefault();
    },
  },
};
