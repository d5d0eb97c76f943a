// The mean residual over all runs: a row a run, a column a speed; a cell selects its samples.
import { colour, h, number } from "./dom.js";

export class RunsMap {
  // `chosen(run, box)` is called with the run of a cell and its speeds.
  constructor(place, chosen) {
    this.chosen = chosen; this.cells = []; this.at = null;
    this.canvas = h("canvas", { class: "mine", tabindex: 0, "data-key": "runs-map",
      "aria-label": "Mean residual by run (rows) and speed (columns); arrow keys move over the cells, Enter selects one" });
    this.words = h("figcaption");
    place.append(h("figure", {}, this.canvas, this.words));
    const cell = (event) => [Math.floor((event.offsetY - 2) / this.row), Math.floor((event.offsetX - this.left) / this.col)];
    this.canvas.addEventListener("click", (event) => { if (this.found) this.choose(...cell(event)); });
    this.canvas.addEventListener("mousemove", (event) => { if (this.found) this.tell(...cell(event)); });
    this.canvas.addEventListener("mouseleave", () => { if (this.found) this.words.textContent = this.scale; });
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => { if (this.found) this.draw(); }).observe(place);
  }

  clear() { this.found = null; this.canvas.style.display = "none"; this.words.textContent = "No model yet."; }

  show(found, units, run, noise) {
    Object.assign(this, { found, units, run, noise });
    this.canvas.style.display = "";
    this.draw();
  }

  table() {
    if (!this.found) return null;
    const { runs, edges_m_s: edges, mean_n: means } = this.found, columns = [[], [], [], []];
    means.forEach((row, i) => row.forEach((value, k) => { [runs[i], edges[k], edges[k + 1], value].forEach((v, c) => columns[c].push(v)); }));
    return { names: ["run", "speed from", "speed to", "mean residual"], columns };
  }

  // Cells that hold samples of the selection: pairs of row and column.
  select(cells) { this.cells = cells; if (this.found) this.draw(); }

  choose(row, col) {
    const { runs, edges_m_s: edges } = this.found;
    if (!runs[row]) return;
    if (col < 0 || col >= edges.length - 1) { this.chosen(runs[row], null); return; }
    // The outermost cells hold what is faster still.
    this.chosen(runs[row], [col === 0 ? null : edges[col], col === edges.length - 2 ? null : edges[col + 1], null, null]);
  }

  key(event) {
    const way = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] }[event.key];
    if (!this.found) return;
    if (event.key === "Enter" && this.at) { this.choose(...this.at); return; }
    if (!way) return;
    event.preventDefault();
    const rows = this.found.runs.length, cols = this.found.edges_m_s.length - 1;
    const [row, col] = this.at ?? [0, cols / 2];
    this.at = this.at ? [Math.min(Math.max(row + way[0], 0), rows - 1), Math.min(Math.max(col + way[1], 0), cols - 1)] : [row, col];
    this.tell(...this.at); this.draw();
  }

  draw() {
    const { runs, edges_m_s: edges, mean_n: means } = this.found;
    this.row = Math.max(12, Math.min(24, 460 / runs.length));
    const ratio = devicePixelRatio || 1, wide = this.canvas.clientWidth || 500, name = Math.min(170, wide * 0.3);
    const high = runs.length * this.row + 36;
    this.canvas.width = wide * ratio; this.canvas.height = high * ratio; this.canvas.style.height = `${high}px`;
    const ctx = this.canvas.getContext("2d");
    ctx.scale(ratio, ratio);
    this.left = name; this.wide = wide - name - 6;
    // Columns of one width: finer speeds stay readable.
    this.col = this.wide / (edges.length - 1);
    const most = Math.max(...means.flat().filter((v) => v !== null).map(Math.abs), 3 * this.noise, 1e-300);
    ctx.font = `${Math.min(12, this.row - 1)}px system-ui`;
    const box = (row, col, more = 0) => [name + col * this.col - more, 2 + row * this.row - more, this.col - 1 + 2 * more, this.row - 1 + 2 * more];
    runs.forEach((label, i) => {
      ctx.globalAlpha = 1; ctx.fillStyle = colour("ink"); ctx.textAlign = "right"; ctx.textBaseline = "middle";
      ctx.fillText(`${label === this.run ? "▸ " : ""}${label}`.slice(-24), name - 6, 2 + (i + 0.5) * this.row, name - 8);
      means[i].forEach((value, k) => {
        if (value === null) return;
        ctx.globalAlpha = 1; ctx.fillStyle = colour("panel"); ctx.fillRect(...box(i, k));
        ctx.globalAlpha = Math.min(Math.abs(value) / most, 1);
        ctx.fillStyle = colour(value > 0 ? "beside" : "model"); ctx.fillRect(...box(i, k));
      });
    });
    ctx.globalAlpha = 1; ctx.strokeStyle = colour("selected"); ctx.lineWidth = 2;
    for (const [row, col] of this.cells) ctx.strokeRect(...box(row, col));
    if (this.at) { ctx.strokeStyle = colour("ink"); ctx.strokeRect(...box(...this.at, 1)); }
    ctx.lineWidth = 1; ctx.font = "12px system-ui"; ctx.fillStyle = colour("ink"); ctx.textBaseline = "alphabetic";
    const half = (edges.length - 1) / 2;
    for (const [k, align] of [[0, "left"], [half / 2, "center"], [half, "center"], [1.5 * half, "center"], [2 * half, "right"]]) {
      ctx.textAlign = align; ctx.fillText(number(edges[Math.round(k)], 2), name + k * this.col, high - 20);
    }
    ctx.textAlign = "center"; ctx.fillText(`${this.units.velocity} (${this.units.speed})`, name + this.wide / 2, high - 5);
    this.scale = `Orange: record above the model; blue: below; darkest colour: ${number(most, 2)} ${this.units.force}; white: no samples. Click a cell to select it.`;
    this.words.textContent = this.scale;
  }

  tell(row, col) {
    const value = this.found.mean_n[row]?.[col], { edges_m_s: edges } = this.found;
    this.words.textContent = value === undefined || value === null ? this.scale
      : `${this.found.runs[row]}, ${number(edges[col], 2)} to ${number(edges[col + 1], 2)} ${this.units.speed}: ${number(value)} ${this.units.force}`;
  }
}
