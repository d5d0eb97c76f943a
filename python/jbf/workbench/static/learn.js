// Section 3: what is missing: candidates with their evidence, one click adds, the error falls.
import { get } from "./api.js";
import { ranked, showCandidates } from "./candidates.js";
import { Chart, curve } from "./chart.js";
import { documentation, h, number, put } from "./dom.js";
import { showLedger } from "./ledger.js";
import { about, Parameters, sideBySide } from "./parameters.js";
import { correlations, power } from "./tables.js";

export class LearnSection {
  constructor(page, place) {
    this.page = page;
    this.head = h("div", { class: "row" }); this.verdict = h("p", { class: "verdict" });
    this.ledger = h("div"); this.ranks = h("div"); this.more = h("div"); this.about = h("div"); this.beside = h("div"); this.shared = h("div");
    const values = h("section", {}, h("h2", {}, "Parameters"));
    this.sketch = h("div", { class: "plot" }); this.sketched = h("p", { class: "faint" });
    place.append(this.head, this.about, this.verdict, this.beside,
      h("div", { class: "two wide" },
        h("section", {}, h("h2", {}, "Error by step"), this.ledger),
        h("section", {}, h("h2", {}, "Predicted contribution of the selected effect"), this.sketched, this.sketch)),
      h("section", {}, h("h2", {}, "What could be missing"), this.ranks),
      values, this.shared, this.more);
    this.values = new Parameters(page, values);
  }

  update(before) {
    const { state } = this.page, node = this.page.model;
    const now = JSON.stringify([state.current, state.compared, state.nodes.map((n) => [n.name, n.note]),
      state.law, state.rig, state.runs.length, Boolean(state.job), node?.records, Boolean(node?.trials)]);
    if (!before || now !== this.was) { this.was = now; this.show(); }
  }

  looked() { showCandidates(this.page, this.ranks); this.draw(); }

  show() {
    const { page } = this, { state } = page, node = page.model, busy = Boolean(state.job) || !state.runs.length;
    this.lead();
    const law = h("select", { class: "law", "aria-label": "law", "data-key": "law", disabled: busy, onchange: (e) => page.do("law", { law: e.target.value }) },
      state.laws.map(({ name, summary, refused }) =>
        h("option", { value: name, selected: name === state.law, disabled: Boolean(refused), title: refused ?? summary }, `${name === "auto" ? "automatic" : name}: ${refused ?? summary}`)));
    put(this.head, h("label", {}, "Law ", law),
      documentation(state.law === "auto" ? "laws.md" : `laws.md#${state.law}`, "Documentation of the law",
        { "data-key": "docs-law", title: "equations, parameters and sources" }),
      h("button", { "data-key": "fit-law", disabled: busy, title: state.law === "auto" ? "the first law to try for this rig; Diagnose selects the law" : "",
        onclick: () => page.do("fit", { effects: [], parent: null }) }, `Fit ${state.fit_law} without effects`),
      h("button", { class: "main", "data-key": "diagnose", disabled: busy, title: "diagnose with the selected law", onclick: () => page.do("diagnose", { parent: node?.id ?? null }) }, "Diagnose"));
    put(this.verdict, node?.diagnosis ? [h("b", {}, "Verdict on the base law, before effects were added: "), node.diagnosis.sentence] : "");
    showLedger(page, this.ledger); showCandidates(page, this.ranks);
    about(page, this.about); sideBySide(page, this.beside);
    this.values.show(this.model !== node?.id); this.model = node?.id;
    put(this.shared, node?.correlations ? correlations(node.correlations) : null);
    put(this.more, node?.diagnosis ? this.diagnosis_details(node.diagnosis) : null,
      node?.power?.length ? h("details", { open: Boolean(node.diagnosis) }, h("summary", { "data-key": "power" }, "Detection limits of these runs (80 % power)"), power(node.power)) : null,
      node?.diagnosis ? h("details", {}, h("summary", { "data-key": "words" }, "Summary"), h("pre", {}, node.diagnosis.summary)) : null);
    this.draw();
  }

  // Without a choice of the user's the best of the ranking is drawn.
  lead() {
    const { page } = this, node = page.model, tried = node?.trials ?? [];
    if (node?.effects.includes(page.effect)) page.effect = null;
    if (page.effect === null || !tried.some((t) => t.effect === page.effect)) {
      page.effect = ranked(tried)[0]?.effect ?? null;
    }
  }

  async draw() {
    const { page } = this, node = page.model, ask = Symbol(); this.latest = ask;
    if (!node?.records || !page.effect || !page.run || node.effects.includes(page.effect)) {
      put(this.sketch); this.chart = null;
      put(this.sketched, "Press Show on an effect to draw it over the residual.");
      return;
    }
    const asked = { run: page.run, model: node.id, effect: page.effect, from_s: page.span[0], to_s: page.span[1], pixels: 800 };
    let found;
    try { found = await get("signature", asked); } catch (error) {
      if (this.latest === ask) { put(this.sketch); this.chart = null; put(this.sketched, `${page.effect}: ${error.message}`); }
      return;
    }
    if (this.latest !== ask) return;
    this.chart ??= new Chart(this.sketch, { unit: page.units.force, height: 190,
      curves: [curve("residual_n", "record minus model", "measured"), curve("contribution", "predicted contribution", "beside", { width: 1.8 })],
      zoomed: (from, to) => page.look({ span: [from, to] }) });
    this.chart.show(found);
    put(this.sketched, `${page.effect} on ${page.run}: drawn at ${number(found.times_usual, 2)} times its typical strength, where it fits the residual best. Select another run in the list of runs.`);
  }

  diagnosis_details(d) {
    return [
      d.residual_structure.length ? h("section", {}, h("h2", {}, "Residual structure"), h("ul", {}, d.residual_structure.map((r) => h("li", {}, `${r.axis}: ${r.where}`)))) : null,
      d.next_experiment ? h("section", {}, h("h2", {}, "Next experiment"), h("p", {}, d.next_experiment), d.next_run ? h("p", {},
        h("button", { "data-key": "next-run", onclick: () => this.page.download("next_run", "next_run.csv") }, "Download the motion (next_run.csv)")) : null) : null,
    ];
  }
}
