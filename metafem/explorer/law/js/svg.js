// A drawing by hand: numbers at axes, the value of a curve, and elements of which a few attributes change for each answer.

// Round values within a range, at most about so many, with the number of decimals that tells them apart.
export function ticks(low, high, most) {
  const rough = (high - low) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((each) => each * power >= rough) * power;
  const first = Math.ceil(low / step - 1e-9);
  const count = Math.floor(high / step + 1e-9) - first + 1;
  return { values: Array.from({ length: count }, (_, i) => (first + i) * step), decimals: decimalsOf(step * 1.0001) };
}

// The decimals of a value of which so much can be seen.
const decimalsOf = (least) => Math.min(20, Math.max(0, -Math.floor(Math.log10(least))));

// A value for people: with the digits that a pixel resolves.
export const told = (value, pixel) => value.toFixed(decimalsOf(pixel));

// The value of a curve at x, on the line between its points; null outside and in a gap.
export function valueAt(curve, x) {
  if (!curve || !curve.x.length || x < curve.x[0] || x > curve.x.at(-1)) return null;
  const i = Math.max(1, curve.x.findIndex((each) => each >= x));
  const [x0, x1, y0, y1] = [curve.x[i - 1], curve.x[i] ?? curve.x[i - 1], curve.y[i - 1], curve.y[i] ?? curve.y[i - 1]];
  if ([x0, y0, y1].includes(null)) return null; // in a gap
  return x1 === x0 ? y1 : y0 + ((y1 - y0) * (x - x0)) / (x1 - x0);
}

const SVG = "http://www.w3.org/2000/svg";

export function made(name, attributes = {}, parent = null) {
  const node = document.createElementNS(SVG, name);
  set(node, attributes);
  parent?.append(node);
  return node;
}

export function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null) node.removeAttribute(name);
    else if (node.getAttribute(name) !== String(value)) node.setAttribute(name, value);
  }
  return node;
}

export function label(words, x, y, anchor, parent = null) {
  const node = made("text", { x, y, "text-anchor": anchor }, parent);
  node.textContent = words;
  return node;
}

const at = (value) => value.toFixed(1);

// The path of a curve, with gaps where a value is missing.
export function path(view, curve) {
  if (!curve) return "";
  let [text, pen] = ["", "M"];
  curve.x.forEach((x, i) => {
    if (x === null || curve.y[i] === null) { pen = "M"; return; }
    text += `${pen}${at(view.px(x))} ${at(view.py(curve.y[i]))}`;
    pen = "L";
  });
  return text;
}

// The outline of an area between two curves; an infinite upper one is drawn at the top of the picture.
export function area(view, band) {
  if (!band || !band.x.length) return "";
  const top = 10 * view.y.high;
  const forth = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(Math.min(top, band.high[i] ?? top)))}`);
  const back = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(band.low[i] ?? 0))}`).reverse();
  return `M${forth.join("L")}L${back.join("L")}Z`;
}
