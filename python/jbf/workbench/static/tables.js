// Tables of a model: parameters with intervals, correlations, power.
import { colour, h, number } from "./dom.js";

const head = (words) => h("thead", {}, h("tr", {}, words.map((w, i) => h("th", { class: i ? "n" : "" }, w))));

export function parameters(node) {
  const rows = Object.entries(node.parameters).map(([name, p]) => {
    const held = p.held || p.stderr === null || p.stderr === undefined;
    const half = 1.96 * p.stderr;
    return h("tr", {}, h("td", {}, name), h("td", { class: "n" }, `${number(p.value, 4)} ${p.unit ?? ""}`),
      h("td", { class: "n" }, held ? (p.note || "held") : `${number(p.value - half, 4)} to ${number(p.value + half, 4)}`));
  });
  return h("table", {}, head(["parameter", "value", "95 % interval"]), h("tbody", {}, rows));
}

export function correlations({ names, matrix }) {
  if (names.length < 2) return null;
  return h("details", {}, h("summary", {}, "Correlations of the estimates"), h("table", {},
    h("thead", {}, h("tr", {}, h("th", {}), names.map((n) => h("th", { class: "n" }, n)))),
    h("tbody", {}, matrix.map((row, i) => h("tr", {}, h("th", {}, names[i]), row.map((v) => {
      const cell = h("td", { class: "n" }, v.toFixed(2));
      if (Math.abs(v) > 0.95 && v < 0.9999) { cell.style.color = colour("bad"); cell.style.fontWeight = "700"; }
      return cell;
    }))))));
}

export function power(rows) {
  const at = (value, unit) => (value === null ? "never" : `${number(value)} ${unit}`);
  return h("table", {}, head(["effect (its strength)", "found, 80 %", "found, 95 %", "named alone, 80 %"]),
    h("tbody", {}, rows.map((p) => h("tr", {}, h("td", {}, `${p.effect} (${p.parameter})`),
      h("td", { class: "n" }, p.always ? "always" : at(p.found_80, p.unit)), h("td", { class: "n" }, p.always ? "always" : at(p.found_95, p.unit)),
      h("td", { class: "n" }, at(p.alone_80, p.unit))))));
}
