// Friction over the speed: means of record and model in each direction, the law alone, the regimes; a drag selects speeds.
import { colour, h, number } from "./dom.js";
import { Axes } from "./axes.js";

export class Stribeck {
  constructor(place, { brushed, height = 250 }) {
    this.canvas = h("canvas", { class: "mine", height, "aria-label": "Mean friction at each speed, record and model" });
    this.words = h("figcaption");
    this.height = height; this.node = null; this.speeds = null; this.drag = null;
    place.append(h("figure", {}, this.canvas, this.words));
    const at = (event) => event.clientX - this.canvas.getBoundingClientRect().left;
    this.canvas.addEventListener("pointerdown", (event) => { this.drag = [at(event), at(event)]; this.canvas.setPointerCapture(event.pointerId); });
    this.canvas.addEventListener("pointermove", (event) => { if (this.drag) { this.drag[1] = at(event); this.draw(); } });
    this.canvas.addEventListener("pointerup", () => {
      const [a, b] = (this.drag ?? [0, 0]).sort((p, q) => p - q); this.drag = null;
      if (!this.axes) return;
      brushed(b - a < 4 ? null : [this.axes.toX(a), this.axes.toX(b), null, null]);
    });
    new ResizeObserver(() => this.draw()).observe(place);
  }

  show(node, units) {
    this.node = node; this.units = units;
    this.canvas.style.display = node ? "" : "none";
    this.words.textContent = node ? "Inertia, weight and offset are subtracted. Dots: measured, with standard deviation; line: model; dotted: base law at steady speed." : "No model yet.";
    this.draw();
  }

  table() {
    const branches = this.node?.stribeck?.directions ?? [], all = (name) => branches.flatMap((branch) => branch[name]);
    return { names: ["speed", "measured", "standard deviation", "model"], columns: [all("speed_m_s"), all("measured_n"), all("scatter_n"), all("modelled_n")] };
  }

  select(speeds) { this.speeds = speeds; this.draw(); }

  draw() {
    if (!this.node?.stribeck || !this.canvas.clientWidth) return;
    const { directions: branches, regimes_m_s: ends, steady } = this.node.stribeck;
    const xs = branches.flatMap((b) => b.speed_m_s);
    const ys = branches.flatMap((b) => [...b.measured_n.map((v, i) => v + b.scatter_n[i]), ...b.measured_n.map((v, i) => v - b.scatter_n[i]), ...b.modelled_n]);
    this.axes = new Axes(this.canvas, this.height, Axes.around(xs, ys), [`${this.units.velocity} (${this.units.speed})`, `${this.units.friction} (${this.units.force})`]);
    const { ctx } = this.axes, x = (v) => this.axes.x(v), y = (v) => this.axes.y(v);
    if (this.speeds) this.axes.band(x(this.speeds[0]), x(this.speeds[1]), "selected");
    if (this.drag) this.axes.band(...this.drag, "selected");
    ctx.save(); this.axes.clip();
    for (const branch of branches) {
      ctx.strokeStyle = ctx.fillStyle = colour("measured"); ctx.lineWidth = 1;
      branch.speed_m_s.forEach((v, i) => {
        ctx.beginPath(); ctx.moveTo(x(v), y(branch.measured_n[i] - branch.scatter_n[i])); ctx.lineTo(x(v), y(branch.measured_n[i] + branch.scatter_n[i])); ctx.stroke();
        ctx.beginPath(); ctx.arc(x(v), y(branch.measured_n[i]), 3.2, 0, 7); ctx.fill();
      });
      this.axes.path(branch.speed_m_s, branch.modelled_n, "model", 2);
    }
    if (steady) for (const { direction } of branches) {
      this.axes.path(steady.velocity_m_s.map((v) => direction * v), steady.friction_n.map((f) => direction * f), "ink", 1.3, [2, 3]);
    }
    ctx.setLineDash([3, 4]); ctx.lineWidth = 1; ctx.strokeStyle = ctx.fillStyle = colour("ink"); ctx.textAlign = "left";
    for (const [speed, name] of ends) for (const direction of [1, -1]) {
      this.axes.upright(direction * speed);
      if (direction > 0) ctx.fillText(name, x(speed) + 3, y(this.axes.box[2]) - 5);
    }
    ctx.restore();
  }
}
