// The numbers of the page and the gauge of the race.

import { Chart, dot, format, lengthWords, line, text } from "./chart.js";
import { slowing, tiltOf } from "./physics.js";

const $ = (id) => document.getElementById(id);
const SHOWN_SLOWED = 1.5;
const DEGREES = 180 / Math.PI;

/** The numbers of the motion that is shown; they change only with it. */
export function showNumbers(store) {
  const n = store.numbers;
  $("race").textContent = n.told || format(n.race_angle, 4, true);
  $("told").textContent = n.told;
  const side = { 1: "+", [-1]: "−", 0: "±" }[Math.sign(n.limit)];
  const { kappa } = store.body;
  $("limit").textContent = `${side}κπ = ${side}${format(kappa * Math.PI, 4)}, ${(kappa / 2).toFixed(2)} turns`;
  $("theta-min").textContent = format(n.theta_min, 3);
  $("theta-size").textContent = thickness(n.theta_min);
  $("normal").textContent = format(n.min_normal_force, 3);
  const force = n.min_normal_force;
  $("lift").textContent = force < 0 ? "a real disk would lift off" : force === 0 ? "it only just touches" : "";
  $("friction").textContent = format(n.max_friction, 3);
  const most = n.max_friction;
  $("friction-words").textContent = most === Infinity ? "a real disk would slip" : most > 1 ? "more than rubber has" : "";
}

/** How small a tilt is: the gap under the far edge of a disk as wide as a hand. */
function thickness(tilt) {
  if (Number.isNaN(tilt)) return "";
  return `${format(DEGREES * tilt, 3)}°` + (tilt < 0.5 ? `: ${lengthWords(0.1 * tilt)} under a 10 cm disk` : "");
}

/** The words over the picture, which change from frame to frame. */
export function showNow(state, face, races) {
  const factor = slowing(state);
  $("slowing").textContent = factor >= SHOWN_SLOWED ? `${format(factor, factor < 100 ? 2 : 3)}× slowed` : "";
  const tilt = DEGREES * tiltOf(state, face), race = races.find(Boolean);
  $("tilt").textContent = `tilt ${format(tilt, 3)}°${tilt > 90.5 ? ", past upright" : ""}`;
  $("race-word").textContent = race ? `turns in race ${race.turn + 1}:` : "";
  ["race-now", "other-now"].forEach((id, n) => {
    const turned = races[n] && races[n].turned / (2 * Math.PI);
    $(id).textContent = races[n] ? `${turned < 0 ? "−" : "+"}${Math.abs(turned).toFixed(2)}` : "";
  });
}

/** -kappa pi ... +kappa pi as a line, with both sides on it. */
export class Gauge {
  constructor(canvas) {
    this.chart = new Chart(canvas, [4, 26, 14, 26]);
  }

  load(store) {
    this.angles = [store.numbers.race_angle, store.otherNumbers.race_angle];
    this.limit = store.body.kappa * Math.PI;
    this.ghost = store.shown.ghost;
    this.chart.stale = true;
  }

  draw(look) {
    this.chart.draw((context) => {
      const { box } = this.chart;
      const middle = box.top + 0.5 * box.height;
      const widest = 1.25 * Math.max(this.limit, ...this.angles.map((a) => Math.abs(a) || 0));
      const x = (angle) => box.left + 0.5 * box.width * (1 + angle / widest);
      line(context, [[box.left, middle], [box.right, middle]], look.axis, 2);
      line(context, [[x(0), middle - 4], [x(0), middle + 4]], look.soft, 1);
      for (const side of [-1, 1]) {
        const colour = side > 0 ? look.plus : look.minus;
        line(context, [[x(side * this.limit), middle - 8], [x(side * this.limit), middle + 8]], colour, 2);
        text(context, side > 0 ? "+κπ" : "−κπ", x(side * this.limit), box.bottom + 8, look.soft, "center");
      }
      [1, 0].forEach((n) => {
        if (!Number.isFinite(this.angles[n]) || (n && !this.ghost)) return;
        line(context, [[x(0), middle], [x(this.angles[n]), middle]], look.sideColours[n], n ? 2 : 4);
        if (n) dot(context, x(this.angles[n]), middle, 5, look.paper, look.sideColours[n]);
        else dot(context, x(this.angles[n]), middle, 6, look.sideColours[n], look.paper);
      });
      text(context, "0", x(0), box.bottom + 8, look.soft, "center");
    }, () => {});
  }
}
