// Two pens with the same strokes: on a canvas, and as SVG text.

/** Where things are drawn: centre [m], scale [px/m], size [px]; y points up unless `down`. */
export class View {
  constructor() {
    Object.assign(this, { x: 0, y: 0, scale: 40, width: 600, height: 400, down: false });
  }

  fit([left, bottom, right, top]) {
    this.x = (left + right) / 2;
    this.y = (bottom + top) / 2;
    this.scale = Math.min(this.width / (right - left), this.height / (top - bottom));
  }

  /** Pixels of a place [m]. */
  at([x, y]) {
    const up = this.down ? 1 : -1;
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 + up * (y - this.y) * this.scale];
  }

  /** Place [m] of pixels. */
  place(px, py) {
    const up = this.down ? 1 : -1;
    return [this.x + (px - this.width / 2) / this.scale, this.y + (up * (py - this.height / 2)) / this.scale];
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const before = this.place(px, py);
    this.scale = Math.max(0.01, Math.min(4000, this.scale * factor));
    const after = this.place(px, py);
    this.x += before[0] - after[0];
    this.y += before[1] - after[1];
  }
}

export class CanvasPen {
  constructor(context, view) {
    this.context = context;
    this.view = view;
  }

  line(points, { colour, width = 1, dash = [], opacity = 1, closed = false }) {
    if (points.length < 2) return;
    const c = this.context;
    c.beginPath();
    points.forEach((point, i) => c[i ? "lineTo" : "moveTo"](...this.view.at(point)));
    if (closed) c.closePath();
    c.globalAlpha = opacity;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.stroke();
    c.globalAlpha = 1;
  }

  /** A disc; the radius is in pixels. */
  disc(point, radius, { fill = null, stroke = null, width = 1, opacity = 1 }) {
    const c = this.context;
    c.beginPath();
    c.arc(...this.view.at(point), radius, 0, 2 * Math.PI);
    this._finish(fill, stroke, width, opacity);
  }

  /** A square around a place; half its side is in pixels. */
  square(point, half, { fill = null, stroke = null, width = 1, opacity = 1 }) {
    const [x, y] = this.view.at(point);
    this.context.beginPath();
    this.context.rect(x - half, y - half, 2 * half, 2 * half);
    this._finish(fill, stroke, width, opacity);
  }

  text(point, words, { colour, dx = 0, dy = 0 }) {
    const [x, y] = this.view.at(point);
    this.context.font = "11px system-ui, sans-serif";
    this.context.fillStyle = colour;
    this.context.fillText(words, x + dx, y + dy);
  }

  picture(image, [left, bottom, right, top]) {
    const [x, y] = this.view.at([left, this.view.down ? bottom : top]);
    const { scale } = this.view;
    if (this.view.down) {
      this.context.save();
      this.context.translate(x, y + (top - bottom) * scale);
      this.context.scale(1, -1);
      this.context.drawImage(image, 0, 0, (right - left) * scale, (top - bottom) * scale);
      this.context.restore();
    } else this.context.drawImage(image, x, y, (right - left) * scale, (top - bottom) * scale);
  }

  _finish(fill, stroke, width, opacity) {
    const c = this.context;
    c.globalAlpha = opacity;
    c.setLineDash([]);
    if (fill) {
      c.fillStyle = fill;
      c.fill();
    }
    if (stroke) {
      c.strokeStyle = stroke;
      c.lineWidth = width;
      c.stroke();
    }
    c.globalAlpha = 1;
  }
}

export class SvgPen {
  constructor(view, background) {
    this.view = view;
    this.parts = [`<rect width="${view.width}" height="${view.height}" fill="${background}"/>`];
  }

  line(points, { colour, width = 1, dash = [], opacity = 1, closed = false }) {
    if (points.length < 2) return;
    const words = points.map((point) => this.view.at(point).map(short).join(",")).join(" ");
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    const tag = closed ? "polygon" : "polyline";
    this.parts.push(`<${tag} points="${words}" fill="none" stroke="${colour}" stroke-width="${width}"${dashes}${faint(opacity)}/>`);
  }

  disc(point, radius, look) {
    const [x, y] = this.view.at(point).map(short);
    this.parts.push(`<circle cx="${x}" cy="${y}" r="${short(radius)}"${paint(look)}/>`);
  }

  square(point, half, look) {
    const [x, y] = this.view.at(point);
    this.parts.push(`<rect x="${short(x - half)}" y="${short(y - half)}" width="${short(2 * half)}" height="${short(2 * half)}"${paint(look)}/>`);
  }

  text(point, words, { colour, dx = 0, dy = 0 }) {
    const [x, y] = this.view.at(point);
    const safe = words.replace(/[&<>"]/g, (one) => `&#${one.charCodeAt(0)};`);
    this.parts.push(`<text x="${short(x + dx)}" y="${short(y + dy)}" fill="${colour}" font-size="11" font-family="sans-serif">${safe}</text>`);
  }

  picture() {} // SVG files hold lines only

  toString() {
    const { width, height } = this.view;
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">\n${this.parts.join("\n")}\n</svg>\n`;
  }
}

const short = (number) => Math.round(number * 100) / 100;
const faint = (opacity) => (opacity === 1 ? "" : ` opacity="${short(opacity)}"`);

function paint({ fill = null, stroke = null, width = 1, opacity = 1 }) {
  const edge = stroke ? ` stroke="${stroke}" stroke-width="${width}"` : "";
  return ` fill="${fill ?? "none"}"${edge}${faint(opacity)}`;
}
