// The friction-speed plane: densities on a canvas, and a box that selects, by mouse or by keys.
import { Axes } from "./axes.js";
import { colour, h } from "./dom.js";

function bytes(text) {
  const read = atob(text), found = new Uint8Array(read.length);
  for (let i = 0; i < read.length; i++) found[i] = read.charCodeAt(i);
  return found;
}

function rgb(name) {
  const probe = document.createElement("canvas").getContext("2d");
  probe.fillStyle = colour(name);
  const hex = probe.fillStyle;
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
}

export class Plane {
  constructor(place, { height = 300, brushed }) {
    this.canvas = h("canvas", { class: "mine", height, tabindex: 0, "data-key": "plane",
      "aria-label": "Friction against speed; drag a box to select. By keys: arrows move a box, with Shift they size it, Enter selects, Escape clears" });
    this.height = height; this.brushed = brushed; this.found = null; this.box = null;
    place.append(h("div", { class: "plot" }, this.canvas));
    const at = (event) => {
      const r = this.canvas.getBoundingClientRect();
      return [event.clientX - r.left, event.clientY - r.top];
    };
    this.canvas.addEventListener("pointerdown", (event) => { this.from = at(event); this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.from) return;
      this.box = [...this.from, ...at(event)]; this.draw();
    });
    this.canvas.addEventListener("pointerup", (event) => {
      const to = at(event), from = this.from; this.from = null; this.box = null;
      if (!from || !this.found) return;
      if (Math.abs(to[0] - from[0]) < 4 || Math.abs(to[1] - from[1]) < 4) { brushed(null); return; }
      this.choose([...from, ...to]);
    });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.draw()).observe(place);
  }

  choose([a, b, c, d]) {
    const x = [a, c].map((v) => this.axes.toX(v)).sort((p, q) => p - q);
    const y = [b, d].map((v) => this.axes.toY(v)).sort((p, q) => p - q);
    this.brushed([...x, ...y]);
  }

  key(event) {
    const step = { ArrowLeft: [-10, 0], ArrowRight: [10, 0], ArrowUp: [0, -10], ArrowDown: [0, 10] }[event.key];
    if (event.key === "Enter" && this.box) { this.choose(this.box); this.box = null; return; }
    if (event.key === "Escape") { this.box = null; this.brushed(null); return; }
    if (!step || !this.found) return;
    event.preventDefault();
    const middle = [this.canvas.clientWidth / 2, this.height / 2];
    const box = this.box ?? [middle[0] - 40, middle[1] - 40, middle[0] + 40, middle[1] + 40];
    const first = event.shiftKey ? [0, 0] : step;
    this.box = [box[0] + first[0], box[1] + first[1], box[2] + step[0], box[3] + step[1]];
    this.draw();
  }

  show(found, units, axis) {
    Object.assign(this, { found, units, axis });
    this.layers = [this.layer([[found.measured, "measured"], [found.model, "model"]]), null];
    this.draw();
  }

  // Of the samples that are shown, these are selected.
  select(text) {
    const now = text ? this.layer([[text, "selected"]], 190) : null;
    if (!now && !this.layers?.[1]) return;
    this.layers[1] = now; this.draw();
  }

  // Densities over one another, as a canvas of a pixel each; the fewest are as faint as can be told.
  layer(parts, faintest = Number(colour("faintest"))) {
    const f = this.found.frame, picture = new ImageData(f.columns, f.rows), data = picture.data;
    for (const [text, tint] of parts.filter(([text]) => text)) {
      const [r, g, b] = rgb(tint), level = bytes(text), least = tint === "model" ? Math.max(faintest, 150) : faintest;
      for (let row = 0; row < f.rows; row++) for (let col = 0; col < f.columns; col++) {
        const value = level[row * f.columns + col];
        if (!value) continue;
        const at = 4 * ((f.rows - 1 - row) * f.columns + col), a = Math.max(value, least), share = a / 255;
        data[at] = data[at] * (1 - share) + r * share;
        data[at + 1] = data[at + 1] * (1 - share) + g * share;
        data[at + 2] = data[at + 2] * (1 - share) + b * share;
        data[at + 3] = Math.max(data[at + 3], a);
      }
    }
    const small = document.createElement("canvas");
    small.width = f.columns; small.height = f.rows;
    small.getContext("2d").putImageData(picture, 0, 0);
    return small;
  }

  // Samples that the fit does not use, hollow.
  rings() {
    const { frame: f, unused } = this.found, { ctx } = this.axes;
    ctx.strokeStyle = colour("measured"); ctx.fillStyle = colour("paper"); ctx.lineWidth = 1;
    for (const [column, row] of unused) {
      ctx.beginPath();
      ctx.arc(this.axes.x(f.left + (column + 0.5) / f.columns * (f.right - f.left)), this.axes.y(f.low + (row + 0.5) / f.rows * (f.high - f.low)), 2.2, 0, 7);
      ctx.fill(); ctx.stroke();
    }
  }

  // Pixels with measured samples: place, force and density (0 to 255).
  table() {
    if (!this.found) return null;
    const f = this.found.frame, level = bytes(this.found.measured), columns = [[], [], []];
    level.forEach((value, i) => {
      if (!value) return;
      columns[0].push((f.left + (i % f.columns + 0.5) / f.columns * (f.right - f.left)).toPrecision(6));
      columns[1].push((f.low + (Math.floor(i / f.columns) + 0.5) / f.rows * (f.high - f.low)).toPrecision(6));
      columns[2].push(value);
    });
    return { names: [this.axis, "friction", "density"], columns };
  }

  draw() {
    if (!this.found || !this.canvas.clientWidth) return;
    const f = this.found.frame;
    const across = this.axis === "position" ? `position (${this.units.place})` : `${this.units.velocity} (${this.units.speed})`;
    this.axes = new Axes(this.canvas, this.height, [f.left, f.right, f.low, f.high], [across, `${this.units.friction} (${this.units.force})`]);
    for (const small of this.layers.filter(Boolean)) this.axes.picture(small);
    this.rings();
    if (!this.box) return;
    const [a, b, c, d] = this.box, { ctx } = this.axes;
    ctx.strokeStyle = colour("selected"); ctx.lineWidth = 2;
    ctx.strokeRect(Math.min(a, c), Math.min(b, d), Math.abs(c - a), Math.abs(d - b));
  }
}
