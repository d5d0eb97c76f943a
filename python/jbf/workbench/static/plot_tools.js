// Head of a plot: title, and buttons that save its picture and its data.
import { colour, h } from "./dom.js";

function save(blob, name) {
  const link = h("a", { download: name, href: URL.createObjectURL(blob) });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// `canvas()` returns the canvas as drawn; `table()` the names and columns of its data.
export function plotHead(level, title, file, { canvas, table }, ...more) {
  const picture = () => {
    const drawn = canvas();
    if (!drawn) return;
    const copy = h("canvas", { width: drawn.width, height: drawn.height }), ctx = copy.getContext("2d");
    ctx.fillStyle = colour("paper"); ctx.fillRect(0, 0, copy.width, copy.height); ctx.drawImage(drawn, 0, 0);
    copy.toBlob((blob) => save(blob, `${file}.png`));
  };
  const data = () => {
    const { names, columns } = table() ?? {};
    if (!columns?.length) return;
    const cell = (value) => (/[",\n]/.test(value ?? "") ? `"${String(value).replaceAll('"', '""')}"` : value ?? "");
    const rows = columns[0].map((_, i) => columns.map((column) => cell(column[i])).join(","));
    save(new Blob([`${[names.map(cell).join(","), ...rows].join("\n")}\n`], { type: "text/csv" }), `${file}.csv`);
  };
  return h("div", { class: "plot-head" }, h(level, {}, title), ...more, h("span", { class: "choices" },
    h("button", { "data-key": `png-${file}`, "aria-label": `save the picture of ${title}`, title: "save this picture", onclick: picture }, "PNG"),
    h("button", { "data-key": `csv-${file}`, "aria-label": `save the data of ${title}`, title: "save the data as drawn", onclick: data }, "CSV")));
}
