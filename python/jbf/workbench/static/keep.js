// Section 4: the session, the model, its report, constants for firmware, and the equivalent commands.
import { h, put } from "./dom.js";

const THINGS = [
  ["session", "Session (workbench.json)", "all rigs with their models and trims; also saved when the program ends; jbf workbench in this folder restores it", null],
  ["bundle", "Session as one file (session.zip)", "the open rig with its runs and models; drop it on the page of any folder", "session.zip"],
  ["model", "Model (model.toml)", "for jbf predict, compare, export", "model.toml"],
  ["report", "Report (report.html)", "one page with pictures", "report.html"],
  ["rust", "Constants in Rust (model.rs)", "for a controller with jbf-core", "model.rs"],
  ["c", "Constants in C (model.h)", "for a controller with jbf-c", "model.h"],
  ["next_run", "Motion of the next run (next_run.csv)", "reference for the rig", "next_run.csv"],
  ["trimmed", "Trimmed runs (trimmed/)", "CSV files, without excluded runs", null],
];

export class KeepSection {
  constructor(page, place) {
    this.page = page; this.place = place;
    this.list = h("div"); this.words = h("p", { role: "status" }); this.same = h("div");
    place.append(h("h2", {}, "Export"), h("p", { class: "faint" }, "Of the selected model."), this.list, this.words, this.same);
  }

  update() {
    const { page } = this, node = page.model;
    const there = (what) => (["session", "bundle", "trimmed"].includes(what) ? page.state.runs.length > 0
      : node && (what !== "next_run" || node.diagnosis?.next_run));
    put(this.list, h("div", { class: "scroll" }, h("table", { class: "things" }, h("tbody", {}, THINGS.map(([what, title, why, file]) => h("tr", {},
      h("td", {}, what === "bundle" ? null : h("button", { "data-key": `keep-${what}`, "aria-label": `save ${title}`, disabled: !there(what), onclick: () => this.keep(what) }, "Save in the folder")),
      h("td", {}, file ? h("button", { "data-key": `get-${what}`, "aria-label": `download ${title}`, disabled: !there(what), onclick: () => this.get(what, file) }, "Download") : null),
      h("td", {}, title), h("td", { class: "faint" }, why)))))));
    put(this.same, page.state.command ? [h("h2", {}, node ? "Equivalent commands" : "Commands"), this.copied("command", page.state.command),
      h("h2", {}, node ? "Equivalent Python code" : "Python code"), this.copied("python", page.state.python)] : null);
  }

  looked() {}

  copied(name, text) {
    const copy = h("button", { "data-key": `copy-${name}`, onclick: async () => { await navigator.clipboard.writeText(text); copy.textContent = "Copied"; } }, "Copy");
    return h("div", {}, h("pre", {}, text), copy);
  }

  async keep(what) {
    put(this.words, "…");
    const found = await this.page.do("keep", { what });
    put(this.words, found ? `Written: ${found.written.join(", ")} in ${this.page.state.folder}${found.replaced.length ? ` (replaced ${found.replaced.join(", ")})` : ""}` : "");
  }

  get(what, file) { return this.page.download(what, file); }
}
