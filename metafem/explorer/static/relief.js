// The surface in three dimensions: undeformed caps on the block, cut off at the glass, with the contacts on it. Or the mould,
// which is the same turned over: x and z are mirrored, and the caps are holes.
import { capOf, colouring, range, shapeOf, widthAt } from "./contacts.js";

// Most caps: more would be smaller than a pixel, and hold up a browser without a graphics card for seconds.
export const MOST_CAPS = 20000;

// Direction from which the camera looks first, and its field of view [degrees].
const [FROM, FIELD] = [[-0.55, -1, 0.8], 32];

// Speed of the arrow keys, and step of the wheel that plus and minus are.
const [TURN, WHEEL] = [5, 100];

// Milliseconds between pictures while the surface is changed: one with each step of a drag would delay the law where the
// graphics are computed by the processor.
const PACE = 300;

// Segments of a cap, and which part of the points of its meridian: fewer for many caps, of which each is small.
const FINE = [[200, 40, 1], [1500, 20, 2], [5000, 10, 4], [MOST_CAPS, 8, 8]];

// Most alignment asperities of a part.
const ALIGNMENT = 4;

// Radii of the ring around a site that is pointed at, over the least distance between sites.
const RING = [0.36, 0.43];

// The sites that are drawn: all, or those in a square around the middle.
export function nearest({ x, y }) {
  const all = [...x.keys()];
  if (all.length <= MOST_CAPS) return all;
  const [middleX, middleY] = [x, y].map((values) => range(values)).map(([low, high]) => (low + high) / 2);
  const away = all.map((i) => Math.max(Math.abs(x[i] - middleX), Math.abs(y[i] - middleY)));
  return all.sort((i, j) => away[i] - away[j]).slice(0, MOST_CAPS);
}

export class Relief {
  // `marks` has the sites that are pointed at, `on` the function hover(site, event).
  constructor(box, marks, on) { Object.assign(this, { box, marks, on }); }

  // What of so many sites is not drawn, in words.
  left(count) { return count > MOST_CAPS ? `Of ${count.toLocaleString("en")} sites the ${MOST_CAPS.toLocaleString("en")} around the middle are drawn.` : ""; }

  // Loads three.js from the machine itself; throws where there is no WebGL.
  async start() {
    const { THREE, OrbitControls } = await import("nicegui-scene");
    this.THREE = THREE;
    const renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, stencil: true });
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
    this.ray = new THREE.Raycaster();
    canvas.addEventListener("pointermove", (event) => { if (!event.buttons) this.on.hover(this.siteAt(event), event); });
    canvas.addEventListener("click", (event) => this.on.hover(this.siteAt(event), event)); // a finger does not hover
    for (const name of ["pointerdown", "pointerleave"]) canvas.addEventListener(name, () => this.on.hover(null));
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyRotateSpeed = TURN;
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
        part.geometry?.dispose();
        part.material?.dispose();
        part.dispose?.();
      });
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

  // Takes the newest data; what `moves` is drawn at once.
  show(layout, surface, contacts, look, moves) {
    this.newest = { layout, surface, contacts, look };
    if (moves && layout === this.layout) return this.draw();
    this.timer ??= setTimeout(() => {
      this.timer = null;
      this.draw();
    }, PACE);
  }

  draw() {
    const { layout, surface, contacts, look } = this.newest;
    const [moved, shapes] = [layout !== this.layout, JSON.stringify(surface.caps)];
    if (moved || shapes !== this.shapes) {
      Object.assign(this, { layout, shapes });
      this.build(surface.caps);
    }
    if (moved) this.reset();
    const { THREE } = this;
    const { times: e, mould } = look; // exaggeration of the heights
    this.mould = mould;
    const colours = colouring(surface, contacts, mould ? { ...look, what: "height" } : look);
    const separation = (contacts?.separation ?? 1e3 * layout.spacing) / 1e3;
    const top = mould ? 0 : e * separation;
    this.cut.glass.constant = this.glass.position.z = top;
    this.cut.base.constant = mould ? this.camera.far : 0;
    this.glass.visible = !mould && contacts?.separation > 0;
    this.contacts.visible = !mould;
    this.body.rotation.y = mould ? Math.PI : 0;
    const thickness = mould ? surface.mould.thickness : this.thickness;
    this.block.scale.z = thickness;
    this.block.position.z = (mould ? 1 : -1) * thickness / 2;
    this.block.material.stencilWrite = mould; // but for the holes
    this.lids.material = mould ? this.opening : this.lid;
    this.lids.renderOrder = mould ? -1 : 0;
    const style = getComputedStyle(this.box);
    const of = (name) => style.getPropertyValue(name).trim();
    const plain = of("--faint");
    this.block.material.color.set(of("--line"));
    this.contacts.material.color.set(of("--target"));
    this.rings.material.color.set(of("--ink"));
    const drawn = this.drawn.filter((site) => surface.height[site] !== null).map((site) => [site, layout.x[site], layout.y[site], surface.height[site] / 1e3, capOf(surface, site)]);
    if (mould) drawn.push(...surface.mould.alignment.map(({ x, y, height, radius, kind }) => [null, x, y, height / 1e3, shapeOf(surface, kind, radius)]));
    this.sites = drawn.map(([site]) => site);
    const [at, colour] = [new THREE.Matrix4(), new THREE.Color()];
    drawn.forEach(([site, x, y, h, shape], k) => {
      const disc = (mesh, radius) => mesh.setMatrixAt(k, at.makeScale(radius, radius, 1).setPosition(x, y, top));
      colour.set(site !== null && colours.shown(site) ? colours.scale.css(colours.values[site]) : plain);
      this.caps.forEach((mesh, kind) => {
        const size = kind === shape.kind ? shape.scale : 0;
        mesh.setMatrixAt(k, at.makeScale(size, size, e * size).setPosition(x, y, e * h));
        mesh.setColorAt(k, colour);
      });
      disc(this.lids, widthAt(shape, mould ? h : h - separation));
      this.lids.setColorAt(k, colour);
      disc(this.contacts, contacts?.radius?.[site] ?? 0);
    });
    for (const mesh of [...this.caps, this.lids, this.contacts]) {
      mesh.count = drawn.length;
      mesh.boundingSphere = null; // where rays look for the caps
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    this.mark();
  }

  // Rings around the sites that are pointed at.
  mark() {
    if (!this.layout) return;
    const { THREE, layout: { x, y, spacing }, marks: { pointed }, rings } = this;
    const at = new THREE.Matrix4();
    rings.count = 0;
    for (const site of this.drawn) if (pointed.has(site)) rings.setMatrixAt(rings.count++, at.makeScale(spacing, spacing, 1).setPosition(x[site], y[site], 0));
    rings.instanceMatrix.needsUpdate = true;
    this.render();
  }

  // The site whose cap, or whose opening in the mould, is under the pointer; null if there is none.
  siteAt(event) {
    if (!this.sites) return null;
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const place = [(2 * (event.clientX - left)) / width - 1, 1 - (2 * (event.clientY - top)) / height];
    this.ray.setFromCamera(new this.THREE.Vector2(...place), this.camera);
    const seen = ({ point: { z } }) => this.mould || (z >= 0 && z <= this.glass.position.z); // what the planes do not cut off
    const hit = this.ray.intersectObjects(this.mould ? [this.lids] : this.caps).find(seen);
    return this.sites[hit?.instanceId] ?? null;
  }

  // Meshes for the sites of a layout and the shapes of caps.
  build(shapes) {
    this.clear();
    const { THREE, layout, cut } = this;
    this.drawn = nearest(layout);
    const count = this.drawn.length;
    const [[west, east], [south, north]] = [layout.x, layout.y].map((all) => range(this.drawn.map((i) => all[i])));
    const middle = [(west + east) / 2, (south + north) / 2];
    const sites = [east - west + layout.spacing, north - south + layout.spacing];
    const block = count === layout.x.length ? layout.block : null; // else a piece of it
    const [width, length, thickness] = block ?? [...sites, layout.block?.[2] ?? 0.5 * layout.spacing];
    this.thickness = thickness;
    this.block = new THREE.Mesh(new THREE.BoxGeometry(width, length, 1), new THREE.MeshLambertMaterial({ stencilFunc: THREE.NotEqualStencilFunc, stencilRef: 1 }));
    if (!block) this.block.position.set(...middle, 0);
    const [, around, step] = FINE.find(([most]) => count <= most);
    const both = { side: THREE.DoubleSide };
    const flat = { ...both, polygonOffset: true, polygonOffsetUnits: -2 };
    const instanced = (geometry, material) => {
      const made = new THREE.InstancedMesh(geometry, material, count + ALIGNMENT);
      made.frustumCulled = false;
      return made;
    };
    this.caps = shapes.map(({ across, depth }) => {
      const meridian = across.map((each, k) => new THREE.Vector2(each, -depth[k])).filter((_, k) => k % step === 0);
      const cap = new THREE.LatheGeometry(meridian.reverse(), around).rotateX(Math.PI / 2); // from below, so that it faces outwards
      return instanced(cap, new THREE.MeshLambertMaterial({ ...both, clippingPlanes: [cut.base, cut.glass] }));
    });
    const disc = new THREE.CircleGeometry(1, around);
    this.lid = new THREE.MeshLambertMaterial({ ...flat, polygonOffsetFactor: -1 });
    this.opening = new THREE.MeshBasicMaterial({ ...both, colorWrite: false, depthWrite: false, stencilWrite: true, stencilRef: 1, stencilZPass: THREE.ReplaceStencilOp });
    this.lids = instanced(disc, this.lid);
    this.contacts = instanced(disc, new THREE.MeshBasicMaterial({ ...flat, polygonOffsetFactor: -3, polygonOffsetUnits: -8 }));
    this.rings = instanced(new THREE.RingGeometry(...RING, 40), new THREE.MeshBasicMaterial({ ...both, depthTest: false }));
    this.rings.renderOrder = 1;
    this.glass = new THREE.Mesh(
      new THREE.PlaneGeometry(...sites),
      new THREE.MeshBasicMaterial({ ...both, color: 0x7fb4cc, transparent: true, opacity: 0.22, depthWrite: false }),
    );
    this.glass.add(new THREE.LineSegments(new THREE.EdgesGeometry(this.glass.geometry), new THREE.LineBasicMaterial({ color: 0x4f8fae })));
    this.glass.position.set(...middle, 0);
    this.body = new THREE.Group().add(this.block, ...this.caps, this.lids, this.contacts, this.rings);
    this.things = [this.body, this.glass];
    this.scene.add(...this.things);
    this.size = Math.hypot(width, length);
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
    camera.position.copy(controls.target).addScaledVector(from, (0.53 * size) / Math.tan((FIELD * Math.PI) / 360) / room);
    controls.update();
    this.render();
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
