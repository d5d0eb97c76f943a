// Room 3: what is missing: candidates with their evidence, one click adds, the error falls.
import { get } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, key, number, put, s } from "./dom.js";
import { correlations, parameters, power } from "./tables.js";

const OUTCOME = { added: "leads", ties: "ties", rejected: "rejected", "no gain": "no gain", confounder: "confounder", replaced: "replaced" };

// What one model has that the one before it has not, and the other way round.
const newly = (now, before) => [...now.filter((e) => !before.includes(e)).map((e) => `+ ${e}`), ...before.filter((e) => !now.includes(e)).map((e) => `- ${e}`)].join(" ");

export class LearnRoom {
  constructor(page, place) {
    this.page = page;
    this.head = h("div", { class: "row" }); this.verdict = h("p", { class: "verdict" });
    this.ledger = h("div"); this.ranks = h("div"); this.values = h("div"); this.more = h("div");
    this.sketch = h("div", { class: "plot" }); this.sketched = h("p", { class: "faint" });
    place.append(this.head, this.verdict,
      h("div", { class: "two wide" }, h("section", {}, h("h2", {}, "The error falling"), this.ledger, this.sketched, this.sketch, h("h2", {}, "Parameters"), this.values),
        h("section", {}, h("h2", {}, "What could be missing"), this.ranks)), this.more);
  }

  told(before) {
    const { state } = this.page;
    const now = JSON.stringify([state.current, state.nodes.length, state.law, state.rig, Boolean(state.job), this.page.model?.record_names]);
    if (!before || now !== this.was) { this.was = now; this.show(); }
  }

  looked() { this.draw(); }

  show() {
    const { page } = this, { state } = page, node = page.model, busy = Boolean(state.job) || !state.runs.length;
    const law = h("select", { "aria-label": "law", "data-key": "law", disabled: busy, onchange: (e) => page.do("law", { law: e.target.value }) },
      state.laws.map((name) => h("option", { value: name, selected: name === state.law }, name)));
    put(this.head, h("label", {}, "Law ", law),
      h("button", { class: node ? "" : "main", "data-key": "fit-law", disabled: busy || state.law === "auto", onclick: () => page.do("fit", { effects: [], parent: null }) }, "Fit the law alone"),
      h("button", { class: "main", "data-key": "diagnose", disabled: busy, onclick: () => page.do("diagnose", { parent: node?.id ?? null }) }, "Diagnose: let jbf decide"),
      state.runs.length ? null : "Open some runs in room 1.");
    put(this.verdict, node?.diagnosis ? node.diagnosis.sentence : "");
    this.showLedger(); this.rank();
    put(this.values, node ? parameters(node, page.units) : h("p", { class: "faint" }, "None yet."));
    put(this.more, node?.diagnosis ? this.told_by_diagnosis(node.diagnosis) : null, node?.correlations ? correlations(node.correlations) : null);
    this.draw();
  }

  // Bars on a logarithmic scale from the noise up: each step can be seen, however small the last ones are.
  showLedger() {
    const { page } = this, node = page.model;
    const steps = node?.diagnosis ? node.diagnosis.steps : page.state.ledger;
    const line = steps.map((step, i) => ({ ...step, words: i ? newly(step.effects, steps[i - 1].effects) : newly(step.effects, []) || "the law alone" }));
    if (!line.length) { put(this.ledger, h("p", { class: "faint" }, "Fit the law alone, or diagnose.")); return; }
    const noise = line.at(-1).noise_n, values = line.flatMap((l) => [l.rms_n, l.holdout_rms_n]).filter((v) => v > 0);
    const low = Math.log(0.8 * Math.min(noise, ...values)), high = Math.log(1.05 * Math.max(noise, ...values));
    const x = (v) => 170 + 250 * (Math.log(v) - low) / (high - low);
    const picture = s("svg", { viewBox: `0 0 500 ${line.length * 40 + 26}`, role: "img", "aria-label": "error of each model" });
    line.forEach((l, i) => {
      const top = i * 40 + 4, unit = page.units.force;
      picture.append(s("text", { x: 164, y: top + 20, "text-anchor": "end" }, (l.words.length > 26 ? `…${l.words.slice(-25)}` : l.words)));
      for (const [k, value, name] of [[0, l.rms_n, "bar"], [1, l.holdout_rms_n, "bar out"]]) {
        if (!value) continue;
        picture.append(s("rect", { class: name, x: 170, y: top + 16 * k, width: Math.max(x(value) - 170, 1), height: 13 }),
          s("text", { x: x(value) + 5, y: top + 16 * k + 11 }, `${number(value)} ${unit}`));
      }
    });
    const foot = line.length * 40;
    picture.append(s("line", { class: "floor", x1: x(noise), x2: x(noise), y1: 0, y2: foot }), s("text", { x: x(noise), y: foot + 16, "text-anchor": "middle", class: "faint" }, `noise ${number(noise)}`));
    put(this.ledger, picture, h("p", { class: "faint" }, key("model", "in the fit"), key("beside", "on runs left out"), key("noise", "noise"), " (logarithmic)"));
  }

  rank() {
    const { page } = this, { state } = page, node = page.model, busy = Boolean(state.job) || state.law === "auto" && !node;
    const tried = new Map((node?.trials ?? []).map((t) => [t.effect, t]));
    const order = [...tried.values()].sort((a, b) => b.evidence - a.evidence);
    // The nearest few are shown even where none of them is anything.
    const shown = order.filter((t, i) => t.outcome !== "no gain" || i < 3), others = order.filter((t) => !shown.includes(t));
    const rest = state.effects.filter((e) => !tried.has(e.name) && !(node?.effects ?? []).includes(e.name));
    const refused = rest.filter((e) => e.refused), open = rest.filter((e) => !e.refused);
    const add = (name) => h("button", { "data-key": `add-${name}`, disabled: busy || !state.runs.length,
      onclick: () => page.do("fit", { effects: [...(node?.effects ?? []), name], parent: node?.id ?? null }) }, "Add");
    const row = (name, ...cells) => h("tr", { class: page.effect === name ? "now" : "" }, h("td", {}, add(name)),
      h("td", {}, h("button", { "data-key": `sketch-${name}`, title: "draw what it would add over the residual", disabled: !node, onclick: () => page.look({ effect: name }) }, name)), ...cells);
    put(this.ranks, h("table", {}, h("thead", {}, h("tr", {}, h("th", {}), h("th", {}, "effect"), h("th", { class: "n" }, "evidence"), h("th", { class: "n" }, `RMS (${page.units.force})`), h("th", {}, "why"))),
      h("tbody", {}, shown.map((t) =>
        row(t.effect, h("td", { class: "n" }, t.evidence > 0 ? number(t.evidence) : "none"), h("td", { class: "n" }, number(t.rms_n)), h("td", {}, `${OUTCOME[t.outcome]}: ${t.reason}`)))),
    ), h("details", {}, h("summary", {}, `every other effect (${others.length + open.length})`), h("table", {}, h("tbody", {},
      [...others.map((t) => ({ name: t.effect, summary: t.reason })), ...open].map((e) => row(e.name, h("td", {}, e.summary)))))),
    refused.length ? h("details", {}, h("summary", {}, `what means nothing here (${refused.length})`), h("ul", {}, [...Map.groupBy(refused, (e) => e.refused)].map(([why, those]) =>
      h("li", {}, `${those.map((e) => e.name).join(", ")}: ${state.law} ${why}`)))) : null);
  }

  async draw() {
    const { page } = this, node = page.model;
    if (!node || !page.effect || !page.run || node.effects.includes(page.effect)) { put(this.sketch); this.chart = null; put(this.sketched, node ? "Choose an effect: what it would add is drawn over the residual." : ""); return; }
    if (!this.chart) {
      this.chart = new Chart(this.sketch, { unit: page.units.force, height: 190, curves: [curve("residual_n", "record minus model", "measured"), curve("signature_n", "what it would add", "chosen", { width: 1.8 })],
        zoomed: (from, to) => page.look({ span: [from, to] }) });
    }
    try {
      const found = await get("signature", { run: page.run, model: node.id, effect: page.effect, from_s: page.span[0], to_s: page.span[1], pixels: 800 });
      this.chart.show(found);
      put(this.sketched, `${page.effect} on ${page.run}: nearest to the residual at ${number(found.times_usual, 2)} times its usual strength.`);
    } catch (error) { page.say(error.message); }
  }

  told_by_diagnosis(d) {
    return [
      d.unexplained.length ? h("section", {}, h("h2", {}, "What remains"), h("ul", {}, d.unexplained.map((r) => h("li", {}, `${r.axis}: ${r.where}`)))) : null,
      d.next_experiment ? h("section", {}, h("h2", {}, "The next experiment"), h("p", {}, d.next_experiment), d.next_run ? h("p", {}, "Its motion is in room 4.") : null) : null,
      d.power.length ? h("details", { open: true }, h("summary", {}, "What these runs would have shown"), power(d.power)) : null,
      h("details", {}, h("summary", {}, "In words"), h("pre", {}, d.summary)),
    ];
  }
}
