// A canvas with two axes: where a number lies, ticks, words, curves.
import { colour, number } from "./dom.js";

const EDGE = { left: 58, right: 8, top: 8, bottom: 36 };

export class Axes {
  // `box`: least and largest x, least and largest y; `words` of both axes.
  constructor(canvas, height, box, words) {
    const ratio = devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio; canvas.height = height * ratio; canvas.style.height = `${height}px`;
    this.ctx = canvas.getContext("2d"); this.ctx.scale(ratio, ratio);
    this.box = box; this.height = height;
    this.wide = canvas.clientWidth - EDGE.left - EDGE.right; this.high = height - EDGE.top - EDGE.bottom;
    this.frame(words);
  }

  static around(xs, ys) {
    const ends = (values) => {
      let low = Infinity, high = -Infinity;
      for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
      const more = 0.05 * (high - low) || Math.abs(high) || 1;
      return [low - more, high + more];
    };
    return [...ends(xs), ...ends(ys)];
  }

  x(v) { return EDGE.left + (v - this.box[0]) / (this.box[1] - this.box[0]) * this.wide; }
  y(v) { return EDGE.top + (this.box[3] - v) / (this.box[3] - this.box[2]) * this.high; }
  toX(px) { return this.box[0] + (px - EDGE.left) / this.wide * (this.box[1] - this.box[0]); }
  toY(px) { return this.box[3] - (px - EDGE.top) / this.high * (this.box[3] - this.box[2]); }

  clip() { this.ctx.beginPath(); this.ctx.rect(EDGE.left, EDGE.top, this.wide, this.high); this.ctx.clip(); }

  // A picture over the whole of the axes.
  picture(image) {
    this.ctx.imageSmoothingEnabled = false;
    this.ctx.drawImage(image, EDGE.left, EDGE.top, this.wide, this.high);
  }

  path(xs, ys, tint, width, dash = []) {
    const { ctx } = this;
    ctx.strokeStyle = colour(tint); ctx.lineWidth = width; ctx.setLineDash(dash);
    ctx.beginPath(); xs.forEach((v, i) => ctx.lineTo(this.x(v), this.y(ys[i]))); ctx.stroke();
    ctx.setLineDash([]);
  }

  band(from, to, tint) {
    const a = Math.max(Math.min(from, to), EDGE.left), b = Math.min(Math.max(from, to), EDGE.left + this.wide);
    this.ctx.save(); this.ctx.globalAlpha = 0.3; this.ctx.fillStyle = colour(tint);
    this.ctx.fillRect(a, EDGE.top, Math.max(b - a, 1), this.high); this.ctx.restore();
  }

  upright(v) { line(this.ctx, this.x(v), EDGE.top, this.x(v), EDGE.top + this.high); }

  frame([across, up]) {
    const { ctx } = this, [left, right, low, high] = this.box, foot = EDGE.top + this.high;
    ctx.strokeStyle = colour("line"); ctx.fillStyle = colour("ink"); ctx.font = "12px system-ui"; ctx.lineWidth = 1;
    ctx.strokeRect(EDGE.left, EDGE.top, this.wide, this.high);
    ctx.textAlign = "center";
    for (const v of ticks(left, right)) { ctx.fillText(number(v), this.x(v), foot + 14); line(ctx, this.x(v), foot, this.x(v), foot - 4); }
    ctx.fillText(across, EDGE.left + this.wide / 2, this.height - 6);
    ctx.textAlign = "right";
    for (const v of ticks(low, high)) { ctx.fillText(number(v), EDGE.left - 6, this.y(v) + 4); line(ctx, EDGE.left, this.y(v), EDGE.left + 4, this.y(v)); }
    ctx.save(); ctx.translate(12, EDGE.top + this.high / 2); ctx.rotate(-Math.PI / 2); ctx.textAlign = "center";
    ctx.fillText(up, 0, 0); ctx.restore();
    if (left < 0 && right > 0) this.upright(0);
    if (low < 0 && high > 0) line(ctx, EDGE.left, this.y(0), EDGE.left + this.wide, this.y(0));
  }
}

function line(ctx, a, b, c, d) { ctx.beginPath(); ctx.moveTo(a, b); ctx.lineTo(c, d); ctx.stroke(); }

function ticks(low, high, about = 5) {
  const raw = (high - low) / about, base = 10 ** Math.floor(Math.log10(raw));
  const step = base * [1, 2, 5, 10].find((m) => m * base >= raw * (1 - 1e-9));
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high && found.length < 20; k++) found.push(Number((k * step).toPrecision(12)));
  return found;
}
