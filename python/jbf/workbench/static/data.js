// Room 1: what is in the folder, files from elsewhere, records as they were read, trims.
import { get, upload } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, number, put } from "./dom.js";

export class DataRoom {
  constructor(page, place) {
    this.page = page;
    this.files = h("div"); this.raw = h("div"); this.map = h("div");
    place.append(h("div", { class: "two" }, h("section", {}, h("h2", {}, "Files"), this.files), this.map), this.raw);
    this.list();
  }

  told(before) {
    const { state } = this.page;
    if (!before || JSON.stringify(before.runs) !== JSON.stringify(state.runs)) { this.list(); this.draw(); }
  }

  looked() { this.draw(); }

  async list() {
    let found;
    try { found = await get("files"); } catch (error) { this.page.say(error.message); return; }
    const open = (rig, runs) => this.page.do("open", { rig, runs }).then((ok) => ok && this.page.enter("Data"));
    const input = h("input", { type: "file", multiple: true, "aria-label": "choose files", onchange: (e) => this.take(e.target.files) });
    const drop = h("div", { class: "drop",
      ondragover: (e) => { e.preventDefault(); drop.classList.add("over"); },
      ondragleave: () => drop.classList.remove("over"),
      ondrop: (e) => { e.preventDefault(); drop.classList.remove("over"); this.take(e.dataTransfer.files); } },
    "Drop recordings here, or ", input);
    put(this.files,
      h("p", { class: "faint" }, this.page.state.folder),
      h("div", { class: "row" }, h("button", { class: this.page.state.runs.length ? "" : "main", "data-key": "demo",
        onclick: () => this.page.do("demo") }, "Open the demo's data")),
      found.campaigns.length ? h("h3", {}, "Rigs with runs beside them") : null,
      h("ul", { class: "plain" }, found.campaigns.map((c) => h("li", {},
        h("button", { "data-key": `open-${c.rig}`, onclick: () => open(c.rig, c.runs) }, "Open"), ` ${c.rig}, ${c.runs.length} runs`))),
      this.picker(found, open),
      this.recordings(found),
      found.more ? h("p", { class: "faint" }, "There are more files: name a smaller folder.") : null,
      drop);
  }

  // A rig and runs that do not lie together.
  picker(found, open) {
    if (!found.rigs.length || !found.csv.length) return null;
    const rig = h("select", { "aria-label": "rig" }, found.rigs.map((name) => h("option", { value: name }, name)));
    const runs = h("select", { multiple: true, size: 4, "aria-label": "runs" }, found.csv.map((name) => h("option", { value: name }, name)));
    return h("details", {}, h("summary", {}, "Choose a rig and runs"), h("div", { class: "row" }, rig, runs,
      h("button", { onclick: () => open(rig.value, [...runs.selectedOptions].map((o) => o.value)) }, "Open")));
  }

  // Files of another make: those that are ticked are imported by one map.
  recordings(found) {
    const names = [...found.other, ...found.csv.filter((f) => !found.campaigns.some((c) => c.runs.includes(f)))];
    if (!names.length) return null;
    this.picked = new Set([...(this.picked ?? [])].filter((name) => names.includes(name)));
    const go = h("button", { "data-key": "import-chosen", disabled: !this.picked.size, onclick: () => this.look([...this.picked]) }, "Import the ticked …");
    const tick = (name, on) => { this.picked[on ? "add" : "delete"](name); go.disabled = !this.picked.size; };
    return [h("h3", {}, "Recordings as a logger wrote them"), h("ul", { class: "plain" }, names.map((name) => h("li", {},
      h("label", {}, h("input", { type: "checkbox", "data-key": `pick-${name}`, checked: this.picked.has(name), onchange: (e) => tick(name, e.target.checked) }), ` ${name}`)))),
    h("div", { class: "row" }, go, h("span", { class: "faint" }, "one map for all: tick what has the same columns"))];
  }

  async take(files) {
    for (const file of files) {
      try { await upload(file); } catch (error) { this.page.say(error.message); return; }
    }
    const names = [...files].map((f) => f.name).filter((name) => !name.endsWith(".toml"));
    this.picked = new Set(names);
    await this.list();
    if (names.length) this.look(names);
  }

  // The map of recordings: columns and units, which can be changed until the numbers are right.
  async look(files) {
    const found = await this.page.do("look", { file: files[0] });
    if (!found) return;
    const text = h("textarea", { "aria-label": "map", spellcheck: "false", "data-key": "map" });
    text.value = found.map;
    const into = h("input", { value: found.into, "aria-label": "name of the campaign", "data-key": "into" });
    const shown = h("div"); let waits = 0, slow = false;
    const attempt = async (name) => {
      const begun = performance.now();
      const told = await this.page.do(name, { files, map: text.value, into: into.value });
      slow = performance.now() - begun > 1000;
      if (!told) { put(shown); return; }
      put(shown, told.runs.map((run) => h("div", {}, h("h3", {}, `${run.name}: ${run.samples} samples`), table(run.columns))));
      if (name === "import") { put(this.map); this.page.enter("Data"); }
    };
    text.addEventListener("input", () => { clearTimeout(waits); if (!slow) waits = setTimeout(() => attempt("try"), 500); });
    put(this.map, h("h2", {}, `Import ${files.join(", ")}`), h("p", { class: "faint" }, `Read as ${found.format}. Change columns and units below; the numbers follow.`),
      h("ul", {}, found.questions.map((q) => h("li", {}, q))), text,
      h("div", { class: "row" }, h("label", {}, "Campaign ", into),
        h("button", { "data-key": "try", onclick: () => attempt("try") }, "Try"),
        h("button", { class: "main", "data-key": "import", onclick: () => attempt("import") }, "Import"),
        h("button", { onclick: () => put(this.map) }, "Close")), shown);
    text.focus(); text.setSelectionRange(0, 0); text.scrollTop = 0;
    if (!found.questions.length) attempt("try");
  }

  async draw() {
    const { page } = this;
    const run = page.state.runs.find((r) => r.name === page.run);
    if (!run) { put(this.raw); this.chart = null; return; }
    if (!this.chart || this.drawn !== run.name) {
      const force = h("div", { class: "plot" }), speed = h("div", { class: "plot" });
      this.trims = h("div");
      put(this.raw, h("h2", {}, `${run.name}, as it was read`), this.trims, force, speed);
      const zoomed = (from, to) => page.look({ span: [from, to] });
      this.chart = new Chart(force, { curves: [curve("friction_n", "measured", "measured")], unit: page.units.force, zoomed, sync: "data" });
      this.speed = new Chart(speed, { curves: [curve("velocity_m_s", "speed", "model")], unit: page.units.speed, height: 130, zoomed, sync: "data" });
      this.drawn = run.name;
    }
    this.trim(run);
    const asked = { run: run.name, from_s: page.span[0], to_s: page.span[1], pixels: 1000 };
    let found;
    try { found = await get("series", asked); } catch (error) { page.say(error.message); return; }
    const out = run.trim ? [[run.from_s, run.trim[0]], [run.trim[1], run.to_s]] : [];
    for (const chart of [this.chart, this.speed]) { chart.show(found); chart.mark(out, []); }
    this.raw.dataset.drawn = run.name;
  }

  trim(run) {
    const [from, to] = run.trim ?? [run.from_s, run.to_s];
    const step = (run.to_s - run.from_s) / 1000;
    const set = (which, value) => {
      const span = which === 0 ? [Number(value), to] : [from, Number(value)];
      return this.page.do("trim", { run: run.name, from_s: span[0], to_s: span[1] });
    };
    const handle = (which, words, value) => h("label", {}, `${words} `,
      h("input", { type: "range", min: run.from_s, max: run.to_s, step, value, "data-key": `trim-${which}`, onchange: (e) => set(which, e.target.value) }),
      h("input", { type: "number", step, value: Number(value.toPrecision(8)), "aria-label": `${words}, s`, "data-key": `trim-n-${which}`, onchange: (e) => set(which, e.target.value) }), " s");
    put(this.trims, h("div", { class: "row" }, handle(0, "Use from", from), handle(1, "to", to),
      h("button", { disabled: !run.trim, onclick: () => this.page.do("trim", { run: run.name }) }, "All of it"),
      h("span", { class: "faint" }, "Drag in a plot to zoom, double-click for all.")),
    h("ul", {}, (run.findings ?? []).map((f) => h("li", {}, `${f.words}${f.done && f.done !== "none" ? ` (${f.done})` : ""}`))));
  }
}

const table = (columns) => h("table", {}, h("thead", {}, h("tr", {}, ["column", "least", "median", "most"].map((w, i) => h("th", { class: i ? "n" : "" }, w)))),
  h("tbody", {}, columns.map((c) => h("tr", {}, h("td", {}, c.name), [c.least, c.median, c.most].map((v) => h("td", { class: "n" }, number(v, 5)))))));
