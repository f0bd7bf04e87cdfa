// A table of a measured law, dropped onto the plot or chosen by a button. This module is loaded when there is one.

// Largest table that is shown [characters] and its most rows, which a plot can tell apart: the browser keeps it with every
// state of the history. Of a larger one every n-th row is shown.
const [MOST, MOST_ROWS] = [100_000, 2000];

// Largest file that is read [bytes].
const LARGEST = 50_000_000;

// Returns a table with every n-th of its rows, and n.
function thinned(text) {
  const [head = "", ...rows] = text.split(/\r?\n/).filter((line) => line.trim() && !line.startsWith("#"));
  const n = Math.max(1, Math.ceil(rows.length / MOST_ROWS), Math.ceil((1.1 * text.length) / MOST));
  if (text.length <= MOST && rows.length <= MOST_ROWS) return { text, n: 1, count: rows.length };
  return { text: [head, ...rows.filter((_, i) => i % n === 0)].join("\n"), n, count: rows.length };
}

// Returns the name and the text of a table, and what is left out of it, or what is wrong.
export async function measured(files) {
  if (files.length !== 1) return { wrong: "Drop one file: a table with columns such as load_N,friction_force_N." };
  const [file] = files;
  if (file.size > LARGEST) {
    return { wrong: `${file.name} has ${Math.ceil(file.size / 1e6)} MB; a table of a measured law may have ${LARGEST / 1e6} MB.` };
  }
  let all;
  try {
    all = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
  } catch {
    return { wrong: `${file.name} is not a text file in UTF-8. Drop a CSV file whose first line names its columns, such as load_N,friction_force_N.` };
  }
  const { text, n, count } = thinned(all);
  if (text.length > MOST) {
    return { wrong: `${file.name} has too few lines for its size: a table of more than ${MOST / 1e3} kB is thinned by its rows.` };
  }
  const left = n > 1 ? `Of its ${count.toLocaleString("en")} rows one in ${n} is taken.` : "";
  return { name: file.name, text, left };
}
