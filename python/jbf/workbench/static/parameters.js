// Parameters of the model: values, intervals, bounds; edited values are drawn at once and can be fitted.
import { post } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, key, number, put } from "./dom.js";

export class Parameters {
  constructor(page, place) {
    this.page = page; this.table = h("div", { class: "scroll" }); this.foot = h("div", { class: "row" });
    this.words = h("p", { class: "faint", role: "status" }); this.plot = h("div", { class: "plot" });
    place.append(this.table, this.foot, this.words, this.plot);
    this.reset();
  }

  // Start with the fixed values and bounds of the fit of a model.
  reset(node) {
    const { fixed = {}, bounds = {} } = node?.settings ?? {};
    this.values = {}; this.fixed = new Set(Object.keys(fixed));
    this.bounds = Object.fromEntries(Object.entries(bounds).map(([name, ends]) => [name, [...ends]]));
  }

  // `again`: the model is another one.
  show(again) {
    const node = this.page.model;
    if (again) { this.reset(node); this.chart = null; put(this.plot); put(this.words, ""); }
    if (!node) { put(this.table, h("p", { class: "faint" }, "None yet.")); put(this.foot); return; }
    const busy = Boolean(this.page.state.job);
    const rows = Object.entries(node.parameters).map(([name, p]) => this.row(name, p));
    const head = ["parameter", "value", "unit", "95 % interval", "fixed", "lower bound", "upper bound"];
    put(this.table, h("table", {}, h("thead", {}, h("tr", {}, head.map((w) => h("th", {}, w)))), h("tbody", {}, rows)));
    put(this.foot, h("button", { class: "main", "data-key": "refit", disabled: busy, onclick: () => this.refit() }, "Fit with these settings"),
      h("button", { "data-key": "reset-parameters", onclick: () => this.show(true) }, "Reset"),
      h("span", { class: "faint" }, "A changed value is drawn at once and is the starting value of the fit; a fixed value is kept."));
  }

  row(name, p) {
    const held = p.held || p.stderr === null || p.stderr === undefined, half = 1.96 * p.stderr;
    const field = (what, value, set) => h("input", { class: "short", type: "number", step: "any", value: value ?? "",
      "aria-label": `${what} of ${name}`, "data-key": `${what}-${name}`,
      oninput: (e) => set(e.target.value === "" ? null : Number(e.target.value)) });
    const end = (which) => (value) => { this.bounds[name] ??= [null, null]; this.bounds[name][which] = value; };
    const value = field("value", this.values[name] ?? Number(p.value.toPrecision(6)), (v) => { if (v === null) delete this.values[name]; else this.values[name] = v; this.follow(); });
    value.addEventListener("keydown", (e) => {
      // Steps of one percent, since a step of one means nothing for most parameters.
      const way = { ArrowUp: 1, ArrowDown: -1 }[e.key];
      if (!way) return;
      e.preventDefault();
      value.value = Number((Number(value.value) + way * 0.01 * (Math.abs(p.value) || 1)).toPrecision(6));
      value.dispatchEvent(new Event("input"));
    });
    return h("tr", {}, h("td", {}, name, h("br"), h("small", {}, p.meaning)), h("td", {}, value), h("td", {}, p.unit ?? ""),
      h("td", {}, held ? `held${p.note ? ` (${p.note})` : ""}` : `${number(p.value - half, 4)} to ${number(p.value + half, 4)}`),
      h("td", {}, h("input", { type: "checkbox", checked: this.fixed.has(name), "aria-label": `fix ${name}`, "data-key": `fix-${name}`,
        onchange: (e) => this.fixed[e.target.checked ? "add" : "delete"](name) })),
      h("td", {}, field("lower", this.bounds[name]?.[0], end(0))), h("td", {}, field("upper", this.bounds[name]?.[1], end(1))));
  }

  // The curve with the edited values; requests that are overtaken are dropped.
  async follow() {
    const { page } = this, node = page.model, ask = Symbol(); this.latest = ask;
    await new Promise((resolve) => setTimeout(resolve, 60));
    if (this.latest !== ask || !node || !page.run) return;
    let found;
    try { found = await post("edited", { model: node.id, values: this.values, run: page.run, from_s: page.span[0], to_s: page.span[1], pixels: 800 }); } catch (error) {
      if (this.latest === ask) put(this.words, error.message);
      return;
    }
    if (this.latest !== ask) return;
    this.chart ??= new Chart(this.plot, { unit: page.units.force, height: 200,
      curves: [curve("friction_n", "measured", "measured"), curve("model_n", "model", "model"), curve("edited", "edited", "edited", { width: 1.8 })],
      zoomed: (from, to) => page.look({ span: [from, to] }) });
    this.chart.show(found);
    const own = node.runs.find((r) => r.name === page.run)?.rms;
    put(this.words, key("edited", `${page.run} with the edited values: RMS ${number(found.rms)} ${page.units.force}`), own === undefined ? "" : ` (the model: ${number(own)})`);
    this.plot.dataset.drawn = JSON.stringify(this.values);
  }

  refit() {
    const { page } = this, node = page.model, settings = { start: {}, fixed: {}, bounds: {} };
    for (const [name, p] of Object.entries(node.parameters)) {
      const value = this.values[name] ?? p.value, ends = this.bounds[name];
      if (this.fixed.has(name)) settings.fixed[name] = value;
      else if (name in this.values) settings.start[name] = value;
      if (!this.fixed.has(name) && ends && ends.some((v) => v !== null)) settings.bounds[name] = [ends[0] ?? p.lower, ends[1] ?? p.upper];
    }
    page.do("refit", { model: node.id, settings });
  }
}

// The key of a parameter with its plain name.
const plain = (name, nodes) => [name, h("br"), h("small", {}, nodes.find((n) => n.parameters[name]).parameters[name].meaning)];

// The current model and those that are compared with it, one column each.
export function sideBySide(page, place) {
  const { state } = page, ids = [...new Set([state.current, ...state.compared])].filter((id) => id !== null);
  const nodes = ids.map((id) => state.nodes.find((n) => n.id === id)).filter(Boolean);
  if (nodes.length < 2) { put(place); return; }
  const unit = page.units.force, names = [...new Set(nodes.flatMap((n) => Object.keys(n.parameters)))];
  const cell = (words) => h("td", { class: "n" }, words);
  const line = (title, of) => h("tr", {}, h("th", { scope: "row" }, title), nodes.map((n) => cell(of(n))));
  put(place, h("div", { class: "plot-head" }, h("h2", {}, "Models side by side"),
    h("button", { "data-key": "plot-side-by-side", onclick: () => page.enter("Explore") }, "Plot them in 2 Explore")), h("div", { class: "scroll" }, h("table", { "data-key": "side-by-side" },
    h("thead", {}, h("tr", {}, h("td", {}), nodes.map((n) => h("th", { class: "n", scope: "col" }, n.name || n.words)))),
    h("tbody", {}, line("held-out error, times the noise", (n) => (n.held_out_rms && n.noise_rms ? `${(n.held_out_rms / n.noise_rms).toFixed(2)} ×` : "–")),
      line(`RMS of the fit (${unit})`, (n) => number(n.rms)), line(`noise (${unit})`, (n) => number(n.noise_rms)),
      line("estimated parameters", (n) => String(Object.values(n.parameters).filter((p) => !p.held).length)),
      names.map((name) => line(plain(name, nodes), (n) => (n.parameters[name] ? `${number(n.parameters[name].value, 4)} ${n.parameters[name].unit ?? ""}` : "–")))))));
}

// Name and note of the model, and its effects with a button that removes each.
export function about(page, place) {
  const node = page.model;
  if (!node) { put(place); return; }
  const send = () => page.do("label", { model: node.id, name: name.value, note: note.value });
  const name = h("input", { class: "name", value: node.name ?? "", placeholder: node.words, "aria-label": "name of the model", "data-key": "model-name", onchange: send });
  const note = h("input", { class: "name", value: node.note ?? "", placeholder: "note", "aria-label": "note on the model", "data-key": "model-note", onchange: send });
  const busy = Boolean(page.state.job);
  put(place, h("div", { class: "row" }, h("label", {}, "Name ", name), h("label", {}, "Note ", note)),
    h("div", { class: "row" }, h("span", {}, `Model: ${node.law}`), node.effects.map((effect) =>
      h("button", { "data-key": `remove-${effect}`, disabled: busy, title: "fit without it", "aria-label": `remove ${effect}`,
      onclick: () => page.do("fit", { effects: node.effects.filter((e) => e !== effect), parent: node.parent ?? node.id }) }, `${effect} ×`))));
}
