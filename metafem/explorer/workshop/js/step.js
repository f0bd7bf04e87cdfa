// The next number of a text: "120 um" becomes "130 um". The step is a unit of the second digit, or one for whole numbers.
const NUMBER = /(?<![\w.^])[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?/gi;

export function stepped(text, caret, steps, whole) {
  const found = [...text.matchAll(NUMBER)];
  const at = found.findLast((each) => each.index <= caret) ?? found[0];
  if (!at) return null;
  const value = Number(at[0]);
  // From 100 a step down is one of 99.
  const size = Math.abs(value) * (steps * value < 0 ? 1 - 1e-9 : 1);
  const exponent = whole || size === 0 ? 0 : Math.floor(Math.log10(size) + 1e-12) - 1;
  const digits = Math.max((at[0].split("e")[0].split(".")[1] ?? "").length, -exponent, 0);
  const next = Math.max(0, value + steps * 10 ** exponent).toFixed(Math.min(digits, 20));
  return { text: text.slice(0, at.index) + next + text.slice(at.index + at[0].length), caret: at.index + next.length };
}
