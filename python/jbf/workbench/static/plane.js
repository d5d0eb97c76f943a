// The friction-speed plane: densities on a canvas, and a box that brushes.
import { colour, h, number } from "./dom.js";

function bytes(text) {
  const read = atob(text), found = new Uint8Array(read.length);
  for (let i = 0; i < read.length; i++) found[i] = read.charCodeAt(i);
  return found;
}

function rgb(name) {
  const probe = document.createElement("canvas").getContext("2d");
  probe.fillStyle = colour(name);
  const hex = probe.fillStyle;
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
}

export class Plane {
  constructor(place, { height = 300, brushed }) {
    this.canvas = h("canvas", { class: "mine", height, tabindex: 0,
      "aria-label": "Friction against speed; drag a box to select, Escape clears" });
    this.height = height; this.brushed = brushed; this.found = null; this.box = null;
    place.append(h("div", { class: "plot" }, this.canvas));
    const at = (event) => {
      const r = this.canvas.getBoundingClientRect();
      return [event.clientX - r.left, event.clientY - r.top];
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      this.from = at(event); this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!this.from) return;
      this.box = [...this.from, ...at(event)]; this.draw();
    });
    this.canvas.addEventListener("pointerup", (event) => {
      const to = at(event), from = this.from; this.from = null; this.box = null;
      if (!from || !this.found) return;
      if (Math.abs(to[0] - from[0]) < 4 || Math.abs(to[1] - from[1]) < 4) { brushed(null); return; }
      const x = [from[0], to[0]].map((v) => this.speed(v)).sort((a, b) => a - b);
      const y = [from[1], to[1]].map((v) => this.force(v)).sort((a, b) => a - b);
      brushed([...x, ...y]);
    });
    this.canvas.addEventListener("keydown", (event) => { if (event.key === "Escape") brushed(null); });
    new ResizeObserver(() => this.draw()).observe(place);
  }

  get edge() { return { left: 58, right: 8, top: 8, bottom: 36 }; }
  get wide() { return this.canvas.clientWidth - this.edge.left - this.edge.right; }
  get high() { return this.height - this.edge.top - this.edge.bottom; }
  speed(px) { const f = this.found.frame; return f.left + (px - this.edge.left) / this.wide * (f.right - f.left); }
  force(px) { const f = this.found.frame; return f.high - (px - this.edge.top) / this.high * (f.high - f.low); }
  x(v) { const f = this.found.frame; return this.edge.left + (v - f.left) / (f.right - f.left) * this.wide; }
  y(v) { const f = this.found.frame; return this.edge.top + (f.high - v) / (f.high - f.low) * this.high; }

  show(found, units, curve = null) {
    Object.assign(this, { found, units, curve });
    this.layers = [this.layer([[found.measured, "measured", 60], [found.model, "model", 150]]), null];
    this.draw();
  }

  // Of the samples that are shown, these are selected.
  select(text) {
    const now = text ? this.layer([[text, "selected", 190]]) : null;
    if (!now && !this.layers?.[1]) return;
    this.layers[1] = now; this.draw();
  }

  // Densities over one another, as a canvas of a pixel each.
  layer(parts) {
    const f = this.found.frame, picture = new ImageData(f.columns, f.rows), data = picture.data;
    for (const [text, tint, least] of parts.filter(([text]) => text)) {
      const [r, g, b] = rgb(tint), level = bytes(text);
      for (let row = 0; row < f.rows; row++) for (let col = 0; col < f.columns; col++) {
        const value = level[row * f.columns + col];
        if (!value) continue;
        const at = 4 * ((f.rows - 1 - row) * f.columns + col), a = Math.max(value, least), share = a / 255;
        data[at] = data[at] * (1 - share) + r * share;
        data[at + 1] = data[at + 1] * (1 - share) + g * share;
        data[at + 2] = data[at + 2] * (1 - share) + b * share;
        data[at + 3] = Math.max(data[at + 3], a);
      }
    }
    const small = document.createElement("canvas");
    small.width = f.columns; small.height = f.rows;
    small.getContext("2d").putImageData(picture, 0, 0);
    return small;
  }

  draw() {
    if (!this.found || !this.canvas.clientWidth) return;
    const ratio = devicePixelRatio || 1;
    this.canvas.width = this.canvas.clientWidth * ratio; this.canvas.height = this.height * ratio;
    this.canvas.style.height = `${this.height}px`;
    const ctx = this.canvas.getContext("2d");
    ctx.scale(ratio, ratio);
    ctx.imageSmoothingEnabled = false;
    for (const small of this.layers.filter(Boolean)) ctx.drawImage(small, this.edge.left, this.edge.top, this.wide, this.high);
    this.axes(ctx);
    if (this.curve) this.steady(ctx);
    if (this.box) {
      const [a, b, c, d] = this.box;
      ctx.strokeStyle = colour("selected"); ctx.lineWidth = 2;
      ctx.strokeRect(Math.min(a, c), Math.min(b, d), Math.abs(c - a), Math.abs(d - b));
    }
  }

  // The law at steady speeds, and where its regimes end.
  steady(ctx) {
    const { velocity_m_s: v, friction_n: force, regimes_m_s: ends } = this.curve, e = this.edge;
    ctx.save();
    ctx.beginPath(); ctx.rect(e.left, e.top, this.wide, this.high); ctx.clip();
    ctx.strokeStyle = colour("chosen"); ctx.lineWidth = 1.8;
    for (const way of [1, -1]) {
      ctx.beginPath();
      v.forEach((speed, i) => ctx.lineTo(this.x(way * speed), this.y(way * force[i])));
      ctx.stroke();
    }
    ctx.setLineDash([3, 4]); ctx.lineWidth = 1; ctx.fillStyle = colour("chosen"); ctx.textAlign = "left";
    for (const [speed, name] of ends) for (const way of [1, -1]) {
      line(ctx, this.x(way * speed), e.top, this.x(way * speed), e.top + this.high);
      if (way > 0) ctx.fillText(name, this.x(speed) + 3, e.top + this.high - 6);
    }
    ctx.restore();
  }

  axes(ctx) {
    const f = this.found.frame, e = this.edge;
    ctx.strokeStyle = colour("line"); ctx.fillStyle = colour("ink"); ctx.font = "12px system-ui"; ctx.lineWidth = 1;
    ctx.strokeRect(e.left, e.top, this.wide, this.high);
    ctx.textAlign = "center";
    for (const v of ticks(f.left, f.right)) {
      ctx.fillText(number(v), this.x(v), e.top + this.high + 14);
      line(ctx, this.x(v), e.top + this.high, this.x(v), e.top + this.high - 4);
    }
    ctx.fillText(`${this.units.velocity} (${this.units.speed})`, e.left + this.wide / 2, this.height - 6);
    ctx.textAlign = "right";
    for (const v of ticks(f.low, f.high)) {
      ctx.fillText(number(v), e.left - 6, this.y(v) + 4);
      line(ctx, e.left, this.y(v), e.left + 4, this.y(v));
    }
    ctx.save(); ctx.translate(12, e.top + this.high / 2); ctx.rotate(-Math.PI / 2); ctx.textAlign = "center";
    ctx.fillText(`${this.units.friction} (${this.units.force})`, 0, 0);
    ctx.restore();
    if (f.left < 0 && f.right > 0) line(ctx, this.x(0), e.top, this.x(0), e.top + this.high);
    if (f.low < 0 && f.high > 0) line(ctx, e.left, this.y(0), e.left + this.wide, this.y(0));
  }
}

function line(ctx, a, b, c, d) { ctx.beginPath(); ctx.moveTo(a, b); ctx.lineTo(c, d); ctx.stroke(); }

export function ticks(low, high, about = 5) {
  const raw = (high - low) / about, base = 10 ** Math.floor(Math.log10(raw));
  const step = base * [1, 2, 5, 10].find((m) => m * base >= raw);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}
