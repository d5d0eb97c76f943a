// What could be missing: every effect that was tried, by its evidence, with the strength that these runs would show.
import { h, number, put } from "./dom.js";

const OUTCOME = { added: "leads", ties: "ties", rejected: "rejected", negligible: "negligible", "no gain": "no gain", confounder: "confounder", replaced: "replaced" };

export function showRanking(page, place) {
  const { state } = page, node = page.model, busy = Boolean(state.job) || !state.runs.length || (state.law === "auto" && !node);
  const tried = new Map((node?.trials ?? []).map((t) => [t.effect, t])), strength = new Map((node?.power ?? []).map((p) => [p.effect, p]));
  const order = [...tried.values()].sort((a, b) => b.evidence - a.evidence);
  // The nearest few are shown even where none of them is anything.
  const shown = order.filter((t, i) => t.outcome !== "no gain" || i < 3), others = order.filter((t) => !shown.includes(t));
  const rest = state.effects.filter((e) => !tried.has(e.name) && !(node?.effects ?? []).includes(e.name));
  const refused = rest.filter((e) => e.refused), open = rest.filter((e) => !e.refused);
  const parent = node?.id ?? null, add = (name) => h("button", { "data-key": `add-${name}`, disabled: busy, title: "add it and fit",
    onclick: () => page.do("fit", { effects: [...(node?.effects ?? []), name], parent }) }, "Add");
  const sketch = (name) => h("button", { "data-key": `sketch-${name}`, title: "draw what it would add over the residual", disabled: !node,
    "aria-pressed": String(page.effect === name), onclick: () => page.look({ effect: name }) }, name);
  const row = (name, t, why) => {
    const p = strength.get(name);
    return [h("tr", { class: page.effect === name ? "now first" : "first" }, h("td", { rowspan: 2 }, add(name)), h("td", {}, sketch(name)),
      h("td", { class: "n" }, t ? (t.evidence > 0 ? number(t.evidence) : "none") : ""), h("td", { class: "n" }, t ? number(t.rms) : ""),
      // What gains already needs no promise; and beside a model that lacks it, its strength is overstated.
      h("td", {}, t?.evidence > 0 ? "gains already" : p ? [p.found, p.hidden ? h("span", { class: "faint", title: "at its usual strength it could be there unseen" }, " (could hide)") : null] : "")),
    h("tr", { class: page.effect === name ? "now" : "" }, h("td", { colspan: 4, class: "faint" }, why,
      p?.like && !(t?.evidence > 0) ? ` Not told apart from ${p.like}.` : ""))];
  };
  const table = (rows) => h("table", { class: "pairs" }, h("thead", {}, h("tr", {}, h("th", {}), h("th", {}, "effect"), h("th", { class: "n" }, "evidence"),
    h("th", { class: "n" }, `RMS (${page.units.force})`), h("th", { title: "found in 80 of 100 such campaigns, beside this model" }, "would show from"))), h("tbody", {}, rows));
  const first = !node ? h("p", { class: "faint" }, "Fit the law alone: then each effect is tried beside it, and ranked here.")
    : node.trials === null ? h("p", { class: "faint" }, "Each effect is being tried…")
      : node.trials.length === 0 ? h("p", { class: "faint" }, "The others were not tried beside this model.")
        : [table(shown.flatMap((t) => row(t.effect, t, `${OUTCOME[t.outcome]}: ${t.reason}.`))), strength.size ? h("p", { class: "faint" },
          "Would show from: its strength when 80 of 100 such campaigns find it beside this model, at the error that the model has now. Could hide: its usual strength is less.") : null];
  const more = [...others.map((t) => row(t.effect, t, `${OUTCOME[t.outcome]}: ${t.reason}.`)), ...open.map((e) => row(e.name, null, e.summary))];
  put(place, first,
    more.length ? h("details", {}, h("summary", { "data-key": "others" }, `every other effect (${more.length})`), table(more.flat())) : null,
    refused.length ? h("details", {}, h("summary", { "data-key": "refused" }, `what means nothing here (${refused.length})`), h("ul", {}, [...Map.groupBy(refused, (e) => e.refused)].map(([why, those]) =>
      h("li", {}, `${those.map((e) => e.name).join(", ")}: ${node?.law ?? state.law} ${why}`)))) : null);
}
