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
  if (state.job?.words.startsWith("comparing")) return { words: "the model is being compared with the runs." };
  if (state.job) return { words: state.job.words.startsWith("diagnosis") || !node ? "fitting; Cancel keeps the best model so far." : "further candidates are being tested; you can continue.", buttons: here === "Explore" || !node ? [] : [go("Explore", "2 Explore")] };
  if (!state.runs.length) {
    if (here !== "Data") return { words: "no data yet.", buttons: [go("Data", "1 Data: open runs")] };
    return page.importing ? { words: "check columns and units, then Import." } : { words: "open the demo data, or your own recording (CSV, Excel, MAT, MDF4, TDMS …) with time, motion and friction force, torque or current." };
  }
  const diagnose = ["diagnose", "Diagnose", () => { page.enter("Model"); page.do("diagnose", { parent: node?.id ?? null }); }];
  if (!node) {
    if (here === "Data") return page.importing ? { words: "check columns and units, then Import." } : { words: "check and trim each run; then diagnose automatically, or build the model manually in 3 Model.", buttons: [diagnose, go("Model", "3 Model")] };
    return { words: "diagnose automatically, or fit a base law and add effects manually.", buttons: here === "Model" ? [] : [diagnose, go("Model", "3 Model")] };
  }
  if (node.diagnosis) {
    if (here === "Export") return null;
    return { words: here === "Explore" ? "export the model." : "check the lack of fit, or export the model.", buttons: here === "Explore" ? [go("Export", "4 Export")] : [go("Explore", "2 Explore"), go("Export", "4 Export")] };
  }
  const best = (node.trials ?? []).find((t) => t.outcome === "added");
  if (here === "Explore") return best ? { words: `${node.failures.length ? "select a failure to mark it in the plots; then " : ""}add ${best.effect}, the candidate with the largest evidence.`, buttons: [go("Model", "3 Model")] } : { words: "no further effect is significant: export the model.", buttons: [go("Export", "4 Export")] };
  if (here === "Model") return best ? { words: `add ${best.effect}: it explains most of the residual.` } : { words: node.trials ? "no further effect is significant: export the model." : "check the lack of fit.", buttons: [go(node.trials ? "Export" : "Explore", node.trials ? "4 Export" : "2 Explore")] };
  if (here === "Data") return { words: "check the lack of fit.", buttons: [go("Explore", "2 Explore")] };
  return null;
}
