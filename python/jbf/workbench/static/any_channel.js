// Any channel of a run on demand: as recorded, its derivative, or its spectrum.
import { get } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, put } from "./dom.js";
import { plotHead } from "./plot_tools.js";

const TRANSFORMS = { value: "as recorded", derivative: "derivative", spectrum: "spectrum" };

export class AnyChannel {
  constructor(page, place) {
    this.page = page; this.channel = null; this.transform = "spectrum";
    this.head = h("div", { class: "row" }); this.plot = h("div", { class: "plot" });
    this.part = h("details", { ontoggle: () => this.draw() }, h("summary", { "data-key": "any-channel" }, "Any channel: as recorded, derivative or spectrum"), this.head,
      plotHead("h3", "Channel", "channel", { canvas: () => this.chart?.canvas(), table: () => this.chart?.table() }), this.plot);
    place.append(this.part);
  }

  async draw() {
    const { page } = this;
    if (!this.part.open || !page.run) return;
    const asked = { run: page.run, model: page.state.current }, ask = Symbol(); this.latest = ask;
    const names = await page.ask(() => get("channels", asked));
    if (!names || this.latest !== ask) return;
    if (!(this.channel in names)) this.channel = Object.keys(names).at(-1);
    const select = (key, label, options, value, set) => h("label", {}, `${label} `, h("select", { "data-key": key, "aria-label": label, onchange: (e) => { set(e.target.value); this.draw(); } },
      Object.entries(options).map(([v, words]) => h("option", { value: v, selected: v === value }, words))));
    put(this.head, select("channel", "Channel", Object.fromEntries(Object.keys(names).map((n) => [n, n])), this.channel, (v) => { this.channel = v; }),
      select("transform", "shown", TRANSFORMS, this.transform, (v) => { this.transform = v; }));
    const found = await page.ask(() => get("channel", { ...asked, channel: this.channel, transform: this.transform, from_s: page.span[0], to_s: page.span[1], pixels: 900 }));
    if (!found || this.latest !== ask) return;
    put(this.plot);
    const scale = found.logarithmic ? { x: { distr: 3 }, y: { distr: 3 } } : {};
    this.chart = new Chart(this.plot, { curves: [curve("y", found.y_label, "model")], unit: found.y_label, across: found.x_label, scales: scale,
      zoomed: found.logarithmic ? null : (from, to) => page.look({ span: [from, to] }) });
    this.chart.show(found, found.x);
    this.plot.dataset.drawn = `${this.channel} ${this.transform}`;
  }
}
