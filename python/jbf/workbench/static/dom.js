// Small helpers: elements, numbers, colours. Words go in as text, never as markup.

export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.flat(Infinity).filter((c) => c !== null && c !== undefined && c !== false));
  return element;
}

const SVG = "http://www.w3.org/2000/svg";
export function s(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function number(value, digits = 3) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return value.toExponential(digits - 1);
  return String(Number(value.toPrecision(digits)));
}

export const colour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

// Replaces what an element holds, and keeps the keyboard where it was.
export function put(place, ...children) {
  const at = document.activeElement?.dataset?.key;
  place.replaceChildren(...children.flat(Infinity).filter(Boolean));
  if (at) place.querySelector(`[data-key="${CSS.escape(at)}"]`)?.focus();
}

export function key(name, words) {
  return h("span", { class: "keyed" }, h("span", { class: `key ${name}` }), words);
}

// A ratio to the noise, as in "12 ×".
export const times = (ratio) => (ratio === null || ratio === undefined ? "–" : `${ratio < 9.95 ? ratio.toFixed(1) : Math.round(ratio)} ×`);

// Scale of bars of errors: multiples of the noise, or the unit of the rig if the noise is unknown.
export const scale = (noise, unit) => (noise > 0 ? { one: noise, words: times, title: "times the noise" }
  : { one: 1, words: (v) => `${number(v)} ${unit}`, title: `${unit}, noise unknown` });

// Start of a label behind the end of a bar, not across a vertical line.
export const behind = (end, line) => (end < line && end + 40 > line ? line : end) + 5;

// A link to the documentation; it is opened only by a click.
const DOCS = "https://github.com/jbf-friction/jbf/blob/main/docs";
export const documentation = (page, words, attributes = {}) =>
  h("a", { href: `${DOCS}/${page}`, target: "_blank", rel: "noopener noreferrer", ...attributes }, words);
