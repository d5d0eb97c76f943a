// Error by step as a multiple of the noise, on a linear scale: the length of a bar is the error.
import { behind, h, key, number, put, s, scale } from "./dom.js";

// What one model has that the one before it has not, and the other way round.
const newly = (now, before) => [...now.filter((e) => !before.includes(e)).map((e) => `+ ${e}`), ...before.filter((e) => !now.includes(e)).map((e) => `- ${e}`)].join(" ");

export function showLedger(page, place) {
  const node = page.model, steps = node?.diagnosis ? node.diagnosis.steps : page.state.ledger, unit = page.units.force;
  const line = steps.map((step, i) => ({ ...step, words: i ? newly(step.effects, steps[i - 1].effects) || step.changes || "refitted" : newly(step.effects, []) || "base law" }));
  if (!line.length) { put(place, h("p", { class: "faint" }, "No model yet: fit the base law, or diagnose.")); return; }
  const noise = line.at(-1).noise_rms, { one, words, title } = scale(noise, unit);
  const most = Math.max(noise ? 1 : 0, ...line.flatMap((l) => [l.rms, l.held_out_rms]).map((v) => (v ?? 0) / one));
  const x = (v) => 150 + 235 * v / one / (most || 1);
  const picture = s("svg", { viewBox: `0 0 470 ${line.length * 40 + 26}`, role: "img", "aria-label": "error of each model" });
  line.forEach((l, i) => {
    const top = i * 40 + 4;
    picture.append(s("text", { x: 144, y: top + 20, "text-anchor": "end" }, (l.words.length > 22 ? `…${l.words.slice(-21)}` : l.words)));
    for (const [k, value, name] of [[0, l.rms, "bar"], [1, l.held_out_rms, "bar out"]]) {
      if (!value) continue;
      picture.append(s("rect", { class: name, x: 150, y: top + 16 * k, width: Math.max(x(value) - 150, 1), height: 13 }),
        s("text", { x: behind(x(value), noise ? x(noise) : 0), y: top + 16 * k + 11 }, `${words(value / one)} `), s("title", {}, `${number(value)} ${unit}`));
    }
  });
  const foot = line.length * 40;
  if (noise) picture.append(s("line", { class: "floor", x1: x(noise), x2: x(noise), y1: 0, y2: foot }),
    s("text", { x: x(noise), y: foot + 16, "text-anchor": most > 4 ? "start" : "middle", class: "faint" }, `noise ${number(noise)} ${unit}`));
  put(place, picture, h("p", { class: "faint" }, key("model", "fit"), key("out", "held-out"), noise ? key("noise", "noise") : null, ` · bars: ${title}, from zero`));
}
