// The surface in three dimensions: undeformed caps on the block, cut off at the glass, with the contacts on it.
import { capOf, colouring, range, widthAt } from "metafem/contacts.js";

// Number of caps above which each is so small that fewer segments, and a part of the points of its meridian, are enough.
const MANY = 1500;
// Direction from which the camera looks first, and its field of view [degrees].
const [FROM, FIELD] = [[-0.55, -1, 0.8], 32];
// Speed of the arrow keys.
const TURN = 5;
// Milliseconds between pictures while the surface is changed: one with each step of a drag would delay the law where the
// graphics are computed by the processor.
const PACE = 300;
export class Relief {
  things = [];

  constructor(box) { this.box = box; }

  // Loads three.js from the machine itself; throws where there is no WebGL.
  async start() {
    const { THREE, OrbitControls } = await import("nicegui-scene");
    this.THREE = THREE;
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "Surface in three dimensions. Arrow keys move it, with Shift they turn it.");
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
    this.controls.listenToKeyEvents(canvas);
    this.controls.keyRotateSpeed = TURN;
    this.cut = [new THREE.Plane(new THREE.Vector3(0, 0, 1), 0), new THREE.Plane(new THREE.Vector3(0, 0, -1), 1)]; // base and glass
  }

  end() {
    clearTimeout(this.timer);
    this.controls.dispose();
    this.clear();
    this.renderer.dispose();
  }

  clear() {
    for (const each of this.things) {
      this.scene.remove(each);
      for (const part of [each.geometry, each.material, each]) part.dispose?.();
    }
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
    this.asked ??= requestAnimationFrame(() => {
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
    const { layout, surface, contacts, look: { times, ...look } } = this.newest; // exaggeration of the heights
    const [moved, shapes] = [layout !== this.layout, JSON.stringify(surface.caps)];
    if (moved || shapes !== this.shapes) {
      Object.assign(this, { layout, shapes });
      this.build(surface.caps);
    }
    if (moved) this.reset();
    const { THREE, block, glass, caps, lids, contacts: discs } = this;
    const colours = colouring(surface, contacts, look);
    const separation = (contacts?.separation ?? 1e3 * layout.spacing) / 1e3;
    this.cut[1].constant = glass.position.z = times * separation;
    glass.visible = contacts?.separation > 0;
    const style = getComputedStyle(this.box);
    const of = (name) => style.getPropertyValue(name).trim();
    block.material.color.set(of("--line"));
    discs.material.color.set(of("--target"));
    this.sites = [...layout.x.keys()].filter((site) => surface.height[site] !== null);
    const [at, colour, plain] = [new THREE.Matrix4(), new THREE.Color(), of("--faint")];
    this.sites.forEach((site, k) => {
      const [x, y, height, shape] = [layout.x[site], layout.y[site], surface.height[site] / 1e3, capOf(surface, site)];
      const disc = (mesh, radius) => mesh.setMatrixAt(k, at.makeScale(radius, radius, 1).setPosition(x, y, times * separation));
      colour.set(colours.shown(site) ? colours.scale.css(colours.values[site]) : plain);
      caps.forEach((mesh, kind) => {
        const size = kind === shape.kind ? shape.scale : 0;
        mesh.setMatrixAt(k, at.makeScale(size, size, times * size).setPosition(x, y, times * height));
        mesh.setColorAt(k, colour);
      });
      disc(lids, widthAt(shape, height - separation));
      lids.setColorAt(k, colour);
      disc(discs, contacts?.radius?.[site] ?? 0);
    });
    for (const mesh of [...caps, lids, discs]) {
      mesh.count = this.sites.length;
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    this.render();
  }

  // Meshes for the sites of a layout and the shapes of caps.
  build(shapes) {
    this.clear();
    const { THREE, layout: { x, y, spacing, block } } = this;
    const [[west, east], [south, north]] = [range(x), range(y)];
    const sites = [east - west + spacing, north - south + spacing];
    this.middle = [(west + east) / 2, (south + north) / 2];
    const [width, length, thickness] = block ?? [...sites, 0.5 * spacing];
    this.size = Math.hypot(width, length);
    const [around, step] = x.length > MANY ? [10, 4] : [40, 1];
    const both = { side: THREE.DoubleSide };
    const flat = (factor, units) => ({ ...both, polygonOffset: true, polygonOffsetFactor: factor, polygonOffsetUnits: units });
    const instanced = (geometry, material) => Object.assign(new THREE.InstancedMesh(geometry, material, x.length), { frustumCulled: false });
    this.block = new THREE.Mesh(new THREE.BoxGeometry(width, length, thickness), new THREE.MeshLambertMaterial());
    this.block.position.set(...(block ? [0, 0] : this.middle), -thickness / 2);
    this.caps = shapes.map(({ across, depth }) => {
      const meridian = across.map((each, k) => new THREE.Vector2(each, -depth[k])).filter((_, k) => k % step === 0);
      const cap = new THREE.LatheGeometry(meridian.reverse(), around).rotateX(Math.PI / 2); // from below, so that it faces outwards
      return instanced(cap, new THREE.MeshLambertMaterial({ ...both, clippingPlanes: this.cut }));
    });
    this.lids = instanced(new THREE.CircleGeometry(1, around), new THREE.MeshLambertMaterial(flat(-1, -2)));
    this.contacts = instanced(new THREE.CircleGeometry(1, around), new THREE.MeshBasicMaterial(flat(-3, -8)));
    const pane = { ...both, color: 0x7fb4cc, transparent: true, opacity: 0.22, depthWrite: false };
    this.glass = new THREE.Mesh(new THREE.PlaneGeometry(...sites), new THREE.MeshBasicMaterial(pane));
    this.glass.position.set(...this.middle, 0);
    this.things = [this.block, ...this.caps, this.lids, this.contacts, this.glass];
    this.scene.add(...this.things);
  }

  reset() {
    const { size, camera, controls } = this;
    Object.assign(camera, { near: size / 100, far: 20 * size });
    camera.updateProjectionMatrix();
    controls.target.set(...this.middle, 0);
    const away = (0.53 * size) / Math.tan((FIELD * Math.PI) / 360) / Math.min(1, camera.aspect);
    camera.position.copy(controls.target).addScaledVector(new this.THREE.Vector3(...FROM).normalize(), away);
    controls.update();
    this.render();
  }
}
