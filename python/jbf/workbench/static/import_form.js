// A recording of another make: which column is what, in which unit, and the numbers that come of it.
import { h, number, put } from "./dom.js";

const RIG = {
  motion: "motion", friction: "friction measured as", rated_torque_n_m: "rated torque (100 %), N m", rated_force_n: "rated force (100 %), N",
  torque_constant_n_m_a: "torque per ampere, N m/A", force_constant_n_a: "force per ampere, N/A",
  pitch_m: "travel per revolution, m", gear_ratio: "gear ratio (motor/output)",
};
const CHOICES = { motion: ["linear", "rotary"], friction: ["force", "torque", "current", "percent", "voltage", "none"] };
// What a run calls a column that was converted.
const MADE = { speed_rpm: "velocity_m_s", velocity_rad_s: "velocity_m_s", motor_velocity_rad_s: "velocity_m_s", motor_speed_rpm: "velocity_m_s",
  torque_n_m: "friction_n", motor_torque_n_m: "friction_n", current_a: "friction_n", torque_percent: "friction_n", force_percent: "friction_n",
  motor_angle_rad: "angle_rad" };

export class ImportForm {
  // `done` is called when the runs are open, `closed` when the form is put away.
  constructor(page, place, files, found, { done, closed }) {
    Object.assign(this, { page, place, files, found, done, closed });
    this.text = found.map; this.form = found.form; this.answer = null; this.requests = 0; this.into = found.into;
    this.open = false; this.questions = found.questions;
    this.show();
    place.querySelector("select")?.focus();
    this.send(null);
  }

  // The map as it stands, or as the form changes it; what comes back is shown.
  async send(form) {
    const request = ++this.requests;
    const answer = await this.page.do("try", { files: this.files, map: this.text, form });
    if (request !== this.requests) return;
    if (answer) {
      this.text = answer.map; this.form = answer.form; this.answer = answer;
      if (form) this.questions = [];
    }
    this.show();
  }

  async keep() {
    const found = await this.page.do("import", { files: this.files, map: this.text, into: this.into });
    if (found) this.done(found);
  }

  rows() { return this.form.rows.filter((row) => row.column !== undefined); }

  change(column, changes) {
    const rows = this.rows().map((row) => ({ ...row }));
    const at = rows.findIndex((row) => row.column === column.name);
    if (changes.key === "") rows.splice(at, 1);
    else if (at < 0) rows.push({ column: column.name, unit: column.unit || null, turned: false, ...changes });
    else Object.assign(rows[at], changes);
    this.send({ rows, rig: {} });
  }

  show() {
    const { found, answer } = this, ready = answer && !answer.problem;
    const names = this.files.length > 3 ? `${this.files.slice(0, 2).join(", ")} and ${this.files.length - 2} more` : this.files.join(", ");
    const text = h("textarea", { "aria-label": "map", spellcheck: "false", "data-key": "map", onchange: () => { this.text = text.value; this.send(null); } });
    text.value = this.text;
    const into = h("input", { value: this.into, "aria-label": "name of the campaign", "data-key": "into", oninput: (e) => { this.into = e.target.value; } });
    put(this.place, h("h2", {}, `Import ${names}`),
      h("p", {}, "Assign a quantity and a unit to each column. Check the preview on the right, then import."),
      h("table", {}, h("thead", {}, h("tr", {}, ["column", "first values", "quantity", "unit", "negate", "preview"].map((w) => h("th", {}, w)))),
        h("tbody", {}, found.columns.map((column) => this.row(column)))),
      this.formulas(), this.rig(),
      h("p", { class: ready ? "good" : "bad", role: "status", "data-key": "problem" }, this.says()),
      h("div", { class: "row" }, h("label", {}, "Target folder ", into),
        h("button", { class: "main", "data-key": "import", disabled: !ready, onclick: () => this.keep() }, "Import"),
        h("button", { "data-key": "close-import", onclick: () => this.closed() }, "Close")),
      h("details", { open: this.open, ontoggle: (e) => { this.open = e.target.open; } }, h("summary", { "data-key": "map-text" }, "Map as text (formulas, cuts, clocks)"), text));
  }

  says() {
    const { answer } = this;
    if (!answer) return "Reading…";
    if (answer.problem) return `Incomplete: ${this.questions.length ? this.questions.join("; ") : answer.problem}.`;
    const runs = answer.runs.map((run) => `${run.name}: ${run.samples} samples`);
    return `Ready: ${runs.slice(0, 6).join("; ")}${runs.length > 6 ? ` and ${runs.length - 6} more runs` : ""}.`;
  }

  row(column) {
    const row = this.rows().find((r) => r.column === column.name), key = row?.key ?? "";
    const known = this.found.quantities.find((q) => q.key === key), list = `units-${column.name}`;
    const other = key && !known ? [h("option", { value: key, selected: true }, key)] : [];
    return h("tr", { class: row ? "" : "unused" }, h("td", {}, column.name), h("td", { class: "faint" }, column.first.join(", ")),
      h("td", {}, h("select", { "data-key": `is-${column.name}`, "aria-label": `quantity of ${column.name}`, onchange: (e) => this.change(column, { key: e.target.value }) },
        h("option", { value: "", selected: !row }, "not used"), other,
        this.found.quantities.map((q) => h("option", { value: q.key, selected: q.key === key }, q.words)))),
      h("td", {}, row ? [h("input", { class: "short", list, value: row.unit === "?" ? "" : row.unit ?? column.unit ?? "", placeholder: "unit?", "data-key": `unit-${column.name}`, "aria-label": `unit of ${column.name}`,
        onchange: (e) => this.change(column, { unit: e.target.value }) }), h("datalist", { id: list }, (known?.units ?? []).map((u) => h("option", { value: u })))] : null),
      h("td", {}, row ? h("input", { type: "checkbox", checked: row.turned, "data-key": `turned-${column.name}`, "aria-label": `negate ${column.name}`, title: "negate",
        onchange: (e) => this.change(column, { turned: e.target.checked }) }) : null),
      h("td", { class: "n" }, row ? this.read(key) : ""));
  }

  // From the least to the largest value of what a column becomes, in all runs.
  read(key) {
    const found = (this.answer?.runs ?? []).flatMap((run) => run.columns.filter((c) => c.name === key || c.name === MADE[key]));
    if (!found.length) return "";
    return `${number(Math.min(...found.map((c) => c.least)))} to ${number(Math.max(...found.map((c) => c.most)))} ${found[0].unit}`;
  }

  formulas() {
    const names = this.found.columns.map((c) => c.name);
    const others = this.form.rows.filter((row) => row.column === undefined || !names.includes(row.column));
    return others.length ? h("ul", { class: "plain" }, others.map((row) => h("li", {}, `${row.key} = ${row.expression}`, ` (${this.read(row.key)})`))) : null;
  }

  rig() {
    const fields = Object.entries(this.form.rig).flatMap(([section, part]) => Object.entries(part).map(([key, value]) => ({ section, key, value })));
    if (!fields.length) return null;
    const set = (field) => (e) => this.send({ rows: this.rows(), rig: { [`${field.section}.${field.key}`]: e.target.value } });
    return h("div", { class: "row" }, h("b", {}, "Machine"), fields.map((field) => {
      const common = { "data-key": `rig-${field.section}.${field.key}`, onchange: set(field) };
      const input = CHOICES[field.key]
        ? h("select", common, [...new Set([...CHOICES[field.key], field.value])].map((c) => h("option", { value: c, selected: c === field.value }, c)))
        : h("input", { class: "short", value: field.value === "?" ? "" : field.value, placeholder: "?", ...common });
      return h("label", {}, `${RIG[field.key] ?? field.key.replaceAll("_", " ")} `, input);
    }));
  }
}
