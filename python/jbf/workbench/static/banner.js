// The verdict in one number and one sentence, and the next step with the button that does it.
import { h, number as value, put, times } from "./dom.js";

const MARKS = { good: "✓", warn: "?", bad: "!" };

export function showBanner(page, place) {
  const { state } = page, node = page.model;
  if (!state.runs.length || page.importing) { delete place.dataset.kind; put(place); return; }
  const step = nextStep(page), number = node?.banner.times_noise ?? null;
  place.dataset.kind = node?.banner.kind ?? "none";
  put(place,
    !node ? null : h("div", { class: "number", "data-key": "times-noise" },
      `${MARKS[node.banner.kind]} ${number === null ? `${value(node.held_out_rms ?? node.rms)} ${page.units.force}` : times(number)}`,
      h("small", {}, number === null ? "noise unknown" : "the noise"), h("small", {}, node.banner.error === "fit" ? "error of the fit" : "held-out error")),
    h("div", { class: "words" }, h("b", {}, node ? node.banner.words : headline(state.job)),
      node?.banner.sizes.map((words) => h("p", {}, words)),
      step ? h("p", {}, `Next: ${step.words}`) : null),
    step?.buttons ? h("div", { class: "row tight" }, step.buttons.map(([key, words, act]) =>
      h("button", { class: "main", "data-key": `next-${key}`, onclick: act }, words))) : null);
}

const headline = (job) => (job?.kind === "diagnose" ? "Diagnosing these runs …" : "No model yet: is something missing in the friction of these runs?");

function nextStep(page) {
  const { state } = page, node = page.model, here = page.name;
  const go = (name, words) => [name.toLowerCase(), words, () => page.enter(name)];
  const diagnose = ["diagnose", "Diagnose", () => page.do("diagnose", { parent: node?.id ?? null })];
  if (state.job?.kind === "compare") return { words: "wait until the model is compared with the runs." };
  if (state.job) return { words: node ? "the candidates are being tested; you can continue." : "the fit is running; Cancel keeps the best model so far." };
  if (!node) return { words: "diagnose automatically, or fit a law and add effects in 3 Model.", buttons: [diagnose, ...(here === "Model" ? [] : [go("Model", "3 Model")])] };
  const best = (node.trials ?? []).find((t) => t.outcome === "added");
  const explore = here === "Explore" ? [] : [go("Explore", "2 Explore")];
  if (node.banner.stale) return { words: "diagnose the present selection, or fit a law to it in 3 Model.", buttons: [diagnose, ...(here === "Model" ? [] : [go("Model", "3 Model")])] };
  if (!node.diagnosis && best) return { words: `add ${best.effect}, the effect with the largest gain.`,
    buttons: [["add", `Add ${best.effect}`, () => { page.enter("Model"); page.do("fit", { effects: [...node.effects, best.effect], parent: node.id }); }], ...explore] };
  if (!node.diagnosis && node.banner.kind !== "good") return { words: "see where the model fails, or diagnose automatically.", buttons: [diagnose, ...explore] };
  return { words: node.banner.kind === "good" ? "export the model, or see how it fits the runs." : "see where the model fails, or export it.", buttons: [...explore, ...(here === "Export" ? [] : [go("Export", "4 Export")])] };
}
