// The law: curves from the server, points that are dragged here.
const [WIDTH, HEIGHT, LEFT, BOTTOM] = [640, 400, 56, 44];

export default {
  template: `
    <svg ref="svg" :viewBox="'0 0 ${WIDTH} ${HEIGHT}'" :data-answered="answered" role="application" aria-label="Friction law"
         style="width: 100%; touch-action: none" @pointermove="move" @pointerup="release" @pointercancel="release">
      <path v-for="line in lines" :d="path(line)" fill="none" stroke-width="2" :stroke="line.colour"/>
      <circle v-for="handle in handles" :key="handle.id" class="handle" :data-id="handle.id" r="7" tabindex="0" fill="var(--target)"
              :aria-label="handle.label" :cx="px(handle.x)" :cy="py(handle.y)" @pointerdown="grab($event, handle)"/>
      <text x="320" y="394" text-anchor="middle" fill="currentColor">{{ data.x?.label }}</text>
    </svg>`,
  data() {
    return { data: {}, handles: [], answered: 0, held: null, underWay: false, next: null };
  },
  computed: {
    lines() {
      const { wanted, achieved, nearest } = this.data;
      return [[wanted, "var(--target)"], [achieved, "var(--achieved)"], [nearest, "var(--beside)"]]
        .filter(([line]) => line).map(([line, colour]) => ({ ...line, colour }));
    },
    scale() {
      const reach = (name) => Math.max(...this.lines.flatMap((line) => line[name]), ...this.handles.map((each) => each[name]), 1e-12) * 1.1;
      return this.held?.scale ?? { x: reach("x"), y: reach("y") };
    },
  },
  methods: {
    px(x) { return LEFT + (x / this.scale.x) * (WIDTH - LEFT); },
    py(y) { return (HEIGHT - BOTTOM) * (1 - y / this.scale.y); },
    path(line) { return line.x.map((x, i) => `${i ? "L" : "M"}${this.px(x)} ${this.py(line.y[i])}`).join(""); },
    grab(event, handle) {
      this.$refs.svg.setPointerCapture(event.pointerId);
      this.held = { id: handle.id, scale: this.scale };
    },
    move(event) {
      if (!this.held) return;
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.$refs.svg.getScreenCTM().inverse());
      const x = Math.max(0, ((point.x - LEFT) / (WIDTH - LEFT)) * this.scale.x);
      const y = Math.max(0, (1 - point.y / (HEIGHT - BOTTOM)) * this.scale.y);
      const handle = this.handles.find((each) => each.id === this.held.id);
      if (handle.moves !== "y") handle.x = x;
      if (handle.moves !== "x") handle.y = y;
      this.send({ id: handle.id, x: handle.x, y: handle.y, released: false });
    },
    release() {
      const handle = this.held && this.handles.find((each) => each.id === this.held.id);
      this.held = null;
      if (handle) this.send({ id: handle.id, x: handle.x, y: handle.y, released: true });
    },
    send(drag) {  // one request is under way, the newest waits
      if (this.underWay) { this.next = drag; return; }
      this.underWay = true;
      this.$emit("drag", drag);
    },
    show(data) {
      this.data = data;
      if (!this.held) this.handles = data.handles;
      this.$nextTick(() => { this.answered = data.number; });
      this.underWay = false;
      const next = this.next;
      this.next = null;
      if (next) this.send(next);
    },
  },
};
