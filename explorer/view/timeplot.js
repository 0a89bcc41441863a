// Tilt and turn of the contact point over the clock of the screen, both sides of F on one picture.

import { Chart, dot, line, superscript, text } from "./chart.js";
import { CHI, CLOCK, T, stateAt, tiltOf, turningState } from "./physics.js";

// Height of the upper plot as a share, and the space between the two.
const SHARE = 0.46;
const GAP = 26;
const MOST_POINTS = 1500;

export class TimePlot {
  constructor(canvas) {
    this.chart = new Chart(canvas, [20, 52, 34, 52]);
  }

  /** paths: [shown, ghost]; numbers: readouts of the shown motion. */
  load(paths, numbers) {
    const [main] = paths;
    this.paths = paths;
    this.numbers = numbers;
    this.end = main.states[main.states.length - 1][CLOCK];
    this.curves = paths.map((path) => thin(path).map((x) => [x[CLOCK], tiltOf(x, path.motion.face), x[CHI]]));
    const all = this.curves.flat().filter(([clock]) => clock <= this.end);
    this.lowest = Math.min(-1, Math.floor(Math.log10(Math.min(...all.map((point) => point[1]))) - 0.15));
    const chi = all.map((point) => point[2]);
    const room = 0.06 * (Math.max(...chi) - Math.min(...chi)) + 0.3;
    this.chi = [Math.min(...chi) - room, Math.max(...chi) + room];
    this.chart.stale = true;
  }

  x(clock) {
    const { left, width } = this.chart.box;
    return left + (width * clock) / this.end;
  }

  yTilt(tilt) {
    const { top, height } = this.chart.box;
    const highest = Math.log10(Math.PI);
    return top + (SHARE * height - GAP / 2) * ((highest - Math.log10(tilt)) / (highest - this.lowest));
  }

  yChi(chi) {
    const { bottom, height } = this.chart.box;
    return bottom - ((1 - SHARE) * height - GAP / 2) * ((chi - this.chi[0]) / (this.chi[1] - this.chi[0]));
  }

  clockAt(pixel) {
    const { left, width } = this.chart.box;
    return Math.min(1, Math.max(0, (pixel - left) / width)) * this.end;
  }

  draw(states, look) {
    this.chart.draw((context) => this.drawStill(context, look), (context) => this.drawNow(context, states, look));
  }

  drawStill(context, look) {
    const { box } = this.chart;
    text(context, "tilt θ from flat (rad); drag to move in time", box.left, box.top - 10, look.ink);
    text(context, "angle χ of the point of contact", box.left, this.yChi(this.chi[1]) - 10, look.ink);
    this.drawTiltAxis(context, look);
    this.drawChiAxis(context, look);
    this.drawTimes(context, look);
    context.save();
    context.beginPath();
    context.rect(box.left, box.top - 4, box.width, box.height + 8);
    context.clip();
    const drawCurve = (curve, n) => {
      const colour = look.sideColours[n], width = n ? 7 : 2.4;
      context.globalAlpha = n ? 0.35 : 1;
      line(context, curve.map((point) => [this.x(point[0]), this.yTilt(point[1])]), colour, width);
      line(context, curve.map((point) => [this.x(point[0]), this.yChi(point[2])]), colour, width);
    };
    drawCurve(this.curves[1], 1);
    drawCurve(this.curves[0], 0);
    context.restore();
    this.drawRace(context, look);
  }

  drawTiltAxis(context, look) {
    const { box } = this.chart;
    const every = Math.ceil(-this.lowest / 5);
    for (let power = 0; power >= this.lowest; power -= every) {
      const y = this.yTilt(10 ** power);
      line(context, [[box.left, y], [box.right, y]], look.grid);
      text(context, power ? `10${superscript(power)}` : "1", box.left - 6, y, look.soft, "right");
    }
  }

  drawChiAxis(context, look) {
    const { box } = this.chart;
    const span = (this.chi[1] - this.chi[0]) / Math.PI;
    const every = Math.max(1, Math.ceil(span / 8));
    for (let n = Math.ceil(this.chi[0] / Math.PI / every) * every; n * Math.PI <= this.chi[1]; n += every) {
      const y = this.yChi(n * Math.PI);
      line(context, [[box.left, y], [box.right, y]], n ? look.grid : look.axis);
      const label = n === 0 ? "0" : `${n < 0 ? "−" : ""}${Math.abs(n) === 1 ? "" : Math.abs(n)}π`;
      text(context, label, box.left - 6, y, look.soft, "right");
    }
  }

  /** Marks of real time under the clock, which runs slower near flat. */
  drawTimes(context, look) {
    const { box } = this.chart;
    const [main] = this.paths;
    const last = main.states[main.states.length - 1][T];
    const every = last > 60 ? 20 : last > 24 ? 5 : last > 12 ? 2 : 1;
    for (let t = 0; t <= last; t += every) {
      const x = this.x(stateAt(main, T, t)[CLOCK]);
      line(context, [[x, box.bottom], [x, box.bottom + 5]], look.soft);
      text(context, String(t), x, box.bottom + 8, look.soft, "center", "top");
    }
    line(context, [[box.left, box.bottom], [box.right, box.bottom]], look.axis);
    text(context, "time t, in √(r/g); near flat it is stretched", box.right, box.bottom + 22, look.soft, "right", "top");
  }

  /** The first race: from where both sides still agree to +-kappa pi. */
  drawRace(context, look) {
    const { paths, numbers } = this;
    const [main] = paths;
    if (!main.turns.length || !Number.isFinite(numbers.fall_angle)) return;
    const turn = turningState(main, 0);
    const limit = Math.abs(numbers.limit);
    const before = turn[CHI] - 0.5 * numbers.race_angle;
    const from = this.x(turn[CLOCK]);
    const to = this.chart.box.right;
    [1, -1].forEach((side) => {
      const at = before + side * limit, y = this.yChi(at);
      if (at < this.chi[0] || at > this.chi[1]) return;
      line(context, [[from, y], [to, y]], side > 0 ? look.plus : look.minus, 1.3, [5, 4]);
      text(context, side > 0 ? "+κπ" : "−κπ", to + 6, y, side > 0 ? look.plusInk : look.minusInk);
    });
    line(context, [[from, this.yChi(before)], [to, this.yChi(before)]], look.soft, 1, [2, 4]);
    text(context, "fall", to + 6, this.yChi(before), look.soft);
  }

  drawNow(context, states, look) {
    const { box } = this.chart;
    const x = this.x(states[0][CLOCK]);
    line(context, [[x, box.top - 4], [x, box.bottom]], look.ink, 1);
    [1, 0].forEach((n) => {
      if (!states[n]) return;
      const colour = look.sideColours[n];
      dot(context, x, this.yTilt(tiltOf(states[n], this.paths[n].motion.face)), n ? 4 : 5, colour, look.paper);
      dot(context, x, this.yChi(states[n][CHI]), n ? 4 : 5, colour, look.paper);
    });
  }
}

/** At most MOST_POINTS states, evenly through the clock, and those at the turning points. */
function thin(path) {
  const { states, turns } = path;
  const step = states[states.length - 1][CLOCK] / MOST_POINTS;
  const kept = [];
  const sharp = new Set(turns);
  states.forEach((x, n) => {
    const far = !kept.length || Math.abs(x[CLOCK] - kept[kept.length - 1][CLOCK]) >= step;
    if (far || sharp.has(n) || n === states.length - 1) kept.push(x);
  });
  return kept;
}
