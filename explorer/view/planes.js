// Two maps on which the start can be dragged: the plane of the constants with F, and the portrait of the tilt.

import { lineSlope, solutions } from "./chaplygin.js";
import { Chart, FONT, dot, line, text, ticks } from "./chart.js";
import { P, Q, Z, etaAt } from "./physics.js";
import { LARGEST, SMALLEST, sigma4Bar } from "./state.js";

const REACH = 2.5; // of the plane, in sqrt(g/r)
// Around F the distance is drawn by decades: SMALLEST ... BAND lies between EDGE and BAND of the plane, so that
// two points on the two sides never hide each other.
const BAND = 0.3;
const EDGE = 0.09;

/** Distance to F as it is drawn: by decades up to BAND, true beyond. */
export function stretched(etaHat) {
  const size = Math.abs(etaHat);
  if (size >= BAND) return etaHat;
  const share = Math.max(0, Math.log10(size / SMALLEST) / Math.log10(BAND / SMALLEST));
  return Math.sign(etaHat) * (EDGE + (BAND - EDGE) * share);
}

/** The inverse; on the line itself it is 0. */
export function unstretched(drawn) {
  const size = Math.abs(drawn);
  const side = drawn < 0 ? -1 : 1;
  if (size >= BAND) return drawn;
  if (size < EDGE / 3) return 0;
  const share = Math.max(0, size - EDGE) / (BAND - EDGE);
  return side * SMALLEST * (BAND / SMALLEST) ** share;
}

export class ConstantsPlane {
  constructor(canvas) {
    this.chart = new Chart(canvas, [22, 10, 34, 40]);
  }

  load(shown, body) {
    this.shown = shown;
    this.body = body;
    this.reach = Math.max(REACH, 1.15 * Math.abs(shown.sigma3_bar), 1.15 * Math.abs(sigma4Bar(shown, body)));
    this.chart.stale = true;
  }

  toPixel(s3, s4) {
    const { box } = this.chart;
    return [
      box.left + (box.width * (s3 + this.reach)) / (2 * this.reach),
      box.bottom - (box.height * (s4 + this.reach)) / (2 * this.reach),
    ];
  }

  fromPixel(x, y) {
    const { box } = this.chart;
    const share = (v) => Math.min(1, Math.max(0, v));
    return [
      (2 * share((x - box.left) / box.width) - 1) * this.reach,
      (2 * share((box.bottom - y) / box.height) - 1) * this.reach,
    ];
  }

  /** Where a motion at this distance is drawn. */
  place(etaHat) {
    const { sigma3_bar, face } = this.shown;
    return this.toPixel(sigma3_bar, face * (lineSlope(this.body) * sigma3_bar - stretched(etaHat)));
  }

  /** What dragging the point to a pixel means. */
  drag(x, y) {
    const [s3, s4] = this.fromPixel(x, y);
    const drawn = lineSlope(this.body) * s3 - this.shown.face * s4;
    const etaHat = unstretched(drawn);
    return { sigma3_bar: s3, eta_hat: Math.sign(etaHat) * Math.min(LARGEST, Math.abs(etaHat)) };
  }

  draw(look) {
    this.chart.draw((context) => this.drawStill(context, look), (context) => this.drawNow(context, look));
  }

  drawStill(context, look) {
    const { box } = this.chart;
    const slope = lineSlope(this.body) * this.shown.face;
    const end = this.reach;
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, box.width, box.height);
    context.clip();
    // eta > 0 lies below l+ and above l-.
    [1, -1].forEach((side) => {
      const up = -side * this.shown.face;
      context.fillStyle = look.tints[side];
      context.beginPath();
      for (const [a, b] of [[-end, -slope * end], [end, slope * end], [end, up * 9 * end], [-end, up * 9 * end]]) {
        context.lineTo(...this.toPixel(a, b));
      }
      context.fill();
    });
    for (const v of ticks(-end, end, 5)) {
      line(context, [this.toPixel(v, -end), this.toPixel(v, end)], v ? look.grid : look.axis);
      line(context, [this.toPixel(-end, v), this.toPixel(end, v)], v ? look.grid : look.axis);
    }
    line(context, [this.toPixel(-end, slope * end), this.toPixel(end, -slope * end)], look.soft, 1.5, [6, 4]);
    line(context, [this.toPixel(-end, -slope * end), this.toPixel(end, slope * end)], look.ink, 2.5);
    context.restore();
    for (const v of ticks(-end, end, 5)) {
      const label = (v < 0 ? "−" : "") + Math.abs(v);
      text(context, label, this.toPixel(v, -end)[0], box.bottom + 5, look.soft, "center", "top");
      text(context, label, box.left - 5, this.toPixel(-end, v)[1], look.soft, "right");
    }
    text(context, "σ̄₄", 4, box.top - 11, look.ink);
    text(context, "stretched near F", 4, box.bottom + 20, look.ink, "left", "top");
    text(context, "σ̄₃ in √(g/r)", box.right, box.bottom + 20, look.ink, "right", "top");
    text(context, "drag the dot: on F it falls flat", box.right, box.top - 11, look.ink, "right");
    const { face } = this.shown;
    const [lx, ly] = this.toPixel(-0.82 * end, -0.82 * slope * end);
    context.font = `italic 700 16px ${FONT.slice(5)}`;
    text(context, "F", lx + 4, ly - 14 * face, look.ink, "center");
    context.font = FONT;
    const [ox, oy] = this.toPixel(0.5 * end, -0.5 * slope * end);
    text(context, `F, face ${face > 0 ? "−" : "+"}`, ox - 6, oy + 12 * face, look.soft, "right");
    text(context, "η > 0", box.right - 8, face > 0 ? box.bottom - 14 : box.top + 14, look.plusInk, "right");
    text(context, "η < 0", box.left + 8, face > 0 ? box.top + 14 : box.bottom - 14, look.minusInk, "left");
  }

  drawNow(context, look) {
    const { eta_hat, ghost } = this.shown;
    if (ghost && eta_hat) dot(context, ...this.place(-eta_hat), 5, look.paper, look.sideColours[1]);
    dot(context, ...this.place(eta_hat), 7, look.sideColours[0], look.paper);
  }
}

const TILTS = Array.from({ length: 361 }, (_, n) => -0.5 * Math.PI + (Math.PI * (n + 0.5)) / 361);
const LEVELS = 7;

/** Amended potential at tilts phi for the constants of a motion, eq. (3.8). */
function potential(phi, motion) {
  const { body } = motion;
  const q = Math.cos(phi), z = Math.sin(phi);
  const larger = 1 + Math.abs(z);
  const f = solutions((q * q) / larger, 2 * Math.log(q) - Math.log(larger), body);
  const X = motion.sigma3_bar / body.r0, Y = etaAt(z, motion) / body.I1;
  const rho = X * f.rhoOverS * (q / larger) + (Y * f.D) / q;
  const sigma4 = (X * f.drho + Y * f.dD) / body.k;
  return 0.5 * body.I1 * rho * rho + 0.5 * body.J * sigma4 * sigma4 + q;
}

export class Portrait {
  constructor(canvas) {
    this.chart = new Chart(canvas, [22, 10, 34, 40]);
  }

  load(shown, paths) {
    this.shown = shown;
    this.paths = paths;
    const motion = paths[0].motion;
    const { body } = motion;
    this.V = TILTS.map((phi) => potential(phi, motion));
    const fastest = Math.max(...paths[0].states.map((x) => Math.abs(x[P])));
    this.reach = Math.max(2, 1.2 * fastest);
    const bottom = Math.min(...this.V);
    this.levels = Array.from({ length: LEVELS }, (_, n) => bottom + 0.5 * body.M * (((n + 0.6) * this.reach) / LEVELS) ** 2);
    this.orbits = paths.map((path) => orbitOf(path));
    this.chart.stale = true;
  }

  toPixel(phi, phidot) {
    const { box } = this.chart;
    return [
      box.left + box.width * (0.5 + phi / Math.PI),
      box.bottom - (box.height * (phidot + this.reach)) / (2 * this.reach),
    ];
  }

  /** The pieces of a level of the energy as (phi, |phidot|), closed where the speed is 0. */
  level(energy) {
    const pieces = [];
    let piece = null;
    TILTS.forEach((phi, n) => {
      const left = energy - this.V[n], before = n ? energy - this.V[n - 1] : left;
      if (left > 0 !== before > 0) {
        const turn = TILTS[n - 1] + ((phi - TILTS[n - 1]) * before) / (before - left);
        if (left > 0) pieces.push((piece = [[turn, 0]]));
        else piece.push([turn, 0]);
      }
      if (left <= 0) return;
      if (!piece || !pieces.length) pieces.push((piece = []));
      piece.push([phi, Math.sqrt((2 * left) / this.paths[0].motion.body.M)]);
    });
    return pieces;
  }

  /** Start of a motion as (phi, phidot); phidot counts upwards, the motion's own towards its face. */
  startPixel() {
    const { theta, phidot, face } = this.shown;
    return this.toPixel(face * (0.5 * Math.PI - theta), face * phidot);
  }

  /** What dragging the start to a pixel means: close to the vertical it is exactly there. */
  drag(x, y) {
    const { box } = this.chart;
    const { face } = this.shown;
    const limit = 0.47 * Math.PI;
    let phi = Math.min(limit, Math.max(-limit, ((x - box.left) / box.width - 0.5) * Math.PI));
    if (Math.abs(phi) < 0.06) phi = 0;
    const share = Math.min(1, Math.max(0, (box.bottom - y) / box.height));
    const phidot = face * (2 * share - 1) * this.reach;
    return { theta: 0.5 * Math.PI - face * phi, phidot };
  }

  draw(states, look) {
    this.chart.draw((context) => this.drawStill(context, look), (context) => this.drawNow(context, states, look));
  }

  drawStill(context, look) {
    const { box } = this.chart;
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, box.width, box.height);
    context.clip();
    context.fillStyle = look.panel;
    context.fill();
    for (const level of this.levels) {
      for (const way of [1, -1]) {
        for (const piece of this.level(level)) {
          line(context, piece.map(([phi, speed]) => this.toPixel(phi, way * speed)), look.level);
        }
      }
    }
    line(context, [this.toPixel(-2, 0), this.toPixel(2, 0)], look.axis);
    line(context, [this.toPixel(0, -99), this.toPixel(0, 99)], look.axis);
    context.globalAlpha = 0.35;
    line(context, this.orbits[1].map(([a, b]) => this.toPixel(a, b)), look.sideColours[1], 7);
    context.globalAlpha = 1;
    line(context, this.orbits[0].map(([a, b]) => this.toPixel(a, b)), look.sideColours[0], 2.4);
    context.restore();
    for (const [phi, label] of [[-0.5, "−π/2"], [0, "0"], [0.5, "π/2"]]) {
      const align = phi < 0 ? "left" : phi > 0 ? "right" : "center";
      text(context, label, this.toPixel(phi * Math.PI, 0)[0], box.bottom + 5, look.soft, align, "top");
    }
    for (const v of ticks(-this.reach, this.reach, 4)) {
      text(context, (v < 0 ? "−" : "") + Math.abs(v), box.left - 5, this.toPixel(0, v)[1], look.soft, "right");
    }
    text(context, "φ̇", 8, box.top - 11, look.ink);
    text(context, "φ: 0 upright, ±π/2 flat", box.right, box.bottom + 20, look.ink, "right", "top");
    text(context, "drag the ring: tilt, speed", box.right, box.top - 11, look.ink, "right");
  }

  drawNow(context, states, look) {
    const at = (x) => this.toPixel(Math.atan2(x[Z], x[Q]), -x[P]);
    dot(context, ...this.startPixel(), 6, look.paper, look.ink);
    if (states[1]) dot(context, ...at(states[1]), 4.5, look.paper, look.sideColours[1]);
    dot(context, ...at(states[0]), 5, look.sideColours[0], look.paper);
  }
}

/** (phi, phidot) along a motion, without the many points at which nothing moves. */
function orbitOf(path) {
  const orbit = [];
  for (const x of path.states) {
    const at = [Math.atan2(x[Z], x[Q]), -x[P]];
    const last = orbit[orbit.length - 1];
    if (!last || Math.hypot(at[0] - last[0], at[1] - last[1]) > 0.01) orbit.push(at);
  }
  return orbit;
}
