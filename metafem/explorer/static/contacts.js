// The contacts between the loads at which they are computed, and what is said of them and of a site.
import { digits, valueAt } from "./plot.js";

// Radius of the summit at a site [mm]; most surfaces have one for all.
export const radiusOf = (surface, i) => (typeof surface.radius === "number" ? surface.radius : surface.radius[i]);

// The cap of a site: its kind, and distances from the axis and depths below the summit, both over `scale` [mm].
export function capOf(surface, i) {
  const kind = surface.cap?.[i] ?? 0;
  return { ...surface.caps[kind], kind, scale: surface.caps[kind].scaled ? radiusOf(surface, i) : 1 };
}

// Distance from the axis at which a cap is so far below its summit [mm].
export const widthAt = ({ across, depth, scale }, below) => (below <= 0 ? 0 : scale * (valueAt({ x: depth, y: across }, below / scale) ?? across.at(-1)));

export const range = (values) => values.reduce(([low, high], each) => [Math.min(low, each), Math.max(high, each)], [Infinity, -Infinity]);

const percent = (share) => `${digits(100 * share, 2)} %`;

// What is known of a site; `press` has the load at which it comes into contact.
export function words(i, surface, contacts, press) {
  const height = surface.height[i];
  const kept = surface.pinned[i];
  const lines = [`site ${i + 1}`];
  if (height === null) {
    lines.push(surface.empty.has(i) ? "left empty" : "left empty by the design");
    return lines;
  }
  lines.push(`height ${height.toFixed(1)} µm${kept === undefined ? "" : ", kept"}`);
  if (typeof surface.radius !== "number") lines.push(`radius of curvature ${digits(1e3 * surface.radius[i], 4)} µm`);
  if (surface.empty.has(i)) lines.push("to be left empty");
  const radius = contacts?.radius?.[i];
  if (radius > 0) {
    lines.push(`contact radius ${digits(1e3 * radius)} µm`);
    lines.push(`load ${digits(contacts.force[i])} mN, ${percent(contacts.force[i] / (1e3 * surface.modulus * contacts.load))} of all`);
    lines.push(`${percent((Math.PI * radius ** 2) / areaOf(contacts))} of the contact area`, `mean pressure ${digits(contacts.pressure[i])} MPa`);
  } else if (radius === 0) lines.push("not in contact");
  if (press) lines.push(press.entry[i] === null ? "not in contact at any load of the law" : `comes into contact at ${press.exact ? "" : "about "}${digits(surface.modulus * press.entry[i])} N`);
  const sensitivity = contacts?.sensitivity?.[i];
  if (sensitivity !== undefined && sensitivity !== null) lines.push(`sensitivity ${sensitivity > 0 ? "+" : ""}${digits(sensitivity)} % of friction per µm`);
  return lines;
}

export class Press {
  constructor({ states, entry, exact }) { Object.assign(this, { states, entry, exact }); }

  // Contacts at a rescaled load, linear in the load between two states. A site that comes into contact between them has
  // no contact up to its entry load.
  at(load) {
    const { states, entry } = this;
    const above = states.findIndex((each) => each.load >= load);
    const [from, to] = above < 0 ? [states.at(-1), states.at(-1)] : [states[Math.max(0, above - 1)], states[above]];
    const share = (start) => Math.max(0, Math.min(1, (load - start) / (to.load - start || 1)));
    const all = share(from.load);
    const between = (name) => to[name].map((end, i) => {
      if (!end) return end;
      const start = from[name][i];
      return start === 0 ? end * share(Math.max(from.load, Math.min(entry[i] ?? from.load, to.load))) : start + all * (end - start);
    });
    const [area, force] = [between("area"), between("force")];
    return {
      load,
      separation: from.separation + all * (to.separation - from.separation),
      radius: area.map((each) => (each === null ? null : Math.sqrt(each / Math.PI))),
      pressure: area.map((each, i) => (each ? force[i] / (1e3 * each) : each)),
      force,
    };
  }
}

function areaOf({ radius }) { return radius.reduce((sum, each) => sum + Math.PI * (each ?? 0) ** 2, 0); }

// Number of contacts, mean pressure over them, and load.
export function told(contacts, modulus) {
  const filled = contacts.radius.filter((each) => each !== null);
  const closed = filled.filter((each) => each > 0).length;
  const newtons = modulus * contacts.load;
  const area = areaOf(contacts);
  const pressure = area ? ` · mean pressure ${digits(newtons / area)} MPa` : "";
  const empty = contacts.radius.length - filled.length;
  return `${closed.toLocaleString("en")} of ${filled.length.toLocaleString("en")} in contact${pressure} · ${digits(newtons)} N${empty ? ` · ${empty.toLocaleString("en")} empty` : ""}`;
}

// What is shown at the sites by colours: its name and unit.
const NAMES = {
  height: ["height", "µm"],
  radius: ["radius of curvature", "µm"],
  pressure: ["mean contact pressure", "MPa"],
  sensitivity: ["change of friction per height", "%/µm"],
};

// The values at the sites, which of them are shown, and their scale.
export function colouring(surface, contacts, { what, dark }) {
  const [name, unit] = NAMES[what];
  const filled = (i) => surface.height[i] !== null;
  const own = { height: surface.height, radius: surface.height.map((_, i) => (filled(i) ? 1e3 * radiusOf(surface, i) : null)) };
  const values = own[what] ?? contacts?.[what];
  if (!values) return { name, unit, values: [], scale: null, shown: () => false };
  const shown = own[what] ? (i) => values[i] !== null : (i) => values[i] !== null && contacts.radius[i] > 0;
  const present = values.filter((_, i) => shown(i));
  const [low, high] = range([0, ...present]);
  const signed = low < 0 && what !== "height";
  const most = Math.max(high, -low);
  const scale = what === "height" ? surface.limits : [signed ? -most : 0, most];
  return { name, unit, values, shown, scale: scaleOf(...scale, signed, dark) };
}

// Scales of colour whose lightness rises in equal steps, in the colour space Oklab; along blue and yellow, and blue and
// orange, they are told apart by people who do not tell red from green. The ones of two signs are for a dark and a light page.
const RISING = ["1b2874", "1d477b", "2a6281", "417c84", "5e9484", "81ac81", "a7c27a", "d2d76e", "ffea58"];
const SIGNED = {
  true: ["88c0ff", "7194c4", "596a81", "424242", "806150", "c1815c", "ffa164"],
  false: ["3d72b8", "759aca", "aec1da", "e8e8e8", "d9b7a4", "c68661", "b05305"],
};

// A scale of colours over a range.
function scaleOf(low, high, signed, dark) {
  const stops = (signed ? SIGNED[dark] : RISING).map((each) => each.match(/../g).map((part) => parseInt(part, 16)));
  const css = (value) => {
    const place = (stops.length - 1) * Math.min(1, Math.max(0, (value - low) / (high - low || 1)));
    const [from, to] = [stops[Math.floor(place)], stops[Math.ceil(place)]];
    return `rgb(${from.map((part, k) => Math.round(part + (place % 1) * (to[k] - part)))})`;
  };
  return { low, high, css, gradient: `linear-gradient(90deg, ${stops.map((each) => `rgb(${each})`)})` };
}
