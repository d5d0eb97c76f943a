// Candidates by evidence, each with the strength from which these runs would detect it.
import { h, number, put } from "./dom.js";

const OUTCOME = { added: "largest evidence", ties: "ties", rejected: "rejected", negligible: "negligible", "no gain": "no gain", confounder: "confounder", replaced: "replaced" };

export function showRanking(page, place) {
  const { state } = page, node = page.model, busy = Boolean(state.job) || !state.runs.length || (state.law === "auto" && !node);
  const tried = new Map((node?.trials ?? []).map((t) => [t.effect, t])), strength = new Map((node?.power ?? []).map((p) => [p.effect, p]));
  const order = [...tried.values()].sort((a, b) => b.evidence - a.evidence);
  // The nearest few are shown even where none of them is anything.
  const shown = order.filter((t, i) => t.outcome !== "no gain" || i < 3), others = order.filter((t) => !shown.includes(t));
  const rest = state.effects.filter((e) => !tried.has(e.name) && !(node?.effects ?? []).includes(e.name));
  const refused = rest.filter((e) => e.refused), open = rest.filter((e) => !e.refused);
  const parent = node?.id ?? null, add = (name) => h("button", { "data-key": `add-${name}`, disabled: busy, title: "add and fit",
    onclick: () => page.do("fit", { effects: [...(node?.effects ?? []), name], parent }) }, "Add");
  const sketch = (name) => h("button", { "data-key": `sketch-${name}`, title: "draw its predicted contribution over the residual", disabled: !node,
    "aria-pressed": String(page.effect === name), onclick: () => page.look({ effect: name }) }, name);
  const row = (name, t, why) => {
    const p = strength.get(name);
    return [h("tr", { class: page.effect === name ? "now first" : "first" }, h("td", { rowspan: 2 }, add(name)), h("td", {}, sketch(name)),
      h("td", { class: "n" }, t ? (t.evidence > 0 ? number(t.evidence) : "none") : ""), h("td", { class: "n" }, t ? number(t.rms) : ""),
      // What gains already needs no promise; and beside a model that lacks it, its strength is overstated.
      h("td", {}, t?.evidence > 0 ? "detected" : p ? [p.found, p.hidden ? h("span", { class: "faint", title: "not detectable at its typical strength" }, " (not detectable)") : null] : "")),
    h("tr", { class: page.effect === name ? "now" : "" }, h("td", { colspan: 4, class: "faint" }, why,
      p?.like && !(t?.evidence > 0) ? ` Confounded with ${p.like}.` : ""))];
  };
  const table = (rows) => h("table", { class: "pairs" }, h("thead", {}, h("tr", {}, h("th", {}), h("th", {}, "effect"), h("th", { class: "n" }, "evidence"),
    h("th", { class: "n" }, `RMS (${page.units.force})`), h("th", { title: "strength that is detected with a power of 80 %" }, "detectable from"))), h("tbody", {}, rows));
  const first = !node ? h("p", { class: "faint" }, "Fit the base law first; then the candidates are ranked here.")
    : node.trials === null ? h("p", { class: "faint" }, "Testing the candidates…")
      : node.trials.length === 0 ? h("p", { class: "faint" }, "The candidates of this model were not tested.")
        : [table(shown.flatMap((t) => row(t.effect, t, `${OUTCOME[t.outcome]}: ${t.reason}.`))), strength.size ? h("p", { class: "faint" },
          "Detectable from: strength that is detected with a power of 80 % at the present residual. Not detectable: the typical strength is smaller.") : null];
  const more = [...others.map((t) => row(t.effect, t, `${OUTCOME[t.outcome]}: ${t.reason}.`)), ...open.map((e) => row(e.name, null, e.summary))];
  put(place, first,
    more.length ? h("details", {}, h("summary", { "data-key": "others" }, `other effects (${more.length})`), table(more.flat())) : null,
    refused.length ? h("details", {}, h("summary", { "data-key": "refused" }, `not applicable (${refused.length})`), h("ul", {}, [...Map.groupBy(refused, (e) => e.refused)].map(([why, those]) =>
      h("li", {}, `${those.map((e) => e.name).join(", ")}: ${node?.law ?? state.law} ${why}`)))) : null);
}
