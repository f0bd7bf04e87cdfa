// The contacts between the loads at which they are computed, and what is said of them.
import { digits } from "./values.js";

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

export function areaOf({ radius }) { return radius.reduce((sum, each) => sum + Math.PI * (each ?? 0) ** 2, 0); }

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
