// The choices above the plot: axes, further models, measured points.

function made(name, members = {}, ...children) {
  const node = Object.assign(document.createElement(name), members);
  node.append(...children);
  return node;
}

export class Tools {
  constructor(root, emit, files, say) {
    this.emit = emit;
    this.axes = made("span", { className: "choice law-axes", role: "group", ariaLabel: "Axes" });
    for (const [newtons, words] of [[true, "N"], [false, "mm²"]]) {
      const button = made("button", { type: "button", textContent: words, title: newtons ? "Load P and friction F in newtons" : "Load P/E* and friction F/(σB), rescaled" });
      button.addEventListener("click", () => {
        if (newtons && this.noForces) say(this.noForces, true);
        else emit("axes", { newtons });
      });
      this.axes.append(button);
    }
    this.list = made("div", { className: "law-models" });
    this.models = made("details", { className: "law-beside" }, made("summary", { textContent: "Other models" }), this.list);
    // a choice beside the plot is left by Escape, or by leaving it
    this.models.addEventListener("keydown", (event) => { if (event.key === "Escape") this.close(); });
    this.models.addEventListener("focusout", (event) => {
      if (event.relatedTarget && !this.models.contains(event.relatedTarget)) this.models.open = false;
    });
    this.outside = (event) => { if (!this.models.contains(event.target)) this.models.open = false; };
    document.addEventListener("pointerdown", this.outside);
    const choose = made("button", { type: "button", className: "act law-choose", textContent: "Measured points…", title: "Show a CSV table of a measured law; it can also be dropped onto the plot. Its first line names the columns with their units: load_N,friction_force_N or load_mN,area_mm2, optionally with load_sd_N and friction_force_sd_N." });
    choose.addEventListener("click", () => files.choose());
    root.append(made("h2", { textContent: "Law" }), this.axes, this.models, choose);
    this.block = made("button", { type: "button", className: "act law-block" });
    this.block.addEventListener("click", () => {
      if (this.missing) say(this.missing, true);
      else emit("block", { on: !this.running && !this.shown });
    });
    this.step = made("span", { className: "small quiet law-step" });
  }

  close() {
    this.models.open = false;
    this.models.querySelector("summary").focus();
  }

  draw(data) {
    if (!data) return;
    const text = JSON.stringify({ ...data, block: Boolean(data.block) });
    if (text !== this.text) {
      this.text = text;
      this.drawChoices(data);
    }
    this.drawBlock(data.block);
  }

  drawChoices(data) {
    this.noForces = data.no_forces;
    [...this.axes.children].forEach((button, i) => {
      button.ariaPressed = String(Boolean(data.newtons && !data.no_forces) === (i === 0));
      button.ariaDisabled = String(i === 0 && data.no_forces !== "");
    });
    const focus = this.list.contains(document.activeElement) ? document.activeElement.name : null;
    this.list.replaceChildren(...data.models.map(({ name, on }) => {
      const box = made("input", { type: "checkbox", checked: on, name });
      box.addEventListener("change", () => this.emit("model", { name, on: box.checked }));
      return made("label", {}, box, ` ${name}`);
    }));
    if (data.block) this.list.append(made("div", { className: "row" }, this.block), this.step);
    if (focus) this.list.querySelector(`[name="${focus}"]`)?.focus();
  }

  // The law under the block takes seconds to a minute, in a process that can be stopped.
  drawBlock(block) {
    if (!block) return;
    [this.running, this.shown, this.missing] = [block.running, block.shown, block.missing];
    const words = block.running ? "Stop the block" : block.shown ? "Hide the block" : "Compute the block";
    if (this.block.textContent !== words) this.block.textContent = words;
    this.block.ariaDisabled = String(block.missing !== "");
    if (this.step.textContent !== block.step) this.step.textContent = block.step;
    this.models.querySelector("summary").textContent = block.running ? "Other models (block is computed …)" : "Other models";
  }

  forget() { document.removeEventListener("pointerdown", this.outside); }
}
