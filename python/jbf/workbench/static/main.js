// The page: its sections, the current selection, and news from the server.
import { cancelRequests, download, follow, get, onBusy, post } from "./api.js";
import { showBanner } from "./banner.js";
import { documentation, h, put } from "./dom.js";
import { DataSection } from "./data.js";
import { SeeSection } from "./see.js";
import { LearnSection } from "./learn.js";
import { KeepSection } from "./keep.js";
import { showModels, showRuns } from "./side.js";
import { startTheme } from "./theme.js";

const SECTIONS = { Data: DataSection, Explore: SeeSection, Model: LearnSection, Export: KeepSection };
const DEFAULT_UNITS = { force: "N", speed: "m/s", length: "m", velocity: "speed", friction: "friction", noun: "force" };
const place = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.state = null; this.section = null; this.name = "Data"; this.draws = 0;
    // What is looked at: a run, a stretch of it, a selection and what it holds, an effect.
    this.run = null; this.span = [null, null]; this.selection = null; this.brushed = null; this.effect = null;
    // Whether a recording is being imported.
    this.importing = false;
    document.addEventListener("keydown", (event) => this.key(event));
    onBusy((busy) => { if (this.busy !== busy) { this.busy = busy; if (this.state) this.head(); } });
    place("theme").before(documentation("workbench.md", "Documentation", { "data-key": "docs" }));
    startTheme(place("theme"), () => { if (this.section) this.enter(this.name); });
    if (innerWidth <= 1000) for (const id of ["runs-part", "models-part"]) place(id).open = false;
  }

  get model() { return this.state.nodes.find((node) => node.id === this.state.current) ?? null; }
  get units() { return this.state.units ?? DEFAULT_UNITS; }

  update(state) {
    const before = this.state;
    this.state = state;
    const names = state.runs.map((run) => run.name);
    if (!names.includes(this.run)) { this.run = names[0] ?? null; this.span = [null, null]; this.selection = null; this.brushed = null; }
    // An error about files that are no longer open is out of date.
    if (before && before.rig !== state.rig) this.own = false;
    // A mark is one of a model's own.
    if (before && before.current !== state.current && this.selection?.mark !== undefined) { this.selection = null; this.brushed = null; }
    this.tabs(); this.head();
    for (const id of ["runs-part", "models-part"]) place(id).style.display = names.length ? "" : "none";
    place("columns").className = names.length ? "" : "alone";
    showRuns(this, place("runs")); showModels(this, place("models"));
    if (!this.section) this.enter(names.length ? this.name : "Data");
    else this.section.update(before);
    this.banner();
    document.body.dataset.version = state.version;
  }

  enter(name) {
    this.name = name;
    const section = place("section");
    section.replaceChildren(); section.setAttribute("aria-label", name);
    this.section = new SECTIONS[name](this, section);
    this.tabs();
    showModels(this, place("models"));
    this.section.update(null);
    this.banner();
  }

  banner() { showBanner(this, place("banner")); }

  tabs() {
    put(place("tabs"), Object.keys(SECTIONS).map((name, i) => h("button", {
      role: "tab", "aria-selected": String(name === this.name), title: `key ${i + 1}`, "data-key": `tab-${name}`,
      onclick: () => this.enter(name),
    }, `${i + 1} ${name}`)));
  }

  head() {
    const { job, message } = this.state;
    if (!job && this.busy) put(place("job"), [h("progress", { "aria-label": "progress" }), "Working …", h("button", { "data-key": "cancel-requests", onclick: cancelRequests }, "Cancel")]);
    else put(place("job"), job ? [
      h("progress", { "aria-label": "progress", ...(job.total ? { value: job.done, max: job.total } : {}) }),
      `${job.words}: ${job.message}, ${job.elapsed_s.toFixed(0)} s`,
      h("button", { "data-key": "cancel", onclick: () => this.do("cancel") }, "Cancel"),
    ] : []);
    if (!this.own) { place("message").textContent = message.words ?? ""; place("message").className = message.kind ?? ""; }
  }

  say(words, kind = "error") {
    this.own = Boolean(words);
    place("message").textContent = words; place("message").className = kind;
  }

  // Ask the server to do something; an error is shown while `current()` holds.
  async do(name, asked = {}, current = () => true) {
    try { this.say("", ""); return await post(name, asked); } catch (error) { if (current()) this.failed(error); return null; }
  }

  // Data for a plot of one run and model. An error is not shown if the session has changed meanwhile:
  // the request was then about files or a model that are no longer open.
  async ask(request) {
    const version = ({ rig, current, runs }) => JSON.stringify([rig, current, runs.map((run) => run.file)]);
    const before = version(this.state);
    try { return await request(); } catch (error) {
      if (error.name === "AbortError") return null;
      let now;
      try { now = await get("state"); } catch { now = null; }
      if (now && version(now) !== before) { this.update(now); return null; }
      this.say(error.message);
      return null;
    }
  }

  // A text as a file of the browser's own.
  async download(what, file) {
    try { await download(what, file); } catch (error) { this.failed(error); }
  }

  failed(error) { if (error.name === "AbortError" || error.message === "the reading was cancelled") this.say("Cancelled.", "done"); else this.say(error.message); }

  // What is looked at has changed.
  look(changes) {
    Object.assign(this, changes);
    if (!this.selection) this.brushed = null;
    showRuns(this, place("runs")); this.section.looked(changes);
  }

  // What a selection holds, for the list of runs.
  selected(brushed) { this.brushed = brushed; showRuns(this, place("runs")); }

  key(event) {
    const typing = event.target.matches("textarea, select, input:not([type=checkbox], [type=radio])");
    if (typing || document.querySelector("dialog[open]") || event.ctrlKey || event.altKey || event.metaKey) return;
    const name = Object.keys(SECTIONS)[Number(event.key) - 1];
    if (name) this.enter(name);
    else if (event.key === "z" && this.model) this.do("undo");
    else if (event.key === "y" && this.state.can_redo) this.do("redo");
    else if (event.key === "Escape" && this.selection) this.look({ selection: null });
  }
}

const page = new Page();
follow((state) => page.update(state), (words) => page.say(words));
