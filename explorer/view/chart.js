// What all plots share: a canvas with axes, a still part that is drawn once and a moving part on top.

export const FONT = "12px system-ui, -apple-system, 'Segoe UI', 'Noto Sans', sans-serif";
const SUPERSCRIPTS = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** A number with a true minus sign, and a power of ten where it is very large or small. */
export function format(value, digits = 4, plus = false) {
  if (Number.isNaN(value)) return "–";
  const sign = value < 0 ? "−" : plus ? "+" : "";
  const size = Math.abs(value);
  if (size === Infinity) return `${sign}∞`;
  if (size !== 0 && (size < 1e-2 || size >= 1e5)) {
    const [mantissa, exponent] = size.toExponential(digits - 1).split("e");
    return `${sign}${mantissa}·10${superscript(Number(exponent))}`;
  }
  return sign + (size === 0 ? "0" : size.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size)))));
}

/** A length below a metre in words, or a time below a second with `unit` "s". */
export function lengthWords(length, unit = "m") {
  const parts = [[1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"], [1e-15, "f"]];
  const [part, name] = parts.find(([size]) => length >= size) ?? parts[parts.length - 1];
  return `${format(length / part, 2)} ${name}${unit}`;
}

export function superscript(whole) {
  return String(whole).replace("-", "⁻").replace(/\d/g, (digit) => SUPERSCRIPTS[digit]);
}

/** Round steps for an axis: 1, 2 or 5 times a power of ten, about `count` of them. */
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((n) => n >= rough);
  const found = [];
  for (let n = Math.ceil(low / step); n * step <= high * (1 + 1e-12); n++) found.push(n * step);
  return found;
}

/** A canvas that knows its size in CSS pixels and keeps a still picture under what moves. */
export class Chart {
  constructor(canvas, margins) {
    this.canvas = canvas;
    this.margins = margins;
    this.still = document.createElement("canvas");
    this.stale = true;
  }

  /** The area of the plot inside its margins, CSS pixels. */
  get box() {
    const [top, right, bottom, left] = this.margins;
    return {
      left, top,
      right: this.canvas.clientWidth - right,
      bottom: this.canvas.clientHeight - bottom,
      width: this.canvas.clientWidth - right - left,
      height: this.canvas.clientHeight - bottom - top,
    };
  }

  /** Draw `still` where it is out of date, then `moving` over it. */
  draw(still, moving) {
    const { canvas } = this;
    // Hidden, or in a frame that has no room yet: browsers refuse to copy a canvas of no size.
    if (!canvas.width || !canvas.height) return;
    const ratio = canvas.width / canvas.clientWidth;
    if (this.stale || this.still.width !== canvas.width || this.still.height !== canvas.height) {
      this.still.width = canvas.width;
      this.still.height = canvas.height;
      const context = this.still.getContext("2d");
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.font = FONT;
      still(context);
      this.stale = false;
    }
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(this.still, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = FONT;
    moving(context);
  }
}

export function line(context, points, colour, width = 1, dash = []) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineJoin = "round";
  context.setLineDash(dash);
  context.beginPath();
  points.forEach(([x, y], n) => (n ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
  context.setLineDash([]);
}

export function text(context, words, x, y, colour, align = "left", baseline = "middle") {
  context.fillStyle = colour;
  context.textAlign = align;
  context.textBaseline = baseline;
  context.fillText(words, x, y);
}

export function dot(context, x, y, radius, fill, edge) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fillStyle = fill;
  context.fill();
  context.strokeStyle = edge;
  context.lineWidth = 2;
  context.stroke();
}
