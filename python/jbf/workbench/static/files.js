// Files of the folder: the empty state with samples, campaigns to open, recordings to import.
import { get, upload } from "./api.js";
import { h, put } from "./dom.js";
import { ImportForm } from "./import_form.js";

const count = (n, what) => `${n} ${what}${n === 1 ? "" : "s"}`;

export class Files {
  // `importing(now)` is called when the import is shown or put away.
  constructor(page, place, { map, importing, done }) {
    Object.assign(this, { page, place, map, importing, done });
    this.picked = new Set();
  }

  async list() {
    let found;
    try { found = await get("files"); } catch (error) { this.page.say(error.message); return; }
    const { state } = this.page, some = state.runs.length > 0;
    const open = (rig, runs) => this.page.do("open", { rig, runs }).then((ok) => ok && this.page.enter("Data"));
    const files = (names) => JSON.stringify([...names].sort()), present = files(state.runs.map((run) => run.file));
    const campaigns = found.campaigns.filter((c) => c.rig !== state.rig || files(c.runs) !== present);
    const samples = h("div", { class: "cards" }, found.samples.map((sample) => h("div", { class: "card" },
      h("h3", {}, sample.title), h("p", {}, `${sample.words}. Simulated.`),
      h("button", { "data-key": `sample-${sample.name}`, onclick: () => this.page.do("sample", { name: sample.name }) }, "Open the sample"))));
    const others = [
      campaigns.length ? h("section", {}, h("h2", {}, some ? "Open another rig with its runs" : "Rigs and their runs in this folder"),
        h("p", { class: "faint" }, "The rig file describes the machine; its runs are the CSV files in the same folder."),
        h("ul", { class: "plain" }, campaigns.map((c) => h("li", {},
          h("button", { "data-key": `open-${c.rig}`, "aria-label": `open ${c.rig}`, onclick: () => open(c.rig, c.runs) }, "Open"),
          ` ${c.rig}, ${count(c.runs.length, "run")}`, c.models ? h("b", {}, `, ${count(c.models, "model")} kept`) : null)))) : null,
      found.sessions.length ? h("section", {}, h("h2", {}, "Saved sessions"), h("ul", { class: "plain" }, found.sessions.map((name) => h("li", {},
        h("button", { "data-key": `session-${name}`, "aria-label": `open ${name}`,
          onclick: () => this.page.do("open_session", { file: name }).then((ok) => ok && this.done()) }, "Open"), ` ${name}`)))) : null,
      this.recordings(found), this.picker(found, open),
      found.more ? h("p", { class: "faint" }, "More files are not shown: choose a smaller folder.") : null,
    ];
    if (some) put(this.place, h("h2", {}, "Files"), h("p", { class: "faint" }, state.folder, ` · open: ${state.rig}`), this.drop(false), others,
      h("details", {}, h("summary", { "data-key": "samples" }, "Samples"), samples));
    else put(this.place, h("div", { class: "empty" }, h("h2", {}, "What is missing in your friction model?"), this.drop(true),
      h("h2", {}, "Or try a sample"), h("p", {}, "Three simulated recordings whose answer is known. Each opens in one click."), samples, others,
      h("p", { class: "faint" }, `Folder: ${state.folder}. No data leave this machine.`)));
    this.place.dataset.listed = "";
  }

  drop(large) {
    const input = h("input", { type: "file", multiple: true, "aria-label": "choose files", "data-key": "choose", onchange: (e) => this.take(e.target.files) });
    const drop = h("div", { class: `drop${large ? " large" : ""}`,
      ondragover: (e) => { e.preventDefault(); drop.classList.add("over"); },
      ondragleave: () => drop.classList.remove("over"),
      ondrop: (e) => { e.preventDefault(); drop.classList.remove("over"); this.take(e.dataTransfer.files); } },
    h("b", {}, "Drop a recording here"), large ? h("p", {}, "Time, position or speed, and force, torque or motor current. CSV, Excel, MAT, MDF4, TDMS, ROS bag and others.") : h("br"), input);
    return drop;
  }

  // A rig and runs that do not lie together.
  picker(found, open) {
    if (!found.rigs.length || !found.csv.length) return null;
    const rig = h("select", { "aria-label": "rig" }, found.rigs.map((name) => h("option", { value: name }, name)));
    const runs = h("select", { multiple: true, size: 4, "aria-label": "runs" }, found.csv.map((name) => h("option", { value: name }, name)));
    return h("details", {}, h("summary", { "data-key": "picker" }, "Open a rig file with runs of other folders"), h("div", { class: "row" }, rig, runs,
      h("button", { onclick: () => open(rig.value, [...runs.selectedOptions].map((o) => o.value)) }, "Open")));
  }

  // Files of another make: those that are ticked are imported by one map.
  recordings(found) {
    const names = [...found.other, ...found.csv.filter((f) => !found.campaigns.some((c) => c.runs.includes(f)))];
    if (!names.length) return null;
    this.picked = new Set([...this.picked].filter((name) => names.includes(name)));
    const go = h("button", { "data-key": "import-chosen", disabled: !this.picked.size, onclick: () => this.look([...this.picked]) }, "Import the selected files …");
    const tick = (name, on) => { this.picked[on ? "add" : "delete"](name); go.disabled = !this.picked.size; };
    return h("section", {}, h("h2", {}, "Logger files in this folder"), h("ul", { class: "plain list" }, names.map((name) => h("li", {},
      h("label", {}, h("input", { type: "checkbox", "data-key": `pick-${name}`, checked: this.picked.has(name), onchange: (e) => tick(name, e.target.checked) }), ` ${name}`)))),
    h("div", { class: "row" }, go, h("span", { class: "faint" }, "all are read with the same assignment of columns: select files of one logger")));
  }

  // Copy files into the folder and open them: a session, a rig with its runs, or recordings to import.
  async take(files) {
    const names = [], notes = [];
    for (const file of files) {
      const progress = (share) => this.page.say(`Copying ${file.name}: ${Math.round(100 * share)} %`, "doing");
      try {
        const name = (await upload(file, progress)).file;
        names.push(name);
        if (name !== file.name) notes.push(`${file.name} is in the folder with other content; the new file is named ${name}.`);
      } catch (error) {
        if (error.name === "AbortError") { this.page.failed(error); break; }
        notes.push(`${error.message}.`);
      }
    }
    this.picked = new Set(names);
    const session = names.find((name) => name.endsWith(".zip")), runs = names.filter((name) => name.endsWith(".csv"));
    const recordings = names.filter((name) => !/\.(toml|zip)$/.test(name)), note = notes.join(" ");
    const rig = names.some((name) => name.endsWith(".toml")) ? (await get("files")).rigs.find((name) => names.includes(name)) : null;
    if (session || (rig && runs.length)) {
      const opened = session ? await this.page.do("open_session", { file: session }) : await this.page.do("open", { rig, runs });
      if (opened) this.done(); else await this.list();
    } else if (recordings.length) { await this.look(recordings, null, note); return; } else await this.list();
    if (note) this.page.say(note, names.length ? "done" : "error");
  }

  // What the columns are, in a form that can be changed until the numbers are right.
  async look(files, joint = null, note = "") {
    const found = await this.page.do("look", { file: files[0], joint });
    if (!found) { await this.list(); return; }
    this.importing(true);
    new ImportForm(this.page, this.map, files, { ...found, note }, {
      done: () => this.done(),
      closed: () => { put(this.map); this.importing(false); this.list(); },
      again: (other) => this.look(files, other, note),
    });
    scrollTo(0, 0);
  }
}
