// Candidates by gain, one card each: shape, sentence, gain in times the noise, held-out agreement.
import { get } from "./api.js";
import { documentation, h, number, put, s, times } from "./dom.js";

const MOST = 6;
const OUTCOME = {
  added: ["good", "largest gain; held-out runs agree"], ties: ["warn", "fits as well as another candidate"],
  rejected: ["faint", "explains less than the best"], negligible: ["faint", "too small to matter"],
  "no gain": ["faint", "no more than chance"], confounder: ["warn", "not named"], replaced: ["faint", "replaced by another effect"],
};

const sentence = (words) => `${words.charAt(0).toUpperCase()}${words.slice(1)}.`;

// The candidate to add first, then the others by their evidence.
export const ranked = (trials) => [...trials].sort((a, b) => (b.outcome === "added") - (a.outcome === "added") || b.evidence - a.evidence);

export function showCandidates(page, place) {
  const { state } = page, node = page.model, busy = Boolean(state.job) || !state.runs.length;
  const tried = new Map((node?.trials ?? []).map((t) => [t.effect, t])), strength = new Map((node?.power ?? []).map((p) => [p.effect, p]));
  const order = ranked([...tried.values()]);
  // The nearest few are shown even if none of them gains anything.
  const shown = order.filter((t, i) => i < 3 || (i < MOST && t.outcome !== "no gain")), others = order.filter((t) => !shown.includes(t));
  const rest = state.effects.filter((e) => !tried.has(e.name) && !(node?.effects ?? []).includes(e.name));
  const refused = rest.filter((e) => e.refused), open = rest.filter((e) => !e.refused);
  const summary = new Map(state.effects.map((e) => [e.name, e.summary]));
  const parent = node?.id ?? null;
  const card = (name, t) => {
    const p = strength.get(name), [tint, words] = t?.unconfirmed ? ["warn", "held-out runs disagree"] : OUTCOME[t?.outcome] ?? [];
    return h("section", { class: `card${page.effect === name ? " now" : ""}`, "aria-label": name, "data-effect": name },
      h("div", { class: "top" }, h("h3", {}, name), h("span", { class: "shape" })),
      h("p", {}, sentence(summary.get(name) ?? "")),
      t ? h("p", {}, h("span", { class: "gain" }, node.noise_rms > 0
        ? `${times(node.rms / node.noise_rms)} → ${times(t.rms / node.noise_rms)} the noise`
        : `${number(node.rms)} → ${number(t.rms)} ${page.units.force}`), " ",
        h("span", { class: `tag ${tint}` }, words)) : null,
      t ? h("p", { class: "faint" }, sentence(t.reason)) : null,
      p && !(t?.evidence > 0) ? h("p", { class: "faint" },
        `Detectable in these runs from ${p.detectable}${p.meaning ? ` (${p.meaning})` : ""}${p.hidden ? ", more than its typical size" : ""}.${p.confounded_with ? ` Confounded with ${p.confounded_with}.` : ""}`) : null,
      h("div", { class: "choices" },
        h("button", { class: t?.outcome === "added" ? "main" : "", "data-key": `add-${name}`, disabled: busy, "aria-label": `add ${name}`,
          onclick: () => page.do("fit", { effects: [...(node?.effects ?? []), name], parent }) }, "Add"),
        h("button", { "data-key": `sketch-${name}`, disabled: !node, "aria-pressed": String(page.effect === name), "aria-label": `show ${name}`, onclick: () => page.look({ effect: name }) }, "Show"),
        h("button", { class: "quiet", "data-key": `about-${name}`, "aria-label": `about ${name}`, onclick: () => about(page, name) }, "Equation and limits"),
        documentation(`effects/${name}.md`, "Documentation", { "data-key": `docs-${name}`, "aria-label": `documentation of ${name}` })));
  };
  const cards = (items) => h("div", { class: "cards" }, items);
  const first = !node ? h("p", { class: "faint" }, "Fit the base law first; then the candidates are ranked here.")
    : node.trials === null ? h("p", { class: "faint" }, "Testing the candidates…")
      : node.trials.length === 0 ? h("p", { class: "faint" }, "The candidates of this model were not tested.")
        : [h("p", { class: "faint" }, "Evidence: twice the gain in log-likelihood, less the acceptance threshold of the added parameters."),
          cards(shown.map((t) => card(t.effect, t)))];
  const more = [...others.map((t) => card(t.effect, t)), ...open.map((e) => card(e.name, null))];
  put(place, first,
    more.length ? h("details", {}, h("summary", { "data-key": "others" }, `other effects (${more.length})`), cards(more)) : null,
    refused.length ? h("details", {}, h("summary", { "data-key": "refused" }, `not applicable (${refused.length})`), h("ul", {}, [...Map.groupBy(refused, (e) => e.refused)].map(([why, those]) =>
      h("li", {}, `${those.map((e) => e.name).join(", ")}: ${node?.law ?? state.fit_law} ${why}`)))) : null);
  shapes(place);
}

// The shape of each effect as a small picture: friction along time without it (grey) and with it.
let known = null;
async function shapes(place) {
  known ??= fetch("/static/effect_shapes.json").then((answer) => answer.json());
  const found = await known;
  for (const card of place.querySelectorAll("[data-effect]")) {
    const curves = found[card.dataset.effect];
    if (!curves) continue;
    const points = (values) => values.map((v, i) => `${(1 + 90 * i / (values.length - 1)).toFixed(1)},${(21 - 19 * v).toFixed(1)}`).join(" ");
    const line = (values, stroke) => s("polyline", { points: points(values), fill: "none", stroke, "stroke-width": 1.4 });
    card.querySelector(".shape").replaceChildren(s("svg", { class: "sketch", viewBox: "0 0 92 42", role: "img", "aria-label": `friction along time without and with ${card.dataset.effect}` },
      line(curves[1], "var(--beside)"), line(curves[0], "var(--measured)")));
  }
}

async function about(page, name) {
  const found = await page.ask(() => get("effect", { name }));
  if (!found) return;
  const dialog = h("dialog", { "aria-label": name, onclose: () => dialog.remove() }, h("pre", {}, found.text),
    h("form", { method: "dialog" }, h("button", { class: "main", "data-key": "close-about" }, "Close")));
  document.body.append(dialog);
  dialog.showModal();
}
