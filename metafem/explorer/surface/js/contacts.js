// The contacts between the loads at which they are computed, and what is said of them and of a site.
import { valueAt } from "metafem-law/svg.js";

// Radius of the summit at a site [mm]; most surfaces have one for all.
export const radiusOf = (surface, i) => (typeof surface.radius === "number" ? surface.radius : surface.radius[i]);

// The shape of a cap of a kind: distances from the axis and depths below the summit, both over `scale` [mm].
export function shapeOf(surface, kind, radius) {
  const shape = surface.caps[kind] ?? surface.caps[0]; // a draft may have fewer kinds than the mould before it
  return { ...shape, kind, scale: shape.scaled ? radius : 1 };
}

export const capOf = (surface, i) => shapeOf(surface, surface.cap?.[i] ?? 0, radiusOf(surface, i));

// Distance from the axis at which a cap is so far below its summit [mm].
export const widthAt = ({ across, depth, scale }, below) => (below <= 0 ? 0 : scale * (valueAt({ x: depth, y: across }, below / scale) ?? across.at(-1)));

export const digits = (value, count = 3) => Number(value.toPrecision(count)).toLocaleString("en", { maximumSignificantDigits: count, useGrouping: false }).replace("-", "−");

export const range = (values) => values.reduce(([low, high], each) => [Math.min(low, each), Math.max(high, each)], [Infinity, -Infinity]);

const percent = (share) => `${digits(100 * share, 2)} %`;

// What is known of a site; `press` has the load at which it comes into contact.
export function words(i, surface, contacts, press) {
  const height = surface.height[i];
  const kept = surface.pinned[i];
  const lines = [`site ${i}`];
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

// What is known of the hole of a site in the mould, whose open face shows x mirrored, as mould.csv does.
export function hole(i, layout, surface) {
  const depth = surface.height[i] === null ? [] : [`hole ${surface.height[i].toFixed(1)} µm deep`, `radius of the tool ${digits(1e3 * radiusOf(surface, i), 4)} µm`];
  return [`site ${i}`, `x ${digits(-layout.x[i], 5)} mm, y ${digits(layout.y[i], 5)} mm`, ...depth];
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
