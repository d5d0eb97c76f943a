// Room 2: measured and modelled in time and in the plane, a map over all runs, where it fails.
import { get, post } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, key, number, put } from "./dom.js";
import { Plane } from "./plane.js";
import { RunsMap } from "./runs_map.js";

export class SeeRoom {
  constructor(page, place) {
    this.page = page; this.drag = "brush"; this.all = false; this.curve = true;
    this.words = h("p", { class: "verdict" }); this.said = h("p", { class: "faint" });
    const force = h("div", { class: "plot" }), rest = h("div", { class: "plot" }), plane = h("div"), map = h("div");
    this.fails = h("div");
    this.head = h("div", { class: "row" });
    place.append(this.words, this.head, this.said,
      h("div", { class: "two" }, h("section", {}, h("h2", {}, "In time"), force, h("h3", {}, "Record minus model"), rest),
        h("section", {}, h("h2", {}, "Friction against speed"), plane)),
      h("div", { class: "two" }, h("section", {}, h("h2", {}, "Where it fails, worst first"), this.fails),
        h("section", {}, h("h2", {}, "Record minus model, by run and speed"), map)));
    const { units } = page;
    const brushed = (from, to) => this.select({ run: page.run, from_s: from, to_s: to });
    const zoomed = (from, to) => page.look({ span: [from, to] });
    const common = { brushed, zoomed, mode: () => this.drag, sync: "see" };
    this.force = new Chart(force, { ...common, unit: units.force, height: 220, curves: [
      curve("friction_n", "measured", "measured"), curve("model_n", "model", "model", { width: 1.6 }),
      curve("beside_n", "beside", "beside", { dash: [6, 4], width: 1.4 })] });
    this.rest = new Chart(rest, { ...common, unit: units.force, height: 130, legend: false, curves: [curve("residual_n", "record minus model", "measured")] });
    this.plane = new Plane(plane, { brushed: (box) => this.select(box && { box }), height: 326 });
    this.map = new RunsMap(map, (run) => page.look({ run, span: [null, null] }));
  }

  told(before) {
    const { state } = this.page;
    const now = JSON.stringify([state.current, state.beside, state.runs.map((r) => r.name), this.page.model?.record_names]);
    if (!before || now !== this.was) { this.was = now; this.looked({}); }
  }

  looked(changes) {
    const { page } = this;
    if (!page.run) { put(this.words, "Open some runs in room 1."); return; }
    this.heading(); this.failures(); this.draw(changes);
  }

  heading() {
    const { page } = this, node = page.model, unit = page.units.force;
    put(this.words, node
      ? `${node.words}: RMS ${number(node.rms_n)} ${unit} where the noise is ${number(node.noise_n)} ${unit}${node.holdout_rms_n ? `; on runs left out ${number(node.holdout_rms_n)} ${unit}` : ""}.`
      : "The records alone: fit a model in room 3.");
    const way = (mode, words) => h("label", {}, h("input", { type: "radio", name: "drag", checked: this.drag === mode, "data-key": `drag-${mode}`,
      onchange: () => { this.drag = mode; } }), ` ${words} `);
    put(this.head, "Dragging: ", way("brush", "selects"), way("zoom", "zooms"),
      h("button", { "data-key": "all-time", onclick: () => page.look({ span: [null, null] }) }, "All of the time"),
      h("button", { "data-key": "no-selection", disabled: !page.selection, onclick: () => this.select(null) }, "Clear selection"),
      h("label", {}, h("input", { type: "checkbox", checked: this.all, "data-key": "all-runs", onchange: (e) => { this.all = e.target.checked; this.looked({}); } }), " plane of all runs"),
      h("label", {}, h("input", { type: "checkbox", checked: this.curve, "data-key": "curve", onchange: (e) => { this.curve = e.target.checked; this.draw(); } }), " steady curve"),
      key("measured", "measured"), key("model", "model"), page.state.beside ? key("beside", "beside") : null, key("selected", "selected"));
  }

  select(selection) { this.page.look({ selection, mark: null }); }

  failures() {
    const { page } = this, node = page.model, unit = page.units.force;
    if (!node) { put(this.fails, h("p", { class: "faint" }, "Nothing to compare with.")); return; }
    put(this.fails, node.failures.length ? h("table", {}, h("tbody", {}, node.failures.map((f, i) =>
      h("tr", { class: page.mark === i ? "now" : "" },
        h("td", {}, h("button", { "data-key": `fail-${i}`, "aria-pressed": String(page.mark === i),
          onclick: () => page.look({ mark: page.mark === i ? null : i }) }, f.axis)),
        h("td", { class: "n" }, `${(100 * f.share).toFixed(0)} %`), h("td", {}, f.where)))))
      : h("p", {}, `Nowhere: what is left (${number(node.rms_n)} ${unit}) has no pattern along speed, direction, regime, time, angle or run.`));
  }

  // What is drawn already is not asked for again: of a new selection only where it lies.
  async draw(changes = {}) {
    const { page } = this, model = page.state.current;
    const ask = Symbol(); this.ask = ask;
    const plane = { model, runs: this.all ? page.state.runs.map((r) => r.name) : [page.run], columns: 400, rows: 300 };
    const stays = Object.keys(changes).length > 0 && Object.keys(changes).every((name) => name === "selection" || name === "mark");
    try {
      const [found, brushed] = await Promise.all([
        stays ? null : Promise.all([
          get("series", { run: page.run, model, from_s: page.span[0], to_s: page.span[1], pixels: 1000 }), post("plane", plane)]),
        page.selection ? post("brush", { ...plane, selection: page.selection }) : null,
      ]);
      if (this.ask !== ask) return;
      if (found) {
        const [series, density] = found;
        this.force.show(series); this.rest.show(series); this.plane.show(density, page.units, this.curve ? page.model?.curve : null);
      }
      this.plane.select(brushed?.selected);
      const marks = page.mark === null ? [] : this.stretches(page.mark), selected = brushed?.stretches_s[page.run] ?? [];
      for (const chart of [this.force, this.rest]) chart.mark(marks, selected);
      this.say(brushed);
      document.body.dataset.drawn = `${page.run} ${model ?? ""}`;
      document.body.dataset.draws = String(++page.draws);
      if (stays) return;
      if (model !== null && page.model?.record_names) this.map.show(await get("map", { model }), page.units, page.run, page.model.noise_n);
      else this.map.clear();
    } catch (error) { page.say(error.message); }
  }

  // The worst bin of a pattern in the run that is shown.
  stretches(index) {
    const node = this.page.model;
    return node.failures[index]?.ranges_s[String(node.record_names.indexOf(this.page.run))] ?? [];
  }

  say(brushed) {
    const { page } = this, unit = page.units.force;
    if (!brushed) { this.said.textContent = page.mark === null ? "" : `Marked: ${page.model.failures[page.mark].bin}.`; return; }
    const there = brushed.rms_n === null ? "" : `; record minus model there: mean ${number(brushed.mean_n)} ${unit}, RMS ${number(brushed.rms_n)} ${unit}`;
    this.said.textContent = `Selected: ${brushed.samples} samples in ${Object.keys(brushed.stretches_s).length} runs${there}.`;
  }
}
