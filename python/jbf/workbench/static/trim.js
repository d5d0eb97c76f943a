// Two handles on a plot, between which a run is used: dragged, or moved by the arrow keys.
import { h, number } from "./dom.js";

export class TrimHandles {
  // `set(from, to)` is called when a handle is let go.
  constructor(chart, set) {
    this.chart = chart; this.set = set; this.span = null; this.waits = 0;
    this.handles = [0, 1].map((which) => this.handle(which));
    chart.plot.over.append(...this.handles);
    chart.drawn = () => this.place();
  }

  // The run's ends and the stretch that is used; a handle that is being moved stays where it is.
  show(run) {
    this.ends = [run.from_s, run.to_s];
    if (!this.moving) this.span = [...(run.trim ?? this.ends)];
    this.place();
  }

  handle(which) {
    const words = which ? "end of the used interval" : "start of the used interval";
    const handle = h("div", { class: `handle ${which ? "end" : "begin"}`, role: "slider", tabindex: 0, "aria-label": words, title: `${words}: drag, or arrow keys`, "data-key": `trim-${which}`,
      // The plot's own dragging begins with the mouse, too.
      onmousedown: (e) => e.stopPropagation(),
      onpointerdown: (e) => { handle.setPointerCapture(e.pointerId); this.held = which; },
      onpointermove: (e) => { if (this.held === which) this.move(which, this.chart.plot.posToVal(e.clientX - this.chart.plot.over.getBoundingClientRect().left, "x")); },
      onpointerup: () => { if (this.held === which) { this.held = null; this.letGo(); } },
      onkeydown: (e) => this.key(which, e) });
    return handle;
  }

  key(which, event) {
    const step = (this.ends[1] - this.ends[0]) / (event.shiftKey ? 20 : 200);
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (way) this.move(which, this.span[which] + way * step);
    else if (event.key === "Home" || event.key === "End") this.move(which, this.ends[which]);
    else return;
    event.preventDefault(); event.stopPropagation();
    clearTimeout(this.waits); this.waits = setTimeout(() => this.letGo(), 400);
  }

  letGo() {
    this.moving = false;
    this.set(...this.span);
  }

  move(which, value) {
    this.moving = true;
    const [low, high] = which ? [this.span[0], this.ends[1]] : [this.ends[0], this.span[1]];
    this.span[which] = Math.min(Math.max(value, low), high);
    this.chart.mark([[this.ends[0], this.span[0]], [this.span[1], this.ends[1]]], []);
    this.place();
  }

  place() {
    if (!this.span) return;
    const { plot } = this.chart, wide = plot.over.clientWidth;
    this.handles.forEach((handle, which) => {
      const at = plot.valToPos(this.span[which], "x");
      handle.style.left = `${at}px`;
      handle.style.display = at < -1 || at > wide + 1 || Number.isNaN(at) ? "none" : "";
      for (const [name, value] of [["valuemin", this.ends[0]], ["valuemax", this.ends[1]], ["valuenow", this.span[which]]]) handle.setAttribute(`aria-${name}`, value);
      handle.setAttribute("aria-valuetext", `${number(this.span[which], 5)} s`);
    });
  }
}
