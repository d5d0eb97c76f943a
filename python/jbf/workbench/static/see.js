// Section 2: measured and modelled in time and in the plane, over speed and over all runs; where it fails.
import { get, post } from "./api.js";
import { AnyChannel } from "./any_channel.js";
import { Chart, curve, hollow } from "./chart.js";
import { h, key, number, put } from "./dom.js";
import { Plane } from "./plane.js";
import { plotHead } from "./plot_tools.js";
import { showRegimes } from "./regimes.js";
import { RunsMap } from "./runs_map.js";
import { TINTS } from "./side.js";
import { Stribeck } from "./stribeck.js";

export class SeeSection {
  constructor(page, place) {
    this.page = page; this.drag = "brush"; this.all = false; this.axis = "speed"; this.ends = ["", ""];
    this.status = h("p", { class: "said", role: "status" });
    this.head = h("div", { class: "row" }); this.fails = h("div"); this.regimes = h("div"); this.which = h("div", { class: "row" });
    const force = h("div", { class: "plot" }), rest = h("div", { class: "plot" }), plane = h("div"), map = h("div"), speeds = h("div"), any = h("div");
    const drawn = (name) => ({ canvas: () => this[name].canvas(), table: () => this[name].table() });
    const own = (name) => ({ canvas: () => this[name].canvas, table: () => this[name].table() });
    this.residual = h("div", {}, plotHead("h3", "Record minus model", "residual", drawn("rest")), rest);
    place.append(this.head, this.status,
      h("div", { class: "two" }, h("section", {}, plotHead("h2", "In time", "force", drawn("force")), force, this.residual),
        h("section", {}, plotHead("h2", "Friction against speed or position", "plane", own("plane")), this.which, plane)),
      h("div", { class: "two" }, h("section", {}, h("h2", {}, "Lack of fit, largest first"), this.fails, this.regimes),
        h("section", {}, plotHead("h2", "Stribeck curve, means of all runs", "stribeck", own("speeds")), speeds)),
      h("section", {}, plotHead("h2", "Record minus model, by run and speed", "runs_by_speed", own("map")), map), any);
    const { units } = page;
    const brushed = (from, to) => this.select({ run: page.run, from_s: from, to_s: to });
    const zoomed = (from, to) => page.look({ span: [from, to] });
    const common = { brushed, zoomed, mode: () => this.drag, sync: "see" };
    this.force = new Chart(force, { ...common, unit: `${units.noun} (${units.force})`, height: 220, curves: this.forceCurves() });
    this.rest = new Chart(rest, { ...common, unit: units.force, height: 140, legend: false, curves: this.residualCurves() });
    this.plane = new Plane(plane, { brushed: (box) => this.select(box && { box, axis: this.axis }), height: 360 });
    this.speeds = new Stribeck(speeds, { brushed: (box) => this.select(box && { box }) });
    this.map = new RunsMap(map, (run, box) => page.look({ run, span: [null, null], ...(box ? { selection: { run, box } } : {}) }));
    this.any = new AnyChannel(page, any);
  }

  named(id) { const node = this.page.state.nodes.find((n) => n.id === id); return node ? node.name || node.words : ""; }

  forceCurves() {
    const { current, compared } = this.page.state;
    return [curve("friction_n", "measured", "measured"),
      ...(current === null ? [] : [hollow("unused", "measured, not used by the fit", "measured"), curve("model_n", "model", "model", { width: 1.6 })]),
      ...compared.map((id, i) => curve(`model_${id}`, this.named(id), TINTS[i], { dash: [6, 4], width: 1.4 }))];
  }

  residualCurves() {
    return [...this.page.state.compared.map((id, i) => curve(`residual_${id}`, this.named(id), TINTS[i], { width: 0.8 })), curve("residual_n", "record minus model", "measured")];
  }

  update(before) {
    const { state } = this.page;
    const now = JSON.stringify([state.current, state.compared, state.runs.map((r) => r.name), this.page.model?.records, this.page.model?.held_out_rms]);
    if (!before || now !== this.was) { this.was = now; this.looked({}); }
  }

  looked(changes) {
    const { page } = this;
    if (!page.run) { put(this.status, "No run is open."); return; }
    this.heading(); this.failures(); this.draw(changes);
  }

  heading() {
    const { page } = this, node = page.model;
    this.residual.style.display = node ? "" : "none";
    const way = (mode, words) => h("label", {}, h("input", { type: "radio", name: "drag", checked: this.drag === mode, "data-key": `drag-${mode}`,
      onchange: () => { this.drag = mode; } }), ` ${words} `);
    const end = (which, words) => h("label", {}, `${words} `, h("input", { type: "number", class: "short", step: "any", value: this.ends[which], "data-key": `from-to-${which}`,
      "aria-label": `${which ? "end" : "start"} of the interval, s`, onchange: (e) => { this.ends[which] = e.target.value; this.heading(); } }));
    const [from, to] = this.ends.map(Number), there = this.ends.every((v) => v !== "") && from < to;
    put(this.head, "Dragging", way("brush", "selects"), way("zoom", "zooms"),
      end(0, "Time from"), end(1, "to"), "s",
      h("button", { "data-key": "select-stretch", disabled: !there, onclick: () => this.select({ run: page.run, from_s: from, to_s: to }) }, "Select"),
      h("button", { "data-key": "zoom-stretch", disabled: !there, onclick: () => page.look({ span: [from, to] }) }, "Zoom"),
      h("button", { "data-key": "all-time", disabled: page.span[0] === null, onclick: () => page.look({ span: [null, null] }) }, "Full time range"),
      h("button", { "data-key": "no-selection", disabled: !page.selection, onclick: () => this.select(null) }, "Clear selection"));
    const runs = (all, words) => h("label", {}, h("input", { type: "radio", name: "plane", checked: this.all === all, "data-key": all ? "all-runs" : "this-run",
      onchange: () => { this.all = all; this.looked({}); } }), ` ${words} `);
    const across = h("select", { "aria-label": "horizontal axis", "data-key": "axis", onchange: (e) => { this.axis = e.target.value; this.select(null); this.looked({}); } },
      [["speed", page.units.velocity], ["position", "position"]].map(([v, words]) => h("option", { value: v, selected: v === this.axis }, words)));
    put(this.which, h("label", {}, "against ", across), runs(false, "this run"), runs(true, "all runs"), key("measured", "measured"),
      node ? [key("model", "model"), key("hollow", "not used by the fit (reversals, rests, start)")] : null);
  }

  select(selection) { this.page.look({ selection }); }

  failures() {
    const { page } = this, node = page.model, unit = page.units.force;
    if (!node) { put(this.fails, h("p", { class: "faint" }, "No model: fit one first.")); return; }
    const marked = page.selection?.mark;
    put(this.fails, node.failures.length ? h("table", {}, h("tbody", {}, node.failures.map((f, i) =>
      h("tr", { class: marked === i ? "now" : "" },
        h("td", {}, h("button", { "data-key": `fail-${i}`, "aria-pressed": String(marked === i), title: "mark in all plots",
          onclick: () => (marked === i ? this.select(null) : this.mark(i)) }, `along ${f.axis}`)),
        h("td", {}, `${(100 * f.share).toFixed(0)} % of the mean square error: ${f.where}.`, marked === i ? h("div", { class: "faint" }, `Usual cause: ${f.causes}. Next: ${f.to_do}.`) : null)))))
      : h("p", {}, `No lack of fit: the residual (${number(node.rms)} ${unit}) has no pattern along speed, direction, regime, time, angle or run.`),
      node.findings.length ? [h("h3", {}, "Data quality"), h("ul", {}, node.findings.map((f) => h("li", {}, f.words)))] : null);
  }

  // A failure, in a run that has it.
  mark(i) {
    const { page } = this, { ranges_s: ranges } = page.model.failures[i], names = page.model.record_names;
    const held = Object.entries(ranges).map(([k, stretches]) => [names[k], stretches.reduce((sum, [a, b]) => sum + b - a, 0)]);
    const best = held.reduce((a, b) => (b[1] > a[1] ? b : a), [page.run, 0])[0];
    const here = held.some(([name]) => name === page.run);
    page.look({ selection: { mark: i }, ...(here ? {} : { run: best, span: [null, null] }) });
  }

  // What is drawn already is not asked for again: of a new selection only where it lies.
  async draw(changes = {}) {
    const { page } = this, model = page.state.current;
    const ask = Symbol(); this.latest = ask;
    const plane = { model, runs: this.all ? page.state.runs.map((r) => r.name) : [page.run], columns: 400, rows: 300, axis: this.axis };
    const stays = Object.keys(changes).length === 1 && "selection" in changes;
    const answers = await page.ask(() => Promise.all([
      stays ? null : Promise.all([
        get("series", { run: page.run, model, from_s: page.span[0], to_s: page.span[1], pixels: 1000 }), post("plane", plane),
        model !== null && page.model?.records ? get("map", { model }) : null]),
      page.selection ? post("brush", { ...plane, selection: page.selection }) : null,
    ]));
    if (this.latest !== ask || !answers) return;
    const [found, brushed] = answers;
    if (found) this.show(...found);
    this.plane.select(brushed?.selected); this.speeds.select(brushed?.speeds_m_s); this.map.select(brushed?.cells ?? []);
    for (const chart of [this.force, this.rest]) chart.mark([], brushed?.by_run[page.run]?.stretches_s ?? []);
    this.say(brushed); page.selected(brushed);
    document.body.dataset.drawn = `${page.run} ${model ?? ""}`;
    document.body.dataset.draws = String(++page.draws);
    if (!stays) this.any.draw();
  }

  show(series, density, map) {
    const { page } = this;
    for (const other of series.others) { series[`model_${other.model}`] = other.model_n; series[`residual_${other.model}`] = other.residual_n; }
    this.force.use(this.forceCurves()); this.rest.use(this.residualCurves());
    this.force.show(series); this.rest.show(series);
    this.plane.show(density, page.units, this.axis); this.speeds.show(page.model, page.units);
    if (map) this.map.show(map, page.units, page.run, page.model.noise_rms); else this.map.clear();
    showRegimes(page, this.regimes);
  }

  say(brushed) {
    const { page } = this, unit = page.units.force, mark = page.selection?.mark;
    if (!brushed) { this.status.textContent = "Drag in any plot to select samples in all plots."; return; }
    const there = brushed.rms === null ? "" : `; residual: mean ${number(brushed.mean_n)} ${unit}, RMS ${number(brushed.rms)} ${unit}`;
    const runs = Object.entries(brushed.by_run).map(([name, one]) => `${name} ${one.samples}`);
    const named = runs.length ? ` (${runs.slice(0, 4).join(", ")}${runs.length > 4 ? ", …" : ""})` : "";
    this.status.textContent = `${mark === undefined ? "Selected" : `Marked: ${page.model.failures[mark].bin}`}: ${brushed.samples} samples${named}${there}.`;
  }
}
