// What is shown at the sites: the values of a colouring with their scale, and the words for a site.
import { scaleOf } from "./colours.js";
import { areaOf } from "./press.js";

const NAMES = {
  height: ["height", "µm"],
  radius: ["radius of curvature", "µm"],
  pressure: ["mean contact pressure", "MPa"],
  difference: ["height, B − A", "µm"],
  sensitivity: ["change of friction per height", "%/µm"],
};

// The values at the sites, which of them are shown, and their scale; `spread` is "value" or "quantile".
export function colouring(what, surface, contacts, { dark = false, spread = "value" } = {}) {
  const [name, unit] = NAMES[what];
  const filled = (i) => surface.height[i] !== null;
  const own = { height: surface.height, radius: surface.height.map((_, i) => (filled(i) ? 1e3 * radiusOf(surface, i) : null)), difference: surface.difference };
  const values = own[what] ?? contacts?.[what];
  if (!values) return { name, unit, values: [], scale: null, shown: () => false };
  const shown = own[what] ? (i) => values[i] !== null : (i) => values[i] !== null && contacts.radius[i] > 0;
  const present = values.filter((_, i) => shown(i));
  const [low, high] = present.reduce(([least, most], each) => [Math.min(least, each), Math.max(most, each)], [0, 0]);
  const signed = low < 0 && what !== "height";
  const most = Math.max(high, -low);
  const range = what === "height" ? surface.limits : [signed ? -most : 0, most];
  return { name, unit, values, present, shown, scale: scaleOf(...range, { signed, dark, values: spread === "quantile" && !signed ? present : null }) };
}

// Radius of the summit at a site [mm]; most surfaces have one for all.
export const radiusOf = (surface, i) => (typeof surface.radius === "number" ? surface.radius : surface.radius[i]);

export const digits = (value, count = 3) => Number(value.toPrecision(count)).toLocaleString("en", { maximumSignificantDigits: count, useGrouping: false }).replace("-", "−");

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
  const change = surface.difference?.[i];
  if (change !== undefined && change !== null) lines.push(`B − A: ${change > 0 ? "+" : ""}${digits(change)} µm`);
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
