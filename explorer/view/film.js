// One fall as a picture and as a film of six seconds: outlines of the fall, tails of the race, wings of the rises.
//
// Both are painted here on a dark table, from the two motions that the page shows. The picture is the end of the
// film, seen from where the film begins.

import { drawDisk, drawOutline, drawShadow, drawTail, lampOf, poseOf } from "./disk.js";
import { CHI, CLOCK, slowing, stateAt, tiltOf } from "./physics.js";
import { Scene, raceAt, racesOf } from "./scene.js";

export const SECONDS = 6;
const RISEN = 1.3; // rad of tilt from flat at which a rise is shown as over
const OUTLINES = 8;
const LEAST_TILT = 0.22; // rad, of the outlines
const APART = 0.35; // rad of tilt at which the two disks of a rise have their own colours
const TURNED = 0.3; // rad of the camera from where both contact points are farthest apart, so that the faces are seen
const TITLE = 0.19, AFTER = 0.88; // shares of the film: until when its title is seen, and when the motion is over
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

/** The clock of the screen at which a tilt is passed between two others, of which the first has the smaller tilt. */
function clockAt(path, tilt, near, far) {
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
  const tilts = Array.from({ length: OUTLINES }, (_, n) => LEAST_TILT + ((n + 0.5) / OUTLINES) * (0.5 * Math.PI - LEAST_TILT));
  const between = (far) => tilts.filter((at) => at < tiltOf(stateAt(path, CLOCK, far), motion.face))
    .map((at) => clockAt(path, at, flat, far));
  return { path, begin, flat, over, down: between(begin), up: over > flat ? between(over) : [] };
}

export class Film {
  constructor(store) {
    const { main, other, numbers, otherNumbers, body, shown } = store;
    this.shown = shown;
    this.inner = body.inner ?? 0;
    this.kappa = body.kappa;
    this.falls = [fallOf(main), ...(shown.eta_hat ? [fallOf(other)] : [])];
    this.races = [racesOf(main, numbers), racesOf(other, otherNumbers)];
    this.numbers = [numbers, otherNumbers];
    this.sides = this.falls.map((_, n) => SIDES[(n ? -1 : 1) * (Math.sign(shown.eta_hat) || 1)]);
    const { begin, flat, over } = this.falls[0];
    this.middle = (flat - begin) / (over - begin);
    this.scene = new Scene(document.createElement("canvas"), true);
    // The two rises are seen from aside, so that the disks open like wings.
    const [x, y] = this.falls.map((fall) => stateAt(fall.path, CLOCK, fall.flat));
    this.azimuth = this.view(x, y);
    this.flatPose = poseOf(x, this.inner);
  }

  /** The direction from which both contact points at the ends are as far apart as they can be. */
  view() {
    const ends = this.falls.map((fall) => poseOf(stateAt(fall.path, CLOCK, fall.over), this.inner).contact);
    const apart = ends[1] ? [ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]] : [1, 0];
    return Math.atan2(apart[1], apart[0]) + 0.5 * Math.PI;
  }

  /** The clock of a motion at a share of its fall and rise: both lie flat at the same moment. */
  clock(fall, share) {
    const { begin, flat, over } = fall;
    if (share <= this.middle) return begin + ((flat - begin) * share) / (this.middle || 1);
    return flat + ((over - flat) * (share - this.middle)) / (1 - this.middle || 1);
  }

  /** How far the race has come, from 0 to 1. */
  raced(state) {
    const race = raceAt(this.races[0], state, this.shown.face);
    return race ? race.turned / race.angle : 0;
  }

  /** All of the scene into a part of a picture: `share` of the motion is over, `near` is how near the camera is. */
  drawScene(context, left, width, height, share, near, far) {
    const { scene, falls, flatPose } = this;
    const { camera } = scene;
    const clocks = falls.map((fall) => this.clock(fall, share));
    const states = falls.map((fall, n) => stateAt(fall.path, CLOCK, clocks[n]));
    const poses = states.map((x) => poseOf(x, this.inner));
    const [x, y] = flatPose.centre;
    scene.context = context;
    scene.table = { x, y, radius: 3.4 };
    Object.assign(camera, { azimuth: this.azimuth + TURNED, elevation: 0.42 + 0.33 * near, zoom: 1 });
    camera.aim = { x, y, z: 1.12 - 1.22 * near, radius: far - (far - 1.85) * near };
    camera.frame(width, height);
    context.save();
    context.translate(left, 0);
    scene.drawTable(LOOK);
    const lamp = lampOf(camera), scale = camera.pixels(flatPose.centre) / 200;
    const face = this.shown.face, tilts = states.map((at) => tiltOf(at, face));
    const risen = share > this.middle, colours = tilts.map((tilt) => (risen ? smooth(tilt, 0.04, APART) : 0));
    poses.forEach((pose) => drawShadow(context, camera, pose, lamp, 1));
    const outlines = falls.flatMap((fall, n) => [
      ...(n ? [] : fall.down.filter((at) => at <= clocks[n]).map((at) => [n, at, WHITE, 0.75])),
      ...fall.up.filter((at) => at <= clocks[n]).map((at) => [n, at, this.sides[n], 0.95]),
    ]);
    const paintOutline = ([n, at, colour, most]) => {
      const past = stateAt(falls[n].path, CLOCK, at);
      const strength = at < falls[n].flat ? (1 - 0.6 * near) * (1 - 0.75 * (tiltOf(past, face) / 1.57)) : 0.25 + 0.5 * (tiltOf(past, face) / RISEN);
      drawOutline(context, camera, poseOf(past, this.inner), colour, most * strength, 1.7 * scale, 0.03);
    };
    outlines.filter(([n, at]) => at < falls[n].flat).forEach(paintOutline);
    falls.forEach((fall, n) => {
      const race = raceAt(this.races[n], states[n], face);
      if (race) drawTail(context, camera, flatPose.centre, states[n][CHI], race, n, this.sides[n], GROUND, 1);
    });
    const strength = colours[0];
    if (strength > 0) {
      context.globalAlpha = strength;
      drawDisk(context, camera, flatPose, LOOK, lamp);
      context.globalAlpha = 1;
    }
    outlines.filter(([n, at]) => at > falls[n].flat).forEach(paintOutline);
    const depth = (n) => camera.project(poses[n].centre)[2];
    const order = falls.map((_, n) => n).sort((a, b) => depth(b) - depth(a));
    for (const n of order) {
      if (n && !strength) continue;
      const side = mixed(GOLD, this.sides[n], colours[n]), mark = colours[n] > 0.5 ? "#fff6" : LOOK.markUp;
      drawDisk(context, camera, poses[n], { ...LOOK, faceUp: side, faceDown: side, side, markUp: mark, markDown: mark }, lamp);
    }
    context.restore();
    return states;
  }

  /** The still, and with share < 1 a moment on the way to it. */
  drawPicture(context, width, height, share = 1) {
    context.fillStyle = PAPER;
    context.fillRect(0, 0, width, height);
    this.drawScene(context, 0.34 * width, 0.66 * width, height, share, 0.1, 2.1);
    const unit = height / 900;
    const write = writer(context, unit);
    const turns = this.numbers.map((n) => Math.abs(n.race_angle) / (2 * Math.PI));
    write("It almost", 70, 250, 64, INK, 700);
    write("never falls flat.", 70, 326, 64, INK, 700);
    const lines = [["Two starts, the same but for a hair."]];
    if (this.falls[1] && Number.isFinite(turns[0])) {
      lines.push([`The contact point races ${turns[0].toFixed(2)} turns`]);
      lines.push(["round the rim, ", [0, "one way"], " or ", [1, "the other"], ":"], ["the disk rises here or there."]);
    }
    lines.forEach((parts, n) => {
      let x = 72;
      for (const part of parts) {
        const [side, words] = Array.isArray(part) ? part : [null, part];
        x += write(words, x, 440 + 52 * n, 31, side === null ? SOFT : css(this.sides[side]), side === null ? 400 : 700);
      }
    });
    write(`nearflat · η̂ = ±${Math.abs(this.shown.eta_hat)}, κ = ${Number(this.kappa.toFixed(3))}`, 72, 840, 24, SOFT);
  }

  /** A frame of the film at a share of its seconds. */
  drawFrame(context, width, height, share) {
    context.fillStyle = PAPER;
    context.fillRect(0, 0, width, height);
    const moved = Math.min(1, share / AFTER);
    const states = this.falls.map((fall) => stateAt(fall.path, CLOCK, this.clock(fall, moved)));
    const near = smooth(moved, 0.5 * this.middle, 0.85 * this.middle) * (1 - smooth(moved, 1 - 0.55 * (1 - this.middle), 1));
    this.drawScene(context, 0, width, height, moved, near, 2.75);
    const write = writer(context, height / 1080);
    const factor = slowing(states[0]);
    const title = 1 - smooth(share, TITLE - 0.05, TITLE), end = smooth(share, AFTER - 0.05, AFTER);
    write("It almost never falls flat.", 960, 130, 76, INK, 700, "center", title);
    write("Two starts, the same but for a hair.", 960, 200, 40, SOFT, 400, "center", title);
    write("A hair decides where it rises.", 960, 130, 76, INK, 700, "center", end);
    write("nearflat", 1860, 1030, 36, SOFT, 400, "right");
    if (factor > 1.5) write(`slowed ${Math.round(factor)} times`, 960, 130, 56, INK, 600, "center", (1 - title) * (1 - end));
    if (share < TITLE - 0.05) return;
    write("turns of the contact point", 960, 1020, 38, SOFT, 400, "center");
    states.forEach((x, n) => {
      const race = raceAt(this.races[n], x, this.shown.face);
      if (!race) return;
      const turns = race.turned / (2 * Math.PI);
      const words = `${turns < 0 ? "−" : "+"}${Math.abs(turns).toFixed(2)}`;
      write(words, n ? 1280 : 640, 1030, 76, css(this.sides[n]), 700, n ? "left" : "right");
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
