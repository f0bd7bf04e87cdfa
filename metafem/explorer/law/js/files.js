// A table of a measured law, dropped onto the plot or chosen by a button.

// Largest table that is shown [characters] and its most rows, which a plot can tell apart: the browser keeps it with every
// state of the history. Of a larger one every n-th row is shown.
const [MOST, MOST_ROWS] = [100_000, 2000];

// Largest file that is read [bytes].
const LARGEST = 50_000_000;

// Returns a table with every n-th of its rows, and n.
export function thinned(text) {
  const lines = text.split(/\r?\n/).filter((line) => line.trim());
  const head = lines.findIndex((line) => !line.startsWith("#"));
  const rows = lines.slice(head + 1).filter((line) => !line.startsWith("#"));
  const n = Math.max(1, Math.ceil(rows.length / MOST_ROWS), Math.ceil((1.1 * text.length) / MOST));
  if (text.length <= MOST && rows.length <= MOST_ROWS) return { text, n: 1, count: rows.length };
  return { text: [lines[head] ?? "", ...rows.filter((_, i) => i % n === 0)].join("\n"), n, count: rows.length };
}

export class Files {
  constructor(root, emit, say) {
    this.emit = emit;
    this.say = say;
    this.input = Object.assign(document.createElement("input"), { type: "file", accept: ".csv,.tsv,.txt,text/csv", hidden: true });
    this.input.addEventListener("change", () => {
      if (this.input.files.length) this.read([...this.input.files]);
      this.input.value = ""; // the same file can be chosen again
    });
    root.append(this.input);
    const shown = (event) => event.dataTransfer?.types.includes("Files");
    root.addEventListener("dragover", (event) => {
      if (!shown(event)) return;
      event.preventDefault();
      root.classList.add("dropping");
    });
    root.addEventListener("dragleave", () => root.classList.remove("dropping"));
    root.addEventListener("drop", (event) => {
      root.classList.remove("dropping");
      if (!shown(event)) return;
      event.preventDefault();
      this.read([...event.dataTransfer.files]);
    });
  }

  choose() { this.input.click(); }

  async read(files) {
    if (files.length !== 1) {
      this.say("Drop one file: a table with columns such as load_N,friction_force_N.", true);
      return;
    }
    const [file] = files;
    if (file.size > LARGEST) {
      this.say(`${file.name} has ${Math.ceil(file.size / 1e6)} MB; a table of a measured law may have ${LARGEST / 1e6} MB.`, true);
      return;
    }
    let text;
    try {
      text = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
    } catch {
      this.say(`${file.name} is not a text file in UTF-8. Drop a CSV file whose first line names its columns, such as load_N,friction_force_N.`, true);
      return;
    }
    const { text: shown, n, count } = thinned(text);
    if (shown.length > MOST) {
      this.say(`${file.name} has too few lines for its size: a table of more than ${MOST / 1e3} kB is thinned by its rows.`, true);
      return;
    }
    const left = n > 1 ? `Of its ${count.toLocaleString("en")} rows one in ${n} is taken.` : "";
    this.emit("dropped", { name: file.name, text: shown, left });
  }
}
