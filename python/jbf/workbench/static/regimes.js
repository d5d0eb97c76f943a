// Residual by regime: RMS in each regime of the law as a multiple of the noise.
import { behind, h, number, put, s, scale } from "./dom.js";

export function showRegimes(page, place) {
  const node = page.model, rows = node?.regimes ?? [], unit = page.units.force;
  if (!rows.length) { put(place); return; }
  const { one, words, title } = scale(node.noise_rms, unit), known = node.noise_rms > 0;
  const most = Math.max(known ? 1.5 : 0, ...rows.map((r) => r.rms / one)), x = (v) => 190 + 200 * v / (most || 1);
  const picture = s("svg", { viewBox: `0 0 470 ${rows.length * 26 + 4}`, role: "img", "aria-label": `RMS residual by regime, ${title}` });
  rows.forEach((r, i) => picture.append(
    s("text", { x: 184, y: 26 * i + 17, "text-anchor": "end" }, r.name),
    s("rect", { class: "bar", x: 190, y: 26 * i + 4, width: Math.max(x(r.rms / one) - 190, 1), height: 17 }),
    s("text", { x: behind(x(r.rms / one), known ? x(1) : 0), y: 26 * i + 17 }, `${words(r.rms / one)} `)));
  if (known) picture.append(s("line", { class: "floor", x1: x(1), x2: x(1), y1: 0, y2: rows.length * 26 }));
  put(place, h("h2", {}, `Residual by regime, ${title}`), picture,
    h("p", { class: "faint" }, rows.map((r) => `${r.name}: mean ${number(r.mean)} ${unit}, ${r.samples} samples`).join("; "), "."));
}
