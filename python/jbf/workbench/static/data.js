// Section 1: what is in the folder, files from elsewhere, records as they were read, trims.
import { get, upload } from "./api.js";
import { Chart, curve } from "./chart.js";
import { h, put } from "./dom.js";
import { ImportForm } from "./import_form.js";
import { TrimHandles } from "./trim.js";

export class DataSection {
  constructor(page, place) {
    this.page = page; page.importing = false;
    this.files = h("div"); this.raw = h("div"); this.map = h("div"); this.picked = new Set();
    this.place = place; this.shelf = h("section", {}, h("h2", {}, "Files"), this.files);
    place.append(this.map, this.shelf, this.raw);
  }

  update(before) {
    const { state } = this.page, names = (s) => JSON.stringify([s.rig, s.runs.map((r) => r.file)]);
    if (!before || names(before) !== names(state)) this.list();
    if (!before || JSON.stringify(before.runs) !== JSON.stringify(state.runs)) this.draw();
  }

  looked() { this.draw(); }

  async list() {
    // Once there are runs they come first; at once: what is moved later loses the keys.
    if (this.page.state.runs.length > 0 && this.place.lastChild !== this.shelf) this.place.append(this.raw, this.shelf);
    let found;
    try { found = await get("files"); } catch (error) { this.page.say(error.message); return; }
    const { state } = this.page, some = state.runs.length > 0;
    const open = (rig, runs) => this.page.do("open", { rig, runs }).then((ok) => ok && this.page.enter("Data"));
    const input = h("input", { type: "file", multiple: true, "aria-label": "choose files", "data-key": "choose", onchange: (e) => this.take(e.target.files) });
    const drop = h("div", { class: "drop",
      ondragover: (e) => { e.preventDefault(); drop.classList.add("over"); },
      ondragleave: () => drop.classList.remove("over"),
      ondrop: (e) => { e.preventDefault(); drop.classList.remove("over"); this.take(e.dataTransfer.files); } },
    h("b", {}, "Your own recording: "), "drop a file here, or choose it: ", input);
    const campaigns = found.campaigns.filter((c) => c.rig !== state.rig);
    put(this.files,
      h("p", { class: "faint" }, state.folder, state.rig ? ` · open: ${state.rig}` : ""),
      h("div", { class: "two" },
        h("div", {},
          some ? null : h("div", { class: "row" }, h("button", { class: "main", "data-key": "demo", onclick: () => this.page.do("demo") }, "Open the demo data"), h("span", { class: "faint" }, "five runs of a bearing with a hidden effect")),
          campaigns.length ? [h("h3", {}, some ? "Open another rig with its runs" : "Rigs and their runs in this folder"),
            h("ul", { class: "plain" }, campaigns.map((c) => h("li", {},
              h("button", { "data-key": `open-${c.rig}`, onclick: () => open(c.rig, c.runs) }, "Open"), ` ${c.rig}, ${c.runs.length} run${c.runs.length === 1 ? "" : "s"}`)))] : null,
          this.picker(found, open)),
        h("div", {}, drop, this.recordings(found),
          found.more ? h("p", { class: "faint" }, "More files are not shown: choose a smaller folder.") : null,
          some ? h("div", { class: "row" }, h("button", { "data-key": "demo", onclick: () => this.page.do("demo") }, "Open the demo data")) : null)));
  }

  // A rig and runs that do not lie together.
  picker(found, open) {
    if (!found.rigs.length || !found.csv.length) return null;
    const rig = h("select", { "aria-label": "rig" }, found.rigs.map((name) => h("option", { value: name }, name)));
    const runs = h("select", { multiple: true, size: 4, "aria-label": "runs" }, found.csv.map((name) => h("option", { value: name }, name)));
    return h("details", {}, h("summary", { "data-key": "picker" }, "Choose a rig and runs from different folders"), h("div", { class: "row" }, rig, runs,
      h("button", { onclick: () => open(rig.value, [...runs.selectedOptions].map((o) => o.value)) }, "Open")));
  }

  // Files of another make: those that are ticked are imported by one map.
  recordings(found) {
    const names = [...found.other, ...found.csv.filter((f) => !found.campaigns.some((c) => c.runs.includes(f)))];
    if (!names.length) return null;
    this.picked = new Set([...this.picked].filter((name) => names.includes(name)));
    const go = h("button", { "data-key": "import-chosen", disabled: !this.picked.size, onclick: () => this.look([...this.picked]) }, "Import the selected files …");
    const tick = (name, on) => { this.picked[on ? "add" : "delete"](name); go.disabled = !this.picked.size; };
    return [h("h3", {}, "Logger files in this folder"), h("ul", { class: "plain list" }, names.map((name) => h("li", {},
      h("label", {}, h("input", { type: "checkbox", "data-key": `pick-${name}`, checked: this.picked.has(name), onchange: (e) => tick(name, e.target.checked) }), ` ${name}`)))),
    h("div", { class: "row" }, go, h("span", { class: "faint" }, "one map for all: select files with the same columns"))];
  }

  async take(files) {
    const names = [];
    for (const file of files) {
      try { names.push((await upload(file)).file); } catch (error) { this.page.say(error.message); break; }
    }
    this.picked = new Set(names);
    await this.list();
    if (names.length) this.look(names);
  }

  // What the columns are, in a form that can be changed until the numbers are right.
  async look(files) {
    const found = await this.page.do("look", { file: files[0] });
    if (!found) return;
    const importing = (now) => {
      this.page.importing = now; this.page.banner();
      for (const part of [this.shelf, this.raw]) part.style.display = now ? "none" : "";
    };
    importing(true);
    new ImportForm(this.page, this.map, files, found, {
      done: () => this.page.enter("Data"),
      closed: () => { put(this.map); importing(false); },
    });
    scrollTo(0, 0);
  }

  async draw() {
    const { page } = this;
    const run = page.state.runs.find((r) => r.name === page.run);
    if (!run) { put(this.raw); this.chart = null; return; }
    if (!this.chart || this.drawn !== run.name) {
      const force = h("div", { class: "plot" }), speed = h("div", { class: "plot" }), { units } = page;
      this.trims = h("div");
      put(this.raw, h("h2", {}, `${run.name}, as recorded`), this.trims, force, speed);
      const zoomed = (from, to) => page.look({ span: [from, to] });
      this.chart = new Chart(force, { curves: [curve("friction_n", "measured", "measured")], unit: `${units.noun} (${units.force})`, zoomed, sync: "data" });
      this.speed = new Chart(speed, { curves: [curve("velocity_m_s", "speed", "model")], unit: `speed (${units.speed})`, height: 130, zoomed, sync: "data", legend: false });
      this.handles = new TrimHandles(this.chart, (from, to) => page.do("trim", { run: page.run, from_s: from, to_s: to }));
      this.drawn = run.name;
    }
    this.trim(run);
    const asked = { run: run.name, from_s: page.span[0], to_s: page.span[1], pixels: 1000 };
    const found = await page.ask(() => get("series", asked));
    if (!found || !this.chart || this.drawn !== run.name) return;
    const out = run.trim ? [[run.from_s, run.trim[0]], [run.trim[1], run.to_s]] : [];
    for (const chart of [this.chart, this.speed]) { chart.show(found); chart.mark(out, []); }
    this.handles.show(run);
    this.raw.dataset.drawn = run.name;
  }

  trim(run) {
    const [from, to] = run.trim ?? [run.from_s, run.to_s], findings = run.findings ?? [];
    const set = (which, value) => {
      const span = which === 0 ? [Number(value), to] : [from, Number(value)];
      return this.page.do("trim", { run: run.name, from_s: span[0], to_s: span[1] });
    };
    const end = (which, words, value) => h("label", {}, `${words} `,
      h("input", { type: "number", class: "short", step: "any", value: Number(value.toPrecision(8)), "aria-label": `${words}, s`, "data-key": `trim-n-${which}`, onchange: (e) => set(which, e.target.value) }), " s");
    put(this.trims, h("div", { class: "row" }, end(0, "Use from", from), end(1, "to", to),
      h("button", { "data-key": "untrim", disabled: !run.trim, onclick: () => this.page.do("trim", { run: run.name }) }, "Reset trim"),
      h("span", { class: "faint" }, "Handles in the plot trim the run; drag to zoom, double-click to reset.")),
    run.findings === null ? h("p", { class: "faint" }, "Checking the data quality…")
      : findings.length ? [h("h3", {}, "Data quality"), h("ul", {}, findings.map((f) => h("li", {}, `${f.words}${f.done && f.done !== "none" ? ` (${f.done})` : ""}`)))]
        : h("p", { class: "faint" }, "No finding."));
  }
}
