// The legend: what is drawn, in words.

// Returns [class of the key, words, further words] of all that an answer shows.
export function entries(data) {
  const found = [];
  const add = (shown, kind, words, more = "") => { if (shown) found.push([kind, words, more]); };
  add(data.wanted || data.handles.length, data.marked ? "point" : "wanted", `target law${data.crowd && ` (${data.crowd})`}`,
    data.crowd && "Change them in the specification or its table, or choose another kind of target law.");
  add(data.achieved, data.refusal ? "achieved old" : "achieved", data.refusal ? "last law that was found" : `achieved law (${data.model})`);
  add(data.pinned, "pinned", "A");
  add(data.nearest, "nearest", "nearest law that can be designed");
  add(data.band, "band", data.reach, "What the surfaces within the limits can have at one load. A law inside is refused where no single surface meets all of its loads.");
  // the errors of the part are told where the pointer rests
  add(data.tolerance, "tolerance", data.tolerance?.name.split(",")[0], data.tolerance?.name);
  (data.others ?? []).forEach((each, i) => add(true, `other other-${i}`, each.name));
  (data.pending ?? []).forEach((name) => add(true, "pending", `${name}: being computed …`));
  add(data.measured, "measured", data.measured?.name);
  return found;
}

export function drawLegend(list, data, emit) {
  const found = entries(data);
  const text = JSON.stringify(found);
  if (list.dataset.text === text) return; // most answers change nothing here
  list.dataset.text = text;
  list.replaceChildren(...found.map(([kind, words, more]) => {
    const item = document.createElement("li");
    const key = document.createElement("span");
    key.className = `key ${kind}`;
    if (more) item.title = more;
    item.append(key, words);
    const act = (words, name, event) => item.append(button(words, () => emit(name, event)));
    if (kind === "achieved") act("Pin as A", "pin", { on: true });
    if (kind === "pinned") act("Unpin", "pin", { on: false });
    if (kind === "measured") {
      act("Use as target", "measured", { action: "use" });
      act("Remove", "measured", { action: "remove" });
    }
    return item;
  }));
}

function button(words, pressed) {
  const made = Object.assign(document.createElement("button"), { type: "button", textContent: words });
  made.addEventListener("click", pressed);
  return made;
}
