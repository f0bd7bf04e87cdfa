// What is shown at the sites: the values of a colouring with their scale, and the words for a site.
import { scaleOf } from "./colours.js";

const NAMES = {
  height: ["height", "µm"],
  radius: ["radius of curvature", "µm"],
  pressure: ["mean contact pressure", "MPa"],
  difference: ["height, B − A", "µm"],
  sensitivity: ["change of friction per height", "%/µm"],
};

export function colouring(what, surface, contacts, dark) {
  const [name, unit] = NAMES[what];
  if (what === "height") {
    return { name, unit, values: surface.height, scale: scaleOf(...surface.limits), shown: (i) => surface.height[i] !== null };
  }
  if (what === "radius") {
    const values = surface.height.map((height, i) => (height === null ? null : 1e3 * radiusOf(surface, i)));
    const filled = values.filter((value) => value !== null);
    const most = filled.reduce((high, each) => Math.max(high, each), 0);
    return { name, unit, values, scale: scaleOf(0, most), shown: (i) => values[i] !== null };
  }
  const values = contacts?.[what];
  if (!values) return { name, unit, values: [], scale: null, shown: () => false };
  const shown = (i) => values[i] !== null && (what === "difference" || contacts.radius[i] > 0);
  const inContact = values.filter((_, i) => shown(i));
  let [low, high] = [0, 0];
  for (const value of inContact) [low, high] = [Math.min(low, value), Math.max(high, value)];
  const signed = low < 0;
  const most = Math.max(high, -low);
  return { name, unit, values, scale: scaleOf(signed ? -most : 0, most, { signed, dark }), shown };
}

// Radius of the summit at a site [mm]; most surfaces have one for all.
export const radiusOf = (surface, i) => (typeof surface.radius === "number" ? surface.radius : surface.radius[i]);

export const digits = (value, count = 3) => Number(value.toPrecision(count)).toLocaleString("en", { maximumSignificantDigits: count, useGrouping: false }).replace("-", "−");

export function words(i, surface, contacts) {
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
  const change = contacts?.difference?.[i];
  if (change !== undefined && change !== null) lines.push(`B − A: ${change > 0 ? "+" : ""}${digits(change)} µm`);
  const radius = contacts?.radius?.[i];
  if (radius > 0) {
    lines.push(`contact radius ${digits(1e3 * radius)} µm`);
    lines.push(`load ${digits(contacts.force[i])} mN`, `mean pressure ${digits(contacts.pressure[i])} MPa`);
  } else if (radius === 0) lines.push("not in contact");
  const sensitivity = contacts?.sensitivity?.[i];
  if (sensitivity !== undefined && sensitivity !== null) lines.push(`sensitivity ${sensitivity > 0 ? "+" : ""}${digits(sensitivity)} % of friction per µm`);
  return lines;
}
