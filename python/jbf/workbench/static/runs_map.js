// The residual over runs and speeds: a row a run, orange above the model, blue below.
import { colour, h, number } from "./dom.js";

export class RunsMap {
  constructor(place, chosen) {
    this.place = place; this.chosen = chosen;
    this.canvas = h("canvas", { class: "mine", "aria-label": "mean of record minus model, a row a run, a column a speed" });
    this.words = h("figcaption");
    place.append(h("figure", {}, this.canvas, this.words));
    this.canvas.addEventListener("click", (event) => {
      if (!this.found) return;
      const row = Math.floor((event.offsetY - 2) / this.row);
      if (this.found.runs[row]) chosen(this.found.runs[row]);
    });
    this.canvas.addEventListener("mousemove", (event) => this.tell(event));
  }

  clear() { this.found = null; this.canvas.height = 0; this.words.textContent = "No model yet."; }

  show(found, units, run, noise) {
    this.found = found; this.units = units;
    const { runs, edges_m_s: edges, mean_n: means } = found;
    this.row = Math.max(10, Math.min(24, 280 / runs.length));
    const ratio = devicePixelRatio || 1, wide = this.canvas.clientWidth || 500, name = Math.min(150, wide * 0.3);
    const high = runs.length * this.row + 34;
    this.canvas.width = wide * ratio; this.canvas.height = high * ratio; this.canvas.style.height = `${high}px`;
    const ctx = this.canvas.getContext("2d");
    ctx.scale(ratio, ratio);
    this.left = name; this.wide = wide - name - 6;
    // Columns of one width: finer speeds stay readable.
    this.col = this.wide / (edges.length - 1);
    const most = Math.max(...means.flat().filter((v) => v !== null).map(Math.abs), 3 * noise, 1e-300);
    ctx.font = "12px system-ui";
    runs.forEach((label, i) => {
      ctx.globalAlpha = 1; ctx.fillStyle = colour("ink"); ctx.textAlign = "right"; ctx.textBaseline = "middle";
      ctx.fillText(`${label === run ? "▸ " : ""}${label}`.slice(-22), name - 6, 2 + (i + 0.5) * this.row, name - 8);
      means[i].forEach((value, k) => {
        if (value === null) return;
        ctx.globalAlpha = Math.min(Math.abs(value) / most, 1);
        ctx.fillStyle = colour(value > 0 ? "beside" : "model");
        ctx.fillRect(name + k * this.col, 2 + i * this.row, this.col, this.row - 1);
      });
    });
    ctx.globalAlpha = 1; ctx.strokeStyle = colour("line"); ctx.strokeRect(name, 2, this.wide, runs.length * this.row);
    ctx.fillStyle = colour("ink"); ctx.textBaseline = "alphabetic";
    const half = (edges.length - 1) / 2;
    for (const [k, align] of [[0, "left"], [half / 2, "center"], [half, "center"], [1.5 * half, "center"], [2 * half, "right"]]) {
      ctx.textAlign = align;
      ctx.fillText(number(edges[Math.round(k)], 2), name + k * this.col, high - 18);
    }
    ctx.textAlign = "center";
    ctx.fillText(`${units.velocity} (${units.speed})`, name + this.wide / 2, high - 4);
    this.scale = `Full colour: ${number(most, 2)} ${units.force}; orange, the record is above the model, blue, below. A click shows the run.`;
    this.words.textContent = this.scale;
  }

  tell(event) {
    if (!this.found) return;
    const row = Math.floor((event.offsetY - 2) / this.row), col = Math.floor((event.offsetX - this.left) / this.col);
    const value = this.found.mean_n[row]?.[col];
    this.words.textContent = value === undefined || value === null ? this.scale
      : `${this.found.runs[row]}, ${number(this.found.edges_m_s[col], 2)} to ${number(this.found.edges_m_s[col + 1], 2)} ${this.units.speed}: ${number(value)} ${this.units.force}`;
  }
}
