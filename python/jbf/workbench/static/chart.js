// Curves over time (or another axis) by uPlot, with stretches marked behind them.
import { colour } from "./dom.js";

const axis = (label, extra = {}) => ({
  label, labelSize: 18, stroke: () => colour("ink"), grid: { stroke: () => colour("line"), width: 1 },
  ticks: { stroke: () => colour("line") }, font: "12px system-ui", labelFont: "12px system-ui", ...extra,
});

// A curve: where `name` finds its numbers, what it is called, its colour by name.
export const curve = (name, label, tint, extra = {}) =>
  ({ name, label, stroke: () => colour(tint), width: 1.2, spanGaps: false, points: { show: false }, ...extra });

// Single samples as hollow points.
export const hollow = (name, label, tint) => curve(name, label, tint, {
  width: 0, paths: () => null, points: { show: true, size: 5, width: 1, stroke: () => colour(tint), fill: () => colour("paper") } });

export class Chart {
  // `place` an element; `curves` as above; `brushed(from, to)` and `zoomed(from, to)` receive what was dragged over.
  constructor(place, { curves, unit, height = 190, brushed, zoomed, mode = () => "zoom", sync, legend = true, across = "time (s)", scales = {} }) {
    Object.assign(this, { place, curves, height, marks: [], selected: [], edges: [], data: null });
    this.settings = { unit, brushed, zoomed, mode, sync, legend, across, scales };
    this.build();
    new ResizeObserver(() => this.plot.setSize({ width: this.width(), height })).observe(place);
  }

  width() { return Math.max(this.place.clientWidth, 240); }

  build() {
    const { unit, brushed, zoomed, mode, sync, legend, across, scales } = this.settings, { height, curves } = this;
    this.plot?.destroy();
    const options = {
      width: this.width(), height,
      scales: { x: { time: false, ...scales.x }, y: { ...scales.y } },
      legend: { show: legend, live: true },
      cursor: {
        sync: sync ? { key: sync } : undefined,
        drag: { x: true, y: false, setScale: false },
        bind: { dblclick: () => () => { if (zoomed) zoomed(null, null); } },
      },
      axes: [axis(across, { size: 32, labelSize: 16, labelGap: 0 }), axis(unit, { size: (u, values) => Math.max(54, 18 + 7 * Math.max(0, ...(values ?? []).map((v) => v.length))), labelGap: 2, space: height < 150 ? 14 : 30 })],
      series: [{ label: across }, ...curves],
      hooks: {
        drawClear: [(u) => this.shade(u)],
        draw: [() => this.drawn?.()],
        setSelect: [(u) => {
          if (u.select.width < 3) return;
          const from = u.posToVal(u.select.left, "x");
          const to = u.posToVal(u.select.left + u.select.width, "x");
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          if (mode() === "brush" && brushed) brushed(from, to); else if (zoomed) zoomed(from, to);
        }],
      },
    };
    this.plot = new uPlot(options, [[0], ...curves.map(() => [null])], this.place);
    this.built?.();
  }

  // Other curves, if they differ from the present ones.
  use(curves) {
    const names = (list) => JSON.stringify(list.map((c) => [c.name, c.label]));
    if (names(curves) === names(this.curves)) return;
    this.curves = curves; this.build();
  }

  show(data, x = data.time_s) {
    const none = x.map(() => null);
    this.data = { names: [this.settings.across, ...this.curves.map((c) => c.label)], columns: [x, ...this.curves.map((c) => data[c.name] ?? none)] };
    this.plot.setData(this.data.columns);
  }

  canvas() { return this.plot.ctx.canvas; }
  table() { return this.data; }

  // Pairs of instants, s: what fails, and what is selected.
  mark(marks, selected) {
    this.marks = marks; this.selected = selected;
    this.plot.redraw(false);
  }

  shade(u) {
    const { left, top, width, height } = u.bbox;
    const paint = (stretches, tint, alpha) => {
      u.ctx.save();
      u.ctx.globalAlpha = alpha; u.ctx.fillStyle = colour(tint);
      for (const [from, to] of stretches) {
        const a = Math.max(u.valToPos(from, "x", true), left);
        const b = Math.min(u.valToPos(to, "x", true), left + width);
        if (b >= a) u.ctx.fillRect(a, top, Math.max(b - a, 1), height);
      }
      u.ctx.restore();
    };
    paint(this.marks, "beside", 0.16);
    paint(this.selected, "selected", 0.3);
    u.ctx.save();
    u.ctx.strokeStyle = colour("beside"); u.ctx.setLineDash([4, 4]); u.ctx.lineWidth = 1;
    for (const edge of this.edges) {
      const x = u.valToPos(edge, "x", true);
      u.ctx.beginPath(); u.ctx.moveTo(x, top); u.ctx.lineTo(x, top + height); u.ctx.stroke();
    }
    u.ctx.restore();
  }
}
