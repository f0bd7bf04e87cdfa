// A table of a measured law, dropped onto the plot or chosen by a button.

// Largest file that is shown [bytes], some thousand points: the browser keeps it with every state of the history.
const MOST = 100_000;

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
    if (file.size > MOST) {
      this.say(`${file.name} has ${Math.ceil(file.size / 1e3)} kB; a table of a measured law may have ${MOST / 1e3} kB.`, true);
      return;
    }
    let text;
    try {
      text = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
    } catch {
      this.say(`${file.name} is not a text file in UTF-8. Drop a CSV file whose first line names its columns, such as load_N,friction_force_N.`, true);
      return;
    }
    this.emit("dropped", { name: file.name, text });
  }
}
