// The surface in three dimensions: undeformed caps on the block, cut off at the glass, with the contacts on it.
import { colouring } from "./colours.js";
import { radiusOf, range } from "./contacts.js";

// Most caps: more would be smaller than a pixel, and hold up a browser without a graphics card for seconds.
export const MOST_CAPS = 20000;

// Direction from which the camera looks first, and its field of view [degrees].
const [FROM, FIELD] = [[-0.55, -1, 0.8], 32];

// Speed of the arrow keys, and step of the wheel that plus and minus are.
const [TURN, WHEEL] = [5, 100];

// Milliseconds without new data after which the picture is drawn, and after which it is drawn in any case.
const [QUIET, LONGEST] = [200, 1000];

// Segments of a cap: fewer for many, of which each is small.
const segments = (count) => (count > 5000 ? [8, 3] : count > 1500 ? [12, 4] : count > 200 ? [20, 6] : [40, 12]);

// The sites that are drawn: all, or those in a square around the middle.
export function nearest({ x, y }) {
  const all = [...x.keys()];
  if (all.length <= MOST_CAPS) return all;
  const [middleX, middleY] = [x, y].map((values) => range(values)).map(([low, high]) => (low + high) / 2);
  const away = all.map((i) => Math.max(Math.abs(x[i] - middleX), Math.abs(y[i] - middleY)));
  return all.sort((i, j) => away[i] - away[j]).slice(0, MOST_CAPS);
}

export class Relief {
  constructor(box, times) { [this.box, this.exaggeration] = [box, times]; }

  // What of so many sites is not drawn, in words.
  left(count) { return count > MOST_CAPS ? `Of ${count.toLocaleString("en")} sites the ${MOST_CAPS.toLocaleString("en")} around the middle are drawn.` : ""; }

  // Loads three.js from the machine itself; throws where there is no WebGL.
  async start() {
    const { THREE, OrbitControls } = await import("nicegui-scene");
    this.THREE = THREE;
    const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    renderer.localClippingEnabled = true;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer = renderer;
    const canvas = renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "Surface in three dimensions. Arrow keys turn it, plus and minus change the distance, Home resets the view.");
    this.box.prepend(canvas);
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    const light = new THREE.DirectionalLight(0xffffff, 2);
    light.position.set(-1, -0.6, 1.6);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8090a0, 1.6), light);
    this.controls = new OrbitControls(this.camera, canvas);
    canvas.style.touchAction = "pan-y"; // a finger that moves up or down scrolls the page
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.addEventListener("change", () => this.render());
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyRotateSpeed = TURN;
    this.resize();
    this.cut = { base: new THREE.Plane(new THREE.Vector3(0, 0, 1), 0), glass: new THREE.Plane(new THREE.Vector3(0, 0, -1), 1) };
  }

  end() {
    clearTimeout(this.timer);
    this.controls.dispose();
    this.clear();
    this.renderer.dispose();
  }

  clear() {
    for (const each of this.things ?? []) {
      this.scene.remove(each);
      each.traverse((part) => {
        part.geometry.dispose();
        part.material.dispose();
      });
      each.dispose?.();
    }
    this.things = [];
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.layout) this.render();
  }

  // Draws once, with the next frame; nothing runs while nothing changes.
  render() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = null;
      this.renderer.render(this.scene, this.camera);
    });
  }

  // Takes the newest data when none have come for a while: a picture with each step of a drag would delay the law where
  // the graphics are computed by the processor. What `moves` is drawn at once.
  show(layout, surface, contacts, look, moves) {
    this.newest = { layout, surface, contacts, look };
    clearTimeout(this.timer);
    if (moves && layout === this.layout) return this.draw();
    const now = performance.now();
    this.since ??= now;
    this.timer = setTimeout(() => {
      this.since = null;
      this.draw();
    }, Math.max(0, Math.min(QUIET, this.since + LONGEST - now)));
  }

  draw() {
    const { layout, surface, contacts, look } = this.newest;
    if (layout !== this.layout) {
      this.layout = layout;
      this.build();
      this.reset();
    }
    const { THREE, exaggeration: e } = this;
    const colours = colouring(surface, contacts, look);
    const separation = (contacts?.separation ?? 1e3 * layout.spacing) / 1e3;
    const top = e * separation;
    this.cut.glass.constant = top;
    this.glass.position.z = top;
    this.glass.visible = contacts?.separation > 0;
    const [at, colour] = [new THREE.Matrix4(), new THREE.Color()];
    const style = getComputedStyle(this.box);
    const plain = style.getPropertyValue("--faint").trim();
    this.block.material.color.set(style.getPropertyValue("--line").trim());
    this.contacts.material.color.set(style.getPropertyValue("--target").trim());
    this.drawn.forEach((site, i) => {
      const height = surface.height[site];
      const [x, y] = [layout.x[site], layout.y[site]];
      const R = radiusOf(surface, site);
      const h = height === null ? 0 : height / 1e3;
      const size = height === null ? 0 : R;
      this.caps.setMatrixAt(i, at.makeScale(size, size, e * size).setPosition(x, y, e * (h - R)));
      const depth = Math.max(0, h - separation);
      const lid = height === null ? 0 : Math.sqrt(Math.max(0, 2 * R * depth - depth * depth));
      this.lids.setMatrixAt(i, at.makeScale(lid, lid, 1).setPosition(x, y, top));
      const radius = contacts?.radius?.[site] ?? 0;
      this.contacts.setMatrixAt(i, at.makeScale(radius, radius, 1).setPosition(x, y, top));
      colour.set(colours.shown(site) ? colours.scale.css(colours.values[site]) : plain);
      this.caps.setColorAt(i, colour);
      this.lids.setColorAt(i, colour);
    });
    for (const each of [this.caps, this.lids, this.contacts]) {
      each.instanceMatrix.needsUpdate = true;
      if (each.instanceColor) each.instanceColor.needsUpdate = true;
    }
    this.render();
  }

  // Meshes for the sites of a layout.
  build() {
    this.clear();
    const { THREE, layout, cut } = this;
    this.drawn = nearest(layout);
    const count = this.drawn.length;
    const [[west, east], [south, north]] = [layout.x, layout.y].map((all) => range(this.drawn.map((i) => all[i])));
    const middle = [(west + east) / 2, (south + north) / 2];
    const sites = [east - west + layout.spacing, north - south + layout.spacing];
    const block = count === layout.x.length ? layout.block : null; // else a piece of it
    const [width, length, thickness] = block ?? [...sites, layout.block?.[2] ?? 0.5 * layout.spacing];
    this.block = new THREE.Mesh(new THREE.BoxGeometry(width, length, thickness), new THREE.MeshLambertMaterial());
    this.block.position.set(...(block ? [0, 0] : middle), -thickness / 2);
    const [around, down] = segments(count);
    const cap = new THREE.SphereGeometry(1, around, down, 0, 2 * Math.PI, 0, Math.PI / 2).rotateX(Math.PI / 2);
    const flat = { polygonOffset: true, polygonOffsetUnits: -2 };
    const instanced = (geometry, material) => {
      const made = new THREE.InstancedMesh(geometry, material, count);
      made.frustumCulled = false;
      return made;
    };
    this.caps = instanced(cap, new THREE.MeshLambertMaterial({ clippingPlanes: [cut.base, cut.glass], side: THREE.DoubleSide }));
    this.lids = instanced(new THREE.CircleGeometry(1, around), new THREE.MeshLambertMaterial({ ...flat, polygonOffsetFactor: -1 }));
    this.contacts = instanced(new THREE.CircleGeometry(1, around), new THREE.MeshBasicMaterial({ ...flat, polygonOffsetFactor: -3, polygonOffsetUnits: -8 }));
    this.glass = new THREE.Mesh(
      new THREE.PlaneGeometry(...sites),
      new THREE.MeshBasicMaterial({ color: 0x7fb4cc, transparent: true, opacity: 0.22, depthWrite: false, side: THREE.DoubleSide }),
    );
    this.glass.add(new THREE.LineSegments(new THREE.EdgesGeometry(this.glass.geometry), new THREE.LineBasicMaterial({ color: 0x4f8fae })));
    this.glass.position.set(...middle, 0);
    this.things = [this.block, this.caps, this.lids, this.contacts, this.glass];
    this.scene.add(...this.things);
    this.size = Math.hypot(...sites);
    this.middle = middle;
  }

  reset() {
    const { size, camera, controls } = this;
    const from = new this.THREE.Vector3(...FROM).normalize();
    camera.near = size / 100;
    camera.far = 20 * size;
    camera.updateProjectionMatrix();
    controls.target.set(...this.middle, 0);
    const room = Math.min(1, camera.aspect);
    camera.position.copy(controls.target).addScaledVector(from, (0.46 * size) / Math.tan((FIELD * Math.PI) / 360) / room);
    controls.update();
    this.render();
  }

  exaggerate(times) {
    this.exaggeration = times;
    if (this.layout) this.draw();
  }

  // Arrow keys turn the picture, as in OrbitControls with Shift; plus and minus are its wheel.
  key(event) {
    const canvas = this.renderer.domElement;
    const nearer = { "+": -1, "-": 1 }[event.key];
    if (event.key === "Home") this.reset();
    else if (nearer) canvas.dispatchEvent(new WheelEvent("wheel", { deltaY: WHEEL * nearer, cancelable: true }));
    else if (event.key.startsWith("Arrow") && !event.shiftKey) canvas.dispatchEvent(new KeyboardEvent("keydown", { key: event.key, code: event.code, shiftKey: true, cancelable: true }));
    else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }
}
