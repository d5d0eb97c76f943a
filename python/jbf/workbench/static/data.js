// Section 1: what is in the folder, files from elsewhere, records as they were read, trims.
import { get } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, put } from "./dom.js";
import { Files } from "./files.js";
import { plotHead } from "./plot_tools.js";
import { TrimHandles } from "./trim.js";

export class DataSection {
  constructor(page, place) {
    this.page = page; page.importing = false;
    this.raw = h("div"); this.place = place; this.shelf = h("section");
    const map = h("div");
    this.files = new Files(page, this.shelf, {
      map, done: () => page.enter("Data"),
      importing: (now) => {
        page.importing = now; page.banner();
        for (const part of [this.shelf, this.raw]) part.style.display = now ? "none" : "";
      } });
    place.append(map, this.shelf, this.raw);
  }

  update(before) {
    const { state } = this.page, names = (s) => JSON.stringify([s.rig, s.runs.map((r) => r.file)]);
    if (!before || names(before) !== names(state)) this.list();
    if (!before || JSON.stringify(before.runs) !== JSON.stringify(state.runs)) this.draw();
  }

  looked() { this.draw(); }

  list() {
    // Once there are runs they come first; at once: what is moved later loses the keys.
    if (this.page.state.runs.length > 0 && this.place.lastChild !== this.shelf) this.place.append(this.raw, this.shelf);
    return this.files.list();
  }

  async draw() {
    const { page } = this;
    const run = page.state.runs.find((r) => r.name === page.run);
    if (!run) { put(this.raw); this.chart = null; return; }
    if (!this.chart || this.drawn !== run.name) {
      const force = h("div", { class: "plot" }), speed = h("div", { class: "plot" }), { units } = page;
      this.trims = h("div");
      put(this.raw, plotHead("h2", `${run.name}, as recorded`, "record", { canvas: () => this.chart.canvas(), table: () => this.chart.table() }), this.trims, force, speed);
      const zoomed = (from, to) => page.look({ span: [from, to] });
      this.chart = new Chart(force, { curves: [curve("friction_n", "measured", "measured")], unit: `${units.noun} (${units.force})`, zoomed, sync: "data" });
      this.speed = new Chart(speed, { curves: [curve("velocity_m_s", "speed", "model")], unit: `speed (${units.speed})`, height: 130, zoomed, sync: "data", legend: false });
      this.handles = new TrimHandles(this.chart, (from, to) => page.do("trim", { run: page.run, from_s: from, to_s: to }));
      this.drawn = run.name;
    }
    this.trim(run);
    const asked = { run: run.name, from_s: page.span[0], to_s: page.span[1], pixels: 1000 };
    const found = await page.ask(() => get("series", asked));
    if (!found || !this.chart || this.drawn !== run.name) return;
    const out = run.trim ? [[run.from_s, run.trim[0]], [run.trim[1], run.to_s]] : [];
    for (const chart of [this.chart, this.speed]) { chart.show(found); chart.mark(out, []); }
    this.handles.show(run);
    this.raw.dataset.drawn = run.name;
  }

  trim(run) {
    const [from, to] = run.trim ?? [run.from_s, run.to_s], findings = run.findings ?? [];
    const set = (which, value) => {
      const span = which === 0 ? [Number(value), to] : [from, Number(value)];
      return this.page.do("trim", { run: run.name, from_s: span[0], to_s: span[1] });
    };
    const end = (which, words, value) => h("label", {}, `${words} `,
      h("input", { type: "number", class: "short", step: "any", value: Number(value.toPrecision(8)), "aria-label": `${words}, s`,
        "data-key": `trim-n-${which}`, onchange: (e) => set(which, e.target.value) }), " s");
    put(this.trims, h("div", { class: "row" }, end(0, "Use from", from), end(1, "to", to),
      h("button", { "data-key": "untrim", disabled: !run.trim, onclick: () => this.page.do("trim", { run: run.name }) }, "Reset trim"),
      h("span", { class: "faint" }, "Handles in the plot trim the run; drag to zoom, double-click to reset.")),
    run.findings === null ? h("p", { class: "faint" }, "Checking the data quality…")
      : findings.length ? [h("h3", {}, "Data quality"), h("ul", {}, findings.map((f) => h("li", {}, `${f.words}${f.done && f.done !== "none" ? ` (${f.done})` : ""}`)))]
        : h("p", { class: "faint" }, "No problem with the data quality was found."));
  }
}
