// The side: runs with what their recordings did, and the tree of models.
import { h, number, put } from "./dom.js";

export function showRuns(page, place) {
  const { runs } = page.state;
  put(place, runs.length === 0 ? h("p", { class: "faint" }, "None yet: open some in room 1.") : runs.map((run) =>
    h("div", { class: `item${run.name === page.run ? " now" : ""}` },
      h("input", { type: "checkbox", checked: !run.excluded, "aria-label": `use ${run.name} in fits`, "data-key": `use-${run.name}`,
        onchange: (event) => page.do("leave_out", { run: run.name, out: !event.target.checked }) }),
      h("button", { "data-key": `run-${run.name}`, onclick: () => page.look({ run: run.name, span: [null, null] }) },
        run.name, h("br"), h("small", {}, said(run))))));
}

function said(run) {
  const parts = [`${number(run.duration_s)} s, ${run.samples} samples`];
  if (run.trim) parts.push("trimmed");
  if (run.findings === null) parts.push("looking…");
  else if (run.findings.length) parts.push([...new Set(run.findings.map((f) => f.kind.replaceAll("_", " ")))].join(", "));
  return parts.join(" · ");
}

export function showModels(page, place) {
  const { nodes, current, beside } = page.state;
  if (nodes.length === 0) { put(place, h("p", { class: "faint" }, "None yet: fit one in room 3.")); return; }
  const rows = [];
  const walk = (parent, depth) => {
    for (const node of nodes.filter((n) => n.parent === parent)) {
      rows.push(h("div", { class: `item${node.id === current ? " now" : ""}${node.id === beside ? " beside" : ""}` },
        h("button", { "data-key": `model-${node.id}`, onclick: () => page.do("show", { model: node.id }) },
          `${"· ".repeat(depth)}${node.words}`, h("br"),
          h("small", {}, `${number(node.rms_n)} ${page.units.force}; left out ${number(node.holdout_rms_n)}`)),
        h("label", { title: "draw beside the current model" },
          h("input", { type: "checkbox", checked: node.id === beside, "data-key": `beside-${node.id}`,
            "aria-label": `draw ${node.words} beside`,
            onchange: (event) => page.do("beside", { model: event.target.checked ? node.id : null }) }),
          h("small", {}, "beside"))));
      walk(node.id, depth + 1);
    }
  };
  walk(null, 0);
  put(place, h("div", { class: "row" },
    h("button", { "data-key": "undo", disabled: current === null, title: "key z", onclick: () => page.do("undo") }, "Undo"),
    h("button", { "data-key": "records", disabled: current === null, onclick: () => page.do("show", { model: null }) }, "Records alone")), rows);
}
