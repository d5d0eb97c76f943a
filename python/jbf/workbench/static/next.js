// What to do next, in a line, with the button that does it or leads there.
import { h, put } from "./dom.js";

export function showNext(page, place) {
  const found = nextStep(page);
  put(place, found ? [h("b", {}, "Next: "), found.words, " ", (found.buttons ?? []).map(([key, words, act]) =>
    h("button", { class: "main", "data-key": `next-${key}`, onclick: act }, words))] : []);
}

function nextStep(page) {
  const { state } = page, node = page.model, here = page.name;
  const go = (name, words) => [name.toLowerCase(), words, () => page.enter(name)];
  if (state.job) return { words: state.job.words.startsWith("diagnosis") || !node ? "wait; Cancel keeps the best so far." : "what else could be missing is being tried; look on meanwhile.", buttons: here === "See" || !node ? [] : [go("See", "2 See")] };
  if (!state.runs.length) {
    if (here !== "Data") return { words: "there is nothing to see yet.", buttons: [go("Data", "1 Data: open some runs")] };
    return page.importing ? { words: "check columns and units, then Import." } : { words: "open the demo's data, or bring a recording of your own: a CSV, Excel, MAT, MDF4, TDMS … file with time, a motion and a friction force, torque or current." };
  }
  const diagnose = ["diagnose", "Diagnose", () => { page.enter("Learn"); page.do("diagnose", { parent: node?.id ?? null }); }];
  if (!node) {
    if (here === "Data") return page.importing ? { words: "check columns and units, then Import." } : { words: "look at each run and trim what is not to be used; then let jbf find what the friction is made of, or go step by step in room 3.", buttons: [diagnose, go("Learn", "3 Learn")] };
    return { words: "let jbf decide, or fit a law alone and add what is missing yourself.", buttons: here === "Learn" ? [] : [diagnose, go("Learn", "3 Learn")] };
  }
  if (node.diagnosis) {
    if (here === "Keep") return null;
    return { words: here === "See" ? "keep the model." : "see where it still fails, or keep the model.", buttons: here === "See" ? [go("Keep", "4 Keep")] : [go("See", "2 See"), go("Keep", "4 Keep")] };
  }
  const best = (node.trials ?? []).find((t) => t.outcome === "added");
  if (here === "See") return best ? { words: `${node.failures.length ? "click a failure to see where it lies; then " : ""}add what is missing: ${best.effect} leads.`, buttons: [go("Learn", "3 Learn")] } : { words: "nothing else earns a place: keep the model.", buttons: [go("Keep", "4 Keep")] };
  if (here === "Learn") return best ? { words: `${best.effect} explains most of what is left: add it, and watch the error fall.` } : { words: node.trials ? "nothing else earns a place: keep the model." : "see where it fails.", buttons: [go(node.trials ? "Keep" : "See", node.trials ? "4 Keep" : "2 See")] };
  if (here === "Data") return { words: "see where the model fails.", buttons: [go("See", "2 See")] };
  return null;
}
