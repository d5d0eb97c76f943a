// Tables of a model: correlations, power.
import { colour, h } from "./dom.js";

const head = (words) => h("thead", {}, h("tr", {}, words.map((w, i) => h("th", { class: i ? "n" : "" }, w))));

// Shaded by their size; what two parameters share almost wholly stands out.
export function correlations({ names, matrix }) {
  if (names.length < 2) return h("div");
  const short = names.map((n) => n.split(".").at(-1));
  return h("div", { class: "scroll" }, h("table", { class: "matrix" }, h("caption", {}, "Correlations of the estimates"),
    h("thead", {}, h("tr", {}, h("th", {}), short.map((n, i) => h("th", { class: "n", title: names[i] }, n)))),
    h("tbody", {}, matrix.map((row, i) => h("tr", {}, h("th", { title: names[i] }, short[i]), row.map((v, k) => {
      const cell = h("td", { class: "n" }, k > i ? "" : v.toFixed(2));
      if (k < i) cell.style.background = `color-mix(in srgb, ${colour(v > 0 ? "beside" : "model")} ${Math.round(45 * Math.abs(v))}%, transparent)`;
      if (k < i && Math.abs(v) > 0.95) cell.style.fontWeight = "700";
      return cell;
    }))))));
}

export function power(rows) {
  return h("div", { class: "scroll" }, h("table", {}, head(["effect", "detectable from", "share of friction", "distinguishable from", "confounded with"]),
    h("tbody", {}, rows.map((p) => h("tr", {}, h("td", {}, p.effect), h("td", { class: "n" }, p.detectable, p.meaning ? [h("br"), h("small", {}, p.meaning)] : null),
      [p.share, p.distinguishable, p.confounded_with].map((words) => h("td", { class: "n" }, words)))))));
}
