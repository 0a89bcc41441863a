// One fall as a picture and as a film of six seconds: outlines of the fall, tails of the race, wings of the rises.
//
// Both are painted here on a dark table, from the two motions that the page shows. The picture is the end of the
// film, seen from where the film begins.

import { format } from "./chart.js";
import { drawDisk, drawOutline, drawShadow, drawTail, lampOf, poseOf } from "./disk.js";
import { CHI, CLOCK, slowing, stateAt, tiltOf } from "./physics.js";
import { Scene, raceAt, racesOf } from "./scene.js";

export const SECONDS = 6;
const RISEN = 1.3; // rad of tilt from flat at which a rise is shown as over
const OUTLINES = 8;
const LEAST_TILT = 0.22; // rad, of the outlines
const APART = 0.35; // rad of tilt at which the two disks of a rise have their own colours
const TURNED = 0.3; // rad of the camera from right in front, so that faces of the risen disks are seen
const TITLE = 0.19, AFTER = 0.88; // shares of the film: until when its title is seen, and when the motion is over
const HAIR = 0.05; // of |eta_hat|: a hair's breadth
const GOLD = [227, 184, 80];
const LOOK = {
  table: "#1b2129", tableFar: "#141920", tableEdge: "#07090c", tableLine: "rgba(255, 255, 255, 0.045)",
  faceUp: GOLD, faceDown: [122, 105, 140], markUp: "#6b5520", markDown: "#d8cde0", side: [190, 150, 60],
};
const GROUND = [24, 29, 37];
const PAPER = "#0e1116", INK = "#f4f1ea", SOFT = "#b4bac3", WHITE = [236, 233, 224];
const SIDES = { 1: [74, 168, 232], [-1]: [255, 127, 58] };

const css = (colour) => `rgb(${colour.join(",")})`;
const mixed = (a, b, share) => a.map((v, i) => Math.round(v + share * (b[i] - v)));
const smooth = (x, from, to) => {
  const share = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return share * share * (3 - 2 * share);
};

/** The clock of the screen at which a tilt is passed between two clocks; the first has the smaller tilt. */
export function clockAt(path, tilt, near, far) {
  for (let i = 0; i < 40; i++) {
    const middle = 0.5 * (near + far);
    if (tiltOf(stateAt(path, CLOCK, middle), path.motion.face) < tilt) near = middle;
    else far = middle;
  }
  return near;
}

/** The first fall of a motion and the rise after it, as clocks of the screen; without a rise it ends flat. */
function fallOf(path) {
  const { states, turns, motion } = path;
  const tilt = (n) => tiltOf(states[n], motion.face);
  const last = states.length - 1, turn = turns[0] ?? last;
  // The turning point lies between two steps, and the nearer one may be the first.
  let first = turn > 0 && tilt(turn - 1) < tilt(turn) ? turn - 1 : turn, end = turn;
  while (first > 0 && tilt(first - 1) > tilt(first) && tilt(first) < 0.5 * Math.PI) first--;
  while (end < last && tilt(end + 1) > tilt(end) && tilt(end) < RISEN) end++;
  const [begin, flat, over] = [first, turn, end].map((n) => states[n][CLOCK]);
  const step = (0.5 * Math.PI - LEAST_TILT) / OUTLINES;
  const tilts = Array.from({ length: OUTLINES }, (_, n) => LEAST_TILT + (n + 0.5) * step);
  const between = (far) => tilts.filter((at) => at < tiltOf(stateAt(path, CLOCK, far), motion.face))
    .map((at) => clockAt(path, at, flat, far));
  return { path, begin, flat, over, down: between(begin), up: over > flat ? between(over) : [] };
}

/** What stands over the fall and under its end. */
function wordsOf(etaHat) {
  if (!etaHat) return ["This one starts on F.", "From here nobody can tell."];
  const near = Math.abs(etaHat) < HAIR;
  return near ? ["Two starts, the same but for a hair.", "A hair decides where it rises."]
    : ["Two starts, one on each side of F.", "The side decides where it rises."];
}

export class Film {
  constructor({ main, other, numbers, otherNumbers, body, shown }) {
    this.shown = shown;
    this.inner = body.inner ?? 0;
    this.falls = [main, ...(shown.eta_hat ? [other] : [])].map(fallOf);
    this.races = [racesOf(main, numbers), racesOf(other, otherNumbers)];
    this.sides = this.falls.map((_, n) => SIDES[(n ? -1 : 1) * (Math.sign(shown.eta_hat) || 1)]);
    this.turns = `${Math.abs(numbers.race_angle / (2 * Math.PI)).toFixed(2)} turns`;
    const size = Math.abs(shown.eta_hat), distance = size < 1e-3 ? format(size, 2) : Number(size.toPrecision(3));
    this.about = `nearflat · η̂ = ${size ? "±" : ""}${distance}, κ = ${Number(body.kappa.toFixed(3))}`;
    const { begin, flat, over } = this.falls[0];
    this.middle = over > begin ? (flat - begin) / (over - begin) : 1;
    this.scene = new Scene(document.createElement("canvas"));
    this.flatPose = poseOf(stateAt(main, CLOCK, flat), this.inner);
    // Both contact points at the ends are as far apart as they can be, and the disks open like wings.
    const ends = this.falls.map((fall) => poseOf(stateAt(fall.path, CLOCK, fall.over), this.inner).contact);
    const apart = ends[1] ? [ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]] : [1, 0];
    this.azimuth = Math.atan2(apart[1], apart[0]) + 0.5 * Math.PI + TURNED;
  }

  /** The clock of a motion at a share of its fall and rise: both lie flat at the same moment. */
  clock({ begin, flat, over }, share) {
    if (share <= this.middle) return begin + ((flat - begin) * share) / (this.middle || 1);
    return flat + ((over - flat) * (share - this.middle)) / (1 - this.middle || 1);
  }

  /**
   * The scene from `left` on: `share` of the motion is over, the camera is `far` and aims `high`, or nearer.
   * Returns states.
   */
  drawScene(context, left, width, height, share, near, far, high) {
    const { scene, falls, flatPose, inner } = this;
    const { camera } = scene, { face } = this.shown;
    const clocks = falls.map((fall) => this.clock(fall, share));
    const states = falls.map((fall, n) => stateAt(fall.path, CLOCK, clocks[n]));
    const poses = states.map((x) => poseOf(x, inner));
    const [x, y] = flatPose.centre;
    scene.context = context;
    scene.table = { x, y, radius: 3.4 };
    Object.assign(camera, { azimuth: this.azimuth, elevation: 0.42 + 0.33 * near, zoom: 1 });
    camera.aim = { x, y, z: high - (high + 0.1) * near, radius: far - (far - 1.85) * near };
    camera.frame(width, height);
    context.fillStyle = PAPER;
    context.fillRect(0, 0, left + width, height);
    context.save();
    context.translate(left, 0);
    scene.drawTable(LOOK);
    const lamp = lampOf(camera), thin = 0.0085 * camera.pixels(flatPose.centre);
    poses.forEach((pose) => drawShadow(context, camera, pose, lamp, 1));
    const paintOutlines = (n, moments, colour, strength) => {
      for (const past of moments.filter((at) => at <= clocks[n]).map((at) => stateAt(falls[n].path, CLOCK, at))) {
        drawOutline(context, camera, poseOf(past, inner), colour, strength(tiltOf(past, face)), thin, 0.03);
      }
    };
    paintOutlines(0, falls[0].down, WHITE, (tilt) => (0.75 - 0.45 * near) * (1 - 0.48 * tilt));
    this.racesAt(states).forEach((race, n) => {
      if (race) drawTail(context, camera, states[n][CHI], race, n, this.sides[n], GROUND, 1, true);
    });
    const own = states.map((at) => (share > this.middle ? smooth(tiltOf(at, face), 0.04, APART) : 0));
    context.globalAlpha = own[0];
    if (own[0]) drawDisk(context, camera, flatPose, LOOK, lamp);
    context.globalAlpha = 1;
    falls.forEach((fall, n) => paintOutlines(n, fall.up, this.sides[n], (tilt) => 0.24 + 0.37 * tilt));
    const depths = poses.map((pose) => camera.project(pose.centre)[2]);
    for (const n of depths[1] > depths[0] ? [1, 0] : [0, 1]) {
      if (!poses[n] || (n && !own[0])) continue; // until they part, both are one
      const side = mixed(GOLD, this.sides[n], own[n]), mark = own[n] > 0.5 ? "#fff6" : LOOK.markUp;
      const look = { ...LOOK, faceUp: side, faceDown: side, side, markUp: mark, markDown: mark };
      drawDisk(context, camera, poses[n], look, lamp);
    }
    context.restore();
    return states;
  }

  racesAt(states) {
    return states.map((x, n) => raceAt(this.races[n], x, this.shown.face));
  }

  /** The still, and with share < 1 a moment on the way to it. */
  drawPicture(context, width, height, share = 1) {
    const states = this.drawScene(context, 0.34 * width, 0.66 * width, height, share, 0.1, 2.1, 1.12);
    const write = writer(context, height / 900), [start, end] = wordsOf(this.shown.eta_hat);
    write("It almost", 70, 250, 64, INK, 700);
    write("never falls flat.", 70, 326, 64, INK, 700);
    // Lines of words, with the number of the side whose colour they have.
    const race = [
      [[`The contact point races ${this.turns}`]],
      [["round the rim, "], ["one way", 0], [" or "], ["the other", 1], [":"]],
      [["the disk rises here or there."]],
    ];
    [[[start]], ...(this.racesAt(states)[0] ? race : [[[end]]])].forEach((parts, line) => {
      let x = 72;
      for (const [words, n] of parts) {
        const plain = n === undefined;
        x += write(words, x, 440 + 52 * line, 31, plain ? SOFT : css(this.sides[n]), plain ? 400 : 700);
      }
    });
    write(this.about, 72, 840, 31, SOFT);
  }

  /** A frame of the film at a share of its seconds. */
  drawFrame(context, width, height, share) {
    const moved = Math.min(1, share / AFTER);
    const away = this.middle < 1 ? smooth(moved, 1 - 0.55 * (1 - this.middle), 1) : 0;
    const near = smooth(moved, 0.5 * this.middle, 0.85 * this.middle) * (1 - away);
    const states = this.drawScene(context, 0, width, height, moved, near, 3.1, 1.3);
    const write = writer(context, height / 1080), [start, last] = wordsOf(this.shown.eta_hat);
    const title = 1 - smooth(share, TITLE - 0.05, TITLE), end = smooth(share, AFTER - 0.05, AFTER);
    const slowed = `slowed ${Math.round(slowing(states[0]))} times`;
    write("It almost never falls flat.", 960, 130, 76, INK, 700, "center", title);
    write(start, 960, 200, 40, SOFT, 400, "center", title);
    write(last, 960, 130, 76, INK, 700, "center", end);
    write("nearflat", 1860, 1030, 38, SOFT, 400, "right");
    // In a corner: what is seen in the middle comes near the upper edge.
    if (slowing(states[0]) > 1.5) write(slowed, 60, 110, 52, INK, 600, "left", (1 - title) * (1 - end));
    this.racesAt(states).forEach((race, n) => {
      if (!race) return;
      const turns = race.turned / (2 * Math.PI), words = `${turns < 0 ? "−" : "+"}${Math.abs(turns).toFixed(2)}`;
      write("turns of the contact point", 960, 1030, 38, SOFT, 400, "center", 1 - title);
      write(words, n ? 1280 : 640, 1030, 76, css(this.sides[n]), 700, n ? "left" : "right", 1 - title);
    });
  }
}

/** Writes words at places of a picture that is `unit` times as large, and returns how wide they are there. */
function writer(context, unit) {
  return (words, x, y, size, colour, weight = 400, align = "left", alpha = 1) => {
    if (!(alpha > 0)) return 0;
    context.font = `${weight} ${size * unit}px system-ui, -apple-system, "Segoe UI", "Noto Sans", sans-serif`;
    context.textAlign = align;
    context.textBaseline = "alphabetic";
    context.fillStyle = colour;
    context.globalAlpha = alpha;
    context.fillText(words, x * unit, y * unit);
    context.globalAlpha = 1;
    return context.measureText(words).width / unit;
  };
}
