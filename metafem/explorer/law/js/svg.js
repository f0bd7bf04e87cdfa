// Elements of a drawing, made by hand: a few attributes change for each answer.
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
  const top = 10 * view.y;
  const forth = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(Math.min(top, band.high[i] ?? top)))}`);
  const back = band.x.map((x, i) => `${at(view.px(x))} ${at(view.py(band.low[i] ?? 0))}`).reverse();
  return `M${forth.join("L")}L${back.join("L")}Z`;
}
