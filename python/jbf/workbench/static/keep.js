// Section 4: the session, the model, its report, constants for firmware, and the equivalent commands.
import { h, put } from "./dom.js";

const THINGS = [
  ["session", "Session (workbench.json)", "all rigs with their models and trims; also saved when the program ends; jbf workbench in this folder restores it", null],
  ["bundle", "Session as one file (session.zip)", "the open rig with its runs and models; drop it on the page of any folder", "session.zip"],
  ["model", "Model (model.toml)", "input of jbf predict, jbf compare and jbf export", "model.toml"],
  ["report", "Report (report.html)", "verdict, tables and plots on one page", "report.html"],
  ["rust", "Constants in Rust (model.rs)", "for a controller in Rust with the crate jbf-core", "model.rs"],
  ["c", "Constants in C (model.h)", "for a controller in C with the library jbf-c", "model.h"],
  ["next_run", "Motion of the next run (next_run.csv)", "set points to record next; proposed by a diagnosis", "next_run.csv"],
  ["trimmed", "Trimmed runs (trimmed/)", "one CSV file for each run that is not excluded", null],
];

export class KeepSection {
  constructor(page, place) {
    this.page = page; this.place = place;
    this.list = h("div"); this.words = h("p", { role: "status" }); this.same = h("div");
    place.append(h("h2", {}, "Export"), h("p", { class: "faint" }, "Files of the selected model, the runs and the session."), this.list, this.words, this.same);
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
