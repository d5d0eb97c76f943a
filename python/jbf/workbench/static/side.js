// The side: runs with what their recordings did, and the tree of models.
import { h, key, number, put, times } from "./dom.js";

export const TINTS = ["beside", "third", "fourth"];

export function showRuns(page, place) {
  const { runs } = page.state;
  put(place, runs.map((run) =>
    h("div", { class: `item${run.name === page.run ? " now" : ""}` },
      h("input", { type: "checkbox", checked: !run.excluded, "aria-label": `use ${run.name} in fits`, title: "use it in fits", "data-key": `use-${run.name}`,
        onchange: (event) => page.do("leave_out", { run: run.name, out: !event.target.checked }) }),
      h("button", { class: "pick", "data-key": `run-${run.name}`, "aria-pressed": String(run.name === page.run), onclick: () => page.look({ run: run.name, span: [null, null] }) },
        run.name, h("br"), h("small", {}, runNote(page, run))))));
}

function runNote(page, run) {
  const parts = [`${number(run.duration_s)} s, ${run.samples} samples`];
  const own = page.model?.runs.find((r) => r.name === run.name);
  if (own) parts.push(`RMS ${number(own.rms)} ${page.units.force}`);
  if (run.excluded) parts.push("excluded");
  if (run.trim) parts.push("trimmed");
  if (run.findings === null) parts.push("checking…");
  else if (run.findings.length) parts.push([...new Set(run.findings.map((f) => f.kind.replaceAll("_", " ")))].join(", "));
  const chosen = page.brushed?.by_run[run.name];
  if (chosen) parts.push(`${chosen.samples} selected`);
  return parts.join(" · ");
}

export function showModels(page, place) {
  const { nodes, current, compared } = page.state;
  if (nodes.length === 0) { put(place, h("p", { class: "faint" }, "None yet.")); return; }
  const rows = [];
  const walk = (parent, depth) => {
    for (const node of nodes.filter((n) => n.parent === parent)) {
      const outside = node.held_out_rms === null || node.held_out_rms === undefined ? "" : `; held-out RMS ${number(node.held_out_rms)} ${page.units.force}`;
      const at = compared.indexOf(node.id), ratio = node.banner.times_noise;
      const item = h("div", { class: `item${node.id === current ? " now" : ""}` },
        h("button", { class: "pick", "data-key": `model-${node.id}`, "aria-pressed": String(node.id === current), title: node.note ?? "", onclick: () => page.do("show", { model: node.id }) },
          node.name || node.words, ratio === null ? null : ` (${times(ratio)})`, h("br"), h("small", {}, `RMS ${number(node.rms)} ${page.units.force}${outside}`)),
        h("label", { title: "draw together with the current model" },
          h("input", { type: "checkbox", checked: at >= 0, disabled: node.id === current || (at < 0 && compared.length >= TINTS.length), "data-key": `beside-${node.id}`,
            "aria-label": `compare with ${node.name || node.words}`,
            onchange: (event) => page.do("compare_with", { model: node.id, on: event.target.checked }) }),
          h("small", {}, at >= 0 ? key(TINTS[at], "compare") : "compare")));
      item.style.marginLeft = `${12 * Math.min(depth, 5)}px`;
      rows.push(item);
      walk(node.id, depth + 1);
    }
  };
  walk(null, 0);
  put(place, h("div", { class: "row" },
    h("button", { "data-key": "undo", disabled: current === null, title: "return to the parent model (key z)", onclick: () => page.do("undo") }, "Undo"),
    h("button", { "data-key": "redo", disabled: !page.state.can_redo, title: "return to the model that was undone (key y)", onclick: () => page.do("redo") }, "Redo"),
    h("button", { "data-key": "records", disabled: current === null, title: "show the records without a model", onclick: () => page.do("show", { model: null }) }, "Data only")), rows,
  compared.length && page.name !== "Explore" ? h("div", { class: "row" }, h("button", { class: "main", "data-key": "plot-compared", onclick: () => page.enter("Explore") }, "Plot the compared models")) : null);
}
