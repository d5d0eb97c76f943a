// A recording of another make: a card for each open question, a preview, and the columns.
import { Chart, curve } from "./chart.js";
import { h, number, put, s } from "./dom.js";

const RIG = {
  motion: "motion", friction: "friction measured as", rated_torque_n_m: "rated torque (100 %)", rated_force_n: "rated force (100 %)",
  torque_constant_n_m_a: "torque per ampere", force_constant_n_a: "force per ampere",
  radius_m: "radius of the journal", length_m: "length", clearance_m: "radial clearance", mass_kg: "mass", count: "bearings on the shaft",
  viscosity_pa_s: "viscosity", normal_n: "load on one bearing",
  pitch_m: "travel per revolution", gear_ratio: "gear ratio (motor/output)",
};
const CHOICES = { motion: ["linear", "rotary"], friction: ["force", "torque", "current", "percent", "voltage", "none"] };

export class ImportForm {
  // `done` is called when the runs are open, `closed` when the form is put away, `again(joint)` to import another joint.
  constructor(page, place, files, found, { done, closed, again }) {
    Object.assign(this, { page, place, files, found, done, closed, again });
    this.text = found.map; this.form = found.form; this.answer = null; this.requests = 0; this.into = found.into;
    this.points = found.open; this.confirm = found.confirm; this.opened = {};
    this.show();
    place.querySelector("select, button")?.focus();
    this.send(null);
  }

  // The map as it is, or as the form changes it; the answer is shown.
  async send(form) {
    const request = ++this.requests;
    // Answers that are not applied yet are sent again with the next one.
    this.waiting = form ? { ...form, rig: { ...this.waiting?.rig, ...form.rig }, rate_hz: form.rate_hz ?? this.waiting?.rate_hz ?? null } : null;
    if (form) this.form = { ...this.form, rows: [...form.rows, ...this.form.rows.filter((row) => row.column === undefined && !form.rows.some((r) => r.key === row.key))] };
    // An error of a request that was replaced by a later one is out of date.
    const answer = await this.page.do("try", { files: this.files, map: this.text, form: this.waiting }, () => request === this.requests);
    if (request !== this.requests) return;
    this.waiting = null;
    if (answer) { this.text = answer.map; this.form = answer.form; this.answer = answer; this.points = answer.open; }
    else this.answer = { runs: [], problem: "the file was not read", open: this.points };
    this.show();
  }

  async keep(diagnose) {
    const found = await this.page.do("import", { files: this.files, map: this.text, into: this.into, diagnose });
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

  // The answer to an open question.
  reply(point, value) {
    const rows = this.rows().map((row) => ({ ...row })), column = (name) => this.found.columns.find((c) => c.name === name);
    const assign = (key, name) => [...rows.filter((row) => row.key !== key), { key, column: name, unit: column(name)?.unit || (column(name)?.kind === "instant" ? null : "?"), turned: false }];
    if (point.kind === "unit") this.send({ rows: rows.map((row) => (row.key === point.key ? { ...row, unit: value } : row)), rig: {} });
    else if (point.kind === "column") this.send({ rows: assign(point.key, value), rig: {} });
    else if (point.kind === "value") this.send({ rows, rig: { [point.place]: value } });
    else if (point.kind === "rate") this.send({ rows, rig: {}, rate_hz: value });
    else if (point.kind === "joint") this.again(value);
    else if (value === "bearing") this.machine(value);
    else if (point.kind === "values") this.send({ rows, rig: value });
    else if (point.kind === "formula") this.send({ rows: [...rows, { key: point.key, expression: point.expression.replace("?", value) }], rig: {} });
    else if (value === "none") this.send({ rows, rig: { "drive.friction": "none", [`drive.${this.rotary() ? "inertia_kg_m2" : "mass_kg"}`]: "?" } });
    else { const [key, ...name] = value.split(" "); this.send({ rows: assign(key, name.join(" ")), rig: {} }); }
  }

  machine(kind) { this.send({ rows: this.rows(), rig: { machine: kind } }); }

  rotary() { return this.form.rig.drive?.motion === "rotary"; }

  show() {
    const { found, answer } = this, open = this.points.length + this.confirm.length, ready = answer && !answer.problem && !open;
    const names = this.files.length > 3 ? `${this.files.slice(0, 2).join(", ")} and ${this.files.length - 2} more` : this.files.join(", ");
    const into = h("input", { class: "name", value: this.into, "aria-label": "name of the campaign", "data-key": "into", oninput: (e) => { this.into = e.target.value; } });
    const text = h("textarea", { "aria-label": "map", spellcheck: "false", "data-key": "map", onchange: () => { this.text = text.value; this.send(null); } });
    text.value = this.text;
    this.plots = h("div");
    put(this.place, h("h2", {}, `Import ${names}`), found.note ? h("p", { "data-key": "note" }, found.note) : null,
      h("p", { class: answer?.problem && !open ? "bad" : "", role: "status", "data-key": "problem" }, this.says(open)),
      h("div", { class: "cards" }, [...found.joint, ...this.points].map((point, i) => this.card(point, i)), this.confirm.map((point) => this.confirmation(point))),
      h("div", { class: "row" },
        h("button", { class: "main", "data-key": "import-diagnose", disabled: !ready, onclick: () => this.keep(true) }, "Import and diagnose"),
        h("button", { "data-key": "import", disabled: !ready, onclick: () => this.keep(false) }, "Import only"),
        h("button", { "data-key": "close-import", onclick: () => this.closed() }, "Close"),
        h("label", {}, "into folder ", into), this.kind()),
      this.plots,
      this.part("columns", "Columns: quantity, unit and sign", h("div", { class: "scroll" }, h("table", { class: "columns" },
        h("thead", {}, h("tr", {}, ["column", "first rows", "first values", "quantity", "unit", "negate", "range as read"].map((w) => h("th", {}, w)))),
        h("tbody", {}, found.columns.map((column) => this.row(column)))), this.formulas(), this.rig())),
      this.part("map-text", "Map: settings of the import as text (formulas, cuts, clocks)", text));
    if (answer?.curves) this.preview(answer);
    else put(this.plots, h("h3", {}, "The columns, first rows"), h("div", { class: "cards" },
      found.columns.filter((c) => c.shape).map((c) => h("figure", { class: "course" }, course(c.shape),
        h("figcaption", {}, `${c.name}: ${c.least} to ${c.most}${c.unit && !c.name.includes(`[${c.unit}]`) ? ` ${c.unit}` : ""}`)))));
  }

  part(key, words, ...content) {
    return h("details", { open: this.opened[key] ?? false, ontoggle: (e) => { this.opened[key] = e.target.open; } }, h("summary", { "data-key": key }, words), content);
  }

  says(open) {
    const { answer } = this;
    if (open) return `${open} question${open > 1 ? "s" : ""}, then the recording can be imported.`;
    if (!answer) return "Reading …";
    if (answer.problem) return `Not yet: ${answer.problem}.`;
    const runs = answer.runs.map((run) => `${run.name}: ${run.samples} samples`);
    return `Ready: ${runs.slice(0, 6).join("; ")}${runs.length > 6 ? ` and ${runs.length - 6} more runs` : ""}.`;
  }

  card(point, i) {
    const name = `answer-${point.key ?? point.place ?? point.kind}`, many = point.choices.length > 9;
    const set = (value) => this.reply(point, value);
    const field = (placeholder, words) => h("input", { class: "short", placeholder, "aria-label": words, "data-key": name, onchange: (e) => { if (e.target.value) set(e.target.value); } });
    const column = this.found.columns.find((c) => c.name === point.column);
    return h("section", { class: `card${point.kind === "joint" ? "" : " open"}`, "aria-label": point.title, "data-point": point.kind },
      h("div", { class: "top" }, h("h3", {}, point.title), column ? course(column.shape) : null),
      column ? h("p", { class: "faint" }, `first values: ${column.first.join(", ")}`) : null,
      point.kind === "values" ? this.values(point)
        : point.choices.length === 0 || point.kind === "formula" ? h("p", {}, h("label", {}, point.example ? `such as ${point.example} ` : `${point.number ?? "number"} `, field("value", point.title))) : null,
      point.choices.length === 0 ? null
        : many ? h("select", { "aria-label": point.title, "data-key": name, onchange: (e) => set(e.target.value) },
          h("option", { value: "" }, "choose …"),
          point.choices.map(([value, words]) => h("option", { value, selected: value === point.chosen }, words)))
          : h("div", { class: "choices" }, point.choices.map(([value, words]) =>
            h("button", { "data-key": `${name}-${value}`, "aria-pressed": String(value === point.chosen), onclick: () => set(value) }, words))),
      point.key === "time_s" && point.kind === "column" ? h("p", {}, h("label", {}, "or constant rate, Hz ",
        h("input", { class: "short", type: "number", "aria-label": "sampling rate, Hz", "data-key": "answer-rate",
          onchange: (e) => this.reply({ kind: "rate" }, Number(e.target.value)) }))) : null);
  }

  // Several values of the machine that are sent at once.
  values(point) {
    const fields = point.fields.map(({ place, title, example }) => [place, title, h("input", { class: "short", placeholder: `e.g. ${example}`, "aria-label": title, "data-key": `answer-${place}` })]);
    const all = () => Object.fromEntries(fields.map(([place, , input]) => [place, input.value.trim()]).filter(([, value]) => value));
    return h("form", { onsubmit: (e) => { e.preventDefault(); this.reply(point, all()); } },
      fields.map(([, title, input]) => h("p", {}, h("label", {}, title, h("br"), input))),
      h("button", { "data-key": "answer-values" }, "Use these values"));
  }

  confirmation(point) {
    return h("section", { class: "card open", "aria-label": "please check", "data-point": "confirm" }, h("h3", {}, "Please check"), h("p", {}, point.title),
      h("div", { class: "choices" }, h("button", { "data-key": "confirm", onclick: () => { this.confirm = this.confirm.filter((p) => p !== point); this.show(); } }, "It is right")));
  }

  // Friction and motion in their units, with the pieces that become runs.
  preview(answer) {
    const kept = answer.pieces.filter((p) => p.keep), several = answer.pieces.length > 1;
    for (const recording of answer.curves.slice(0, 2)) {
      const pieces = answer.pieces.filter((p) => p.file === recording.file), at = (p, t) => t + (recording.starts_s[p.segment] ?? 0);
      this.plots.append(h("h3", {}, `${recording.file}: ${several ? `cut into ${kept.length} runs; shaded parts are not used` : "one run, not cut"}`));
      for (const [key, { time_s, values }] of Object.entries(recording.columns)) {
        const place = h("div", { class: "plot" }), quantity = this.found.quantities.find((q) => q.key === key);
        this.plots.append(place);
        const chart = new Chart(place, { height: 130, legend: false,
          curves: [curve("values", quantity?.words ?? key, "measured")],
          unit: `${quantity?.words.split(" ")[0] ?? key} (${quantity?.units[0] ?? ""})` });
        chart.edges = several ? pieces.filter((p) => p.keep).map((p) => at(p, p.from_s)) : [];
        chart.show({ time_s, values });
        chart.mark(pieces.filter((p) => !p.keep).map((p) => [at(p, p.from_s), at(p, p.to_s)]), []);
      }
    }
    const notes = answer.notes.filter((note) => !note.startsWith("described"));
    if (notes.length) this.plots.append(h("ul", {}, notes.map((note) => h("li", {}, note.replace(" (--no-cut keeps it whole)", "")))));
    this.plots.dataset.drawn = String(kept.length);
  }

  row(column) {
    const row = this.rows().find((r) => r.column === column.name), key = row?.key ?? "";
    const known = this.found.quantities.find((q) => q.key === key), list = `units-${column.name}`;
    const other = key && !known ? [h("option", { value: key, selected: true }, key)] : [];
    return h("tr", { class: row ? "" : "unused" }, h("td", {}, column.name), h("td", {}, course(column.shape)), h("td", {}, column.first.join(", ")),
      h("td", {}, h("select", { "data-key": `is-${column.name}`, "aria-label": `quantity of ${column.name}`, title: this.found.why[key] ?? "",
        onchange: (e) => this.change(column, { key: e.target.value }) },
        h("option", { value: "", selected: !row }, "not used"), other,
        this.found.quantities.map((q) => h("option", { value: q.key, selected: q.key === key }, q.words)))),
      h("td", {}, row ? [h("input", { class: "short", list, value: row.unit === "?" ? "" : row.unit ?? column.unit ?? "", placeholder: "unit?",
        "data-key": `unit-${column.name}`, "aria-label": `unit of ${column.name}`,
        onchange: (e) => this.change(column, { unit: e.target.value }) }), h("datalist", { id: list }, (known?.units ?? []).map((u) => h("option", { value: u })))] : null),
      h("td", {}, row ? h("input", { type: "checkbox", checked: row.turned, "data-key": `turned-${column.name}`, "aria-label": `negate ${column.name}`, title: "negate",
        onchange: (e) => this.change(column, { turned: e.target.checked }) }) : null),
      h("td", { class: "n" }, row ? this.read(key) : ""));
  }

  // From the least to the largest value of what a column becomes, in all runs.
  read(key) {
    const found = (this.answer?.runs ?? []).flatMap((run) => run.columns.filter((c) => c.name === key || c.from === key));
    if (!found.length) return "";
    return `${number(Math.min(...found.map((c) => c.least)))} to ${number(Math.max(...found.map((c) => c.most)))} ${found[0].unit}`;
  }

  formulas() {
    const names = this.found.columns.map((c) => c.name);
    const others = this.form.rows.filter((row) => row.column === undefined || !names.includes(row.column));
    return others.length ? h("ul", { class: "plain" }, others.map((row) => h("li", {}, `${row.key} = ${row.expression}`, ` (${this.read(row.key)})`))) : null;
  }

  // The kind of machine; columns alone do not distinguish a bearing from a drive.
  kind() {
    const kind = this.form.rig.bearing ? "bearing" : this.form.rig.drive ? "drive" : null;
    return kind && h("label", {}, "recorded on ", h("select", { "data-key": "machine", onchange: (e) => this.machine(e.target.value) },
      [["drive", "a drive, slide or joint"], ["bearing", "a journal bearing"]].map(([value, words]) => h("option", { value, selected: value === kind }, words))));
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

// The course of the first rows of a column.
function course(shape) {
  if (!shape) return null;
  const points = shape.map((v, i) => (v === null ? null : `${(1 + 90 * i / Math.max(shape.length - 1, 1)).toFixed(1)},${(39 - 36 * v).toFixed(1)}`)).filter(Boolean).join(" ");
  return s("svg", { class: "sketch", viewBox: "0 0 92 42", preserveAspectRatio: "none", "aria-hidden": "true" },
    s("polyline", { points, fill: "none", stroke: "var(--measured)", "stroke-width": 1.4, "vector-effect": "non-scaling-stroke" }));
}
