// Curves over time by uPlot, with stretches marked behind them.
import { colour } from "./dom.js";

const axis = (label, extra = {}) => ({
  label, labelSize: 18, stroke: () => colour("ink"), grid: { stroke: () => colour("line"), width: 1 },
  ticks: { stroke: () => colour("line") }, font: "12px system-ui", labelFont: "12px system-ui", ...extra,
});

// A curve: where `name` finds its numbers, what it is called, its colour by name.
export const curve = (name, label, tint, extra = {}) =>
  ({ name, label, stroke: () => colour(tint), width: 1.2, spanGaps: false, points: { show: false }, ...extra });

export class Chart {
  // `place` an element; `curves` as above; `brushed(from, to)` is told what was dragged over.
  constructor(place, { curves, unit, height = 190, brushed, zoomed, mode = () => "zoom", sync, legend = true }) {
    this.place = place; this.curves = curves; this.marks = []; this.selected = []; this.height = height;
    const self = this;
    const options = {
      width: Math.max(place.clientWidth, 320), height,
      scales: { x: { time: false } },
      legend: { show: legend, live: true },
      cursor: {
        sync: sync ? { key: sync } : undefined,
        drag: { x: true, y: false, setScale: false },
        bind: { dblclick: () => () => { if (zoomed) zoomed(null, null); } },
      },
      axes: [axis("time (s)", { size: 32, labelSize: 16, labelGap: 0 }), axis(unit, { size: 54, labelGap: 2, space: height < 150 ? 18 : 30 })],
      series: [{ label: "t (s)" }, ...curves],
      hooks: {
        drawClear: [(u) => self.shade(u)],
        draw: [() => self.drawn?.()],
        setSelect: [(u) => {
          if (u.select.width < 3) return;
          const from = u.posToVal(u.select.left, "x");
          const to = u.posToVal(u.select.left + u.select.width, "x");
          u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          if (mode() === "brush" && brushed) brushed(from, to); else if (zoomed) zoomed(from, to);
        }],
      },
    };
    this.plot = new uPlot(options, [[0], ...curves.map(() => [null])], place);
    new ResizeObserver(() => this.plot.setSize({ width: Math.max(place.clientWidth, 320), height })).observe(place);
  }

  show(data) {
    const none = data.time_s.map(() => null);
    this.plot.setData([data.time_s, ...this.curves.map((c) => data[c.name] ?? none)]);
  }

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
  }
}
