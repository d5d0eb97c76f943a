// Section 2: measured and modelled in time and in the plane, over speed and over all runs; where it fails.
import { get, post } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, key, number, put } from "./dom.js";
import { Plane } from "./plane.js";
import { RunsMap } from "./runs_map.js";
import { Stribeck } from "./stribeck.js";

export class SeeSection {
  constructor(page, place) {
    this.page = page; this.drag = "brush"; this.all = false; this.ends = ["", ""];
    this.words = h("p", { class: "verdict" }); this.status = h("p", { class: "said", role: "status" });
    this.head = h("div", { class: "row" }); this.fails = h("div"); this.which = h("div", { class: "row" });
    const force = h("div", { class: "plot" }), rest = h("div", { class: "plot" }), plane = h("div"), map = h("div"), speeds = h("div");
    this.residual = h("div", {}, h("h3", {}, "Record minus model"), rest);
    place.append(this.words, this.head, this.status,
      h("div", { class: "two" }, h("section", {}, h("h2", {}, "In time"), force, this.residual),
        h("section", {}, h("div", { class: "row tight" }, h("h2", {}, "Friction against speed"), this.which), plane)),
      h("div", { class: "two" }, h("section", {}, h("h2", {}, "Lack of fit, largest first"), this.fails),
        h("section", {}, h("h2", {}, "Stribeck curve, means of all runs"), speeds)),
      h("section", {}, h("h2", {}, "Record minus model, by run and speed"), map));
    const { units } = page;
    const brushed = (from, to) => this.select({ run: page.run, from_s: from, to_s: to });
    const zoomed = (from, to) => page.look({ span: [from, to] });
    const common = { brushed, zoomed, mode: () => this.drag, sync: "see" };
    this.force = new Chart(force, { ...common, unit: `${units.noun} (${units.force})`, height: 200, curves: [
      curve("friction_n", "measured", "measured"), curve("model_n", "model", "model", { width: 1.6 }),
      curve("compared_n", "other model", "beside", { dash: [6, 4], width: 1.4 })] });
    this.rest = new Chart(rest, { ...common, unit: units.force, height: 140, legend: false, curves: [
      curve("compared_residual_n", "other model", "beside", { width: 0.8 }), curve("residual_n", "record minus model", "measured")] });
    this.plane = new Plane(plane, { brushed: (box) => this.select(box && { box }), height: 360 });
    this.speeds = new Stribeck(speeds, { brushed: (box) => this.select(box && { box }) });
    this.map = new RunsMap(map, (run, box) => page.look({ run, span: [null, null], ...(box ? { selection: { run, box } } : {}) }));
  }

  update(before) {
    const { state } = this.page;
    const now = JSON.stringify([state.current, state.compared, state.runs.map((r) => r.name), this.page.model?.records, this.page.model?.held_out_rms]);
    if (!before || now !== this.was) { this.was = now; this.looked({}); }
  }

  looked(changes) {
    const { page } = this;
    if (!page.run) { put(this.words, "No run is open."); return; }
    this.heading(); this.failures(); this.draw(changes);
  }

  heading() {
    const { page } = this, node = page.model, unit = page.units.force;
    put(this.words, node
      ? `${node.words}: RMS ${number(node.rms)} ${unit} (noise ${number(node.noise_rms)} ${unit}${node.held_out_rms ? `, held out ${number(node.held_out_rms)} ${unit}` : ""}).`
      : "Data only: no model yet.");
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
    put(this.which, runs(false, "this run"), runs(true, "all runs"), key("measured", "measured"), node ? key("model", "model") : null);
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
    const ask = Symbol(); this.ask = ask;
    const plane = { model, runs: this.all ? page.state.runs.map((r) => r.name) : [page.run], columns: 400, rows: 300 };
    const stays = Object.keys(changes).length === 1 && "selection" in changes;
    try {
      const [found, brushed] = await Promise.all([
        stays ? null : Promise.all([
          get("series", { run: page.run, model, from_s: page.span[0], to_s: page.span[1], pixels: 1000 }), post("plane", plane)]),
        page.selection ? post("brush", { ...plane, selection: page.selection }) : null,
      ]);
      if (this.ask !== ask) return;
      if (found) {
        const [series, density] = found;
        this.force.show(series); this.rest.show(series); this.plane.show(density, page.units); this.speeds.show(page.model, page.units);
      }
      this.plane.select(brushed?.selected); this.speeds.select(brushed?.speeds_m_s); this.map.select(brushed?.cells ?? []);
      for (const chart of [this.force, this.rest]) chart.mark([], brushed?.by_run[page.run]?.stretches_s ?? []);
      this.say(brushed); page.selected(brushed);
      document.body.dataset.drawn = `${page.run} ${model ?? ""}`;
      document.body.dataset.draws = String(++page.draws);
      if (stays) return;
      if (model !== null && page.model?.records) this.map.show(await get("map", { model }), page.units, page.run, page.model.noise_rms);
      else this.map.clear();
    } catch (error) { page.say(error.message); }
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
