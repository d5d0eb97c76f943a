// Residual by regime: RMS in each regime of the law as a multiple of the noise.
import { behind, h, number, put, s, times } from "./dom.js";

export function showRegimes(page, place) {
  const node = page.model, rows = node?.regimes ?? [], unit = page.units.force;
  if (!rows.length) { put(place); return; }
  const noise = node.noise_rms || 1, most = Math.max(1.5, ...rows.map((r) => r.rms / noise)), x = (v) => 190 + 200 * v / most;
  const picture = s("svg", { viewBox: `0 0 470 ${rows.length * 26 + 4}`, role: "img", "aria-label": "RMS residual by regime, times the noise" });
  rows.forEach((r, i) => picture.append(
    s("text", { x: 184, y: 26 * i + 17, "text-anchor": "end" }, r.name),
    s("rect", { class: "bar", x: 190, y: 26 * i + 4, width: Math.max(x(r.rms / noise) - 190, 1), height: 17 }),
    s("text", { x: behind(x(r.rms / noise), x(1)), y: 26 * i + 17 }, `${times(r.rms / noise)} `)));
  picture.append(s("line", { class: "floor", x1: x(1), x2: x(1), y1: 0, y2: rows.length * 26 }));
  put(place, h("h2", {}, "Residual by regime, times the noise"), picture,
    h("p", { class: "faint" }, rows.map((r) => `${r.name}: mean ${number(r.mean)} ${unit}, ${r.samples} samples`).join("; "), "."));
}
