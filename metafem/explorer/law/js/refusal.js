// The reason of a refusal, in the dock below the plot, over the legend; it can be put away.

export class Refusal {
  away = ""; // the reason that was put away

  constructor(box, paint) {
    this.box = box;
    this.reason = box.querySelector("span");
    box.querySelector(".law-away").addEventListener("click", () => {
      this.away = this.away ? "" : this.reason.textContent;
      paint();
    });
  }

  // Draws the reason; returns whether there is one.
  draw(data, held) {
    const { box, reason } = this;
    box.hidden = data.refusal === "";
    if (reason.textContent !== data.refusal) reason.textContent = data.refusal;
    if (this.away !== data.refusal || held) this.away = ""; // another reason has not been read
    box.classList.toggle("away", this.away !== "");
    const button = box.querySelector(".law-away");
    button.hidden = held;
    button.textContent = this.away ? "Why refused?" : "✕";
    button.ariaLabel = this.away ? "Show the reason of the refusal" : "Put the reason away";
    box.querySelector(".law-use").hidden = data.nearest === null || held;
    box.querySelector(".law-nearest").hidden = data.nearest === null;
    return !box.hidden;
  }
}
