// A ruler in decades for the height of the far edge above the table, and on it the wall that keeps a disk from flat.

import { Chart, dot, line, text } from "./chart.js";
import { point } from "./passage.js";
import { FLAT, Q, energy } from "./physics.js";
import { RADIUS } from "./scenes.js";

const WIDTH = 2 * RADIUS; // m
const LEAST = -18, MOST = -1; // powers of ten of metres
const THINGS = [[1e-14, "nucleus"], [2e-10, "atom"], [7e-5, "hair"]];
const UNITS = [[-15, "1 fm"], [-12, "1 pm"], [-9, "1 nm"], [-6, "1 µm"], [-3, "1 mm"]];
const HIGHEST = 1.35; // of the plot of the wall, in energies of the disk
const POINTS = 400;

export class Ruler {
  /** kind: "ruler", or "wall" with the wall over it. */
  constructor(canvas, kind) {
    this.wall = kind === "wall";
    canvas.classList.add(kind);
    this.chart = new Chart(canvas, [this.wall ? 26 : 34, 12, 24, 12]);
  }

  load({ main, numbers }) {
    const { motion, states } = main;
    this.motion = motion;
    this.energy = energy(states[0], motion.body);
    this.lowest = Math.log10(WIDTH * Math.sin(numbers.theta_min));
    this.hill = Array.from({ length: POINTS + 1 }, (_, n) => {
      const place = LEAST + ((MOST - LEAST) * n) / POINTS;
      return [place, this.height(10 ** place / WIDTH)];
    });
    this.chart.stale = true;
  }

  /** The amended potential at a tilt of this sine, in energies of the disk. */
  height(sine) {
    const { body, sigma3_bar, eta } = this.motion, h = 2 * Math.sin(0.5 * Math.asin(Math.min(1, sine)));
    return point(h, sigma3_bar / body.r0, eta / body.I1, body).V / this.energy;
  }

  x(place) {
    const { left, width } = this.chart.box;
    return left + (width * (Math.max(LEAST, place) - LEAST)) / (MOST - LEAST);
  }

  y(height) {
    const { bottom, height: whole } = this.chart.box;
    return this.wall ? bottom - (whole * Math.min(height, 2 * HIGHEST)) / HIGHEST : bottom;
  }

  draw(state, look) {
    this.chart.draw((context) => this.drawStill(context, look), (context) => this.drawNow(context, state, look));
  }

  drawStill(context, look) {
    const { box } = this.chart;
    for (let power = LEAST; power <= MOST; power++) {
      const x = this.x(power), long = power % 3 === 0;
      line(context, [[x, box.bottom], [x, box.bottom + (long ? 7 : 4)]], look.soft);
    }
    for (const [power, unit] of UNITS) {
      text(context, unit, this.x(power), box.bottom + 10, look.soft, "center", "top");
    }
    for (const [size, thing] of THINGS) {
      const x = this.x(Math.log10(size));
      line(context, [[x, box.top - 8], [x, box.bottom]], look.axis, 1, [2, 3]);
      text(context, thing, x, box.top - 16, look.ink, "center");
    }
    text(context, "← flat", box.left, box.top - 16, look.soft);
    if (this.wall) this.drawWall(context, look);
    line(context, [[box.left, box.bottom], [box.right, box.bottom]], look.soft, 1.5);
  }

  drawWall(context, look) {
    const { box } = this.chart;
    const curve = this.hill.map(([place, height]) => [this.x(place), this.y(height)]);
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, box.width, box.height);
    context.clip();
    context.fillStyle = look.grid;
    context.beginPath();
    for (const [x, y] of [[box.left, box.bottom], ...curve, [box.right, box.bottom]]) context.lineTo(x, y);
    context.fill();
    line(context, curve, look.sideColours[0], 2.5);
    context.restore();
    line(context, [[box.left, this.y(1)], [box.right, this.y(1)]], look.soft, 1, [5, 4]);
    text(context, "energy it has", box.left + 8, this.y(1) - 10, look.ink);
    if (Number.isFinite(this.lowest)) text(context, "energy needed", box.left + 8, this.y(0.25), look.soft);
  }

  drawNow(context, state, look) {
    const { box } = this.chart;
    const flat = !this.motion.eta && state[Q] < FLAT; // the fall on F is over, past all marks
    const place = flat ? LEAST : Math.log10(WIDTH * state[Q]);
    if (!this.wall && Number.isFinite(this.lowest)) {
      line(context, [[this.x(this.lowest), box.bottom], [box.right, box.bottom]], look.sideColours[0], 5);
    }
    const height = this.wall ? this.y(this.height(state[Q])) : box.bottom;
    dot(context, this.x(place), height, 7, look.sideColours[0], look.paper);
    if (flat) text(context, "past all marks: flat", this.x(place) + 12, height - 14, look.ink);
  }
}
