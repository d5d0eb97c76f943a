// Friction over the speed: means of record and model each way, the law alone, the regimes; a drag selects speeds.
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
    this.words.textContent = node ? "Without inertia, weight and offset. Dots: measured, with standard deviation; line: model; dotted: base law at steady speed." : "No model yet.";
    this.draw();
  }

  table() {
    const ways = this.node?.stribeck?.ways ?? [], all = (name) => ways.flatMap((way) => way[name]);
    return { names: ["speed", "measured", "standard deviation", "model"], columns: [all("speed_m_s"), all("measured_n"), all("scatter_n"), all("modelled_n")] };
  }

  select(speeds) { this.speeds = speeds; this.draw(); }

  draw() {
    if (!this.node?.stribeck || !this.canvas.clientWidth) return;
    const { ways, regimes_m_s: ends, steady } = this.node.stribeck;
    const xs = ways.flatMap((w) => w.speed_m_s), ys = ways.flatMap((w) => [...w.measured_n.map((v, i) => v + w.scatter_n[i]), ...w.measured_n.map((v, i) => v - w.scatter_n[i]), ...w.modelled_n]);
    this.axes = new Axes(this.canvas, this.height, Axes.around(xs, ys), [`${this.units.velocity} (${this.units.speed})`, `${this.units.friction} (${this.units.force})`]);
    const { ctx } = this.axes, x = (v) => this.axes.x(v), y = (v) => this.axes.y(v);
    if (this.speeds) this.axes.band(x(this.speeds[0]), x(this.speeds[1]), "selected");
    if (this.drag) this.axes.band(...this.drag, "selected");
    ctx.save(); this.axes.clip();
    for (const way of ways) {
      ctx.strokeStyle = ctx.fillStyle = colour("measured"); ctx.lineWidth = 1;
      way.speed_m_s.forEach((v, i) => {
        ctx.beginPath(); ctx.moveTo(x(v), y(way.measured_n[i] - way.scatter_n[i])); ctx.lineTo(x(v), y(way.measured_n[i] + way.scatter_n[i])); ctx.stroke();
        ctx.beginPath(); ctx.arc(x(v), y(way.measured_n[i]), 3.2, 0, 7); ctx.fill();
      });
      this.axes.path(way.speed_m_s, way.modelled_n, "model", 2);
    }
    if (steady) for (const way of ways) this.axes.path(steady.velocity_m_s.map((v) => way.way * v), steady.friction_n.map((f) => way.way * f), "ink", 1.3, [2, 3]);
    ctx.setLineDash([3, 4]); ctx.lineWidth = 1; ctx.strokeStyle = ctx.fillStyle = colour("ink"); ctx.textAlign = "left";
    for (const [speed, name] of ends) for (const way of [1, -1]) {
      this.axes.upright(way * speed);
      if (way > 0) ctx.fillText(name, x(speed) + 3, y(this.axes.box[2]) - 5);
    }
    ctx.restore();
  }
}
