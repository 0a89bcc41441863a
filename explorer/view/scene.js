// The picture on the left: table, shadows, trails of the contact points, the disk and its ghost.

import { Camera } from "./camera.js";
import { drawDisk, drawGhost, drawHand, drawShadow, drawTail, lampOf, poseOf, trace } from "./disk.js";
import { fall, fallOf, stretchOf } from "./passage.js";
import { A1, A2, CHI, CLOCK, Z, tiltOf, turningState } from "./physics.js";

// A trail needs a point where the contact has moved or turned by this much.
const TRAIL_STEP = 0.02;
const TAIL = 3.5; // radii that the bright end of a trail is long
const TAIL_PIECES = 8;
const TAIL_TILT = 0.5; // rad of tilt at which the tail of the race has faded, where the camera follows the disk
// Seconds in which most of the way to a new aim is done: soft where the camera follows, quick where a slider is dragged.
const FOLLOW = 0.36;
const CATCH_UP = 0.075;
const LONGEST_FRAME = 0.25; // s: after a pause the camera goes on, rather than jump
// What the camera keeps in sight: both disks and this much around them.
const ROOM = 1.85;

/** The path of the contact point: places on the table, each with the time of the clock and the way so far. */
export function trailOf(path) {
  const trail = [];
  let last = null;
  for (const x of path.states) {
    const at = [x[A1] + x[Z] * Math.cos(x[CHI]), x[A2] + x[Z] * Math.sin(x[CHI]), 0, x[CLOCK]];
    const step = last ? Math.hypot(at[0] - last[0], at[1] - last[1]) : 0;
    if (last && step < TRAIL_STEP) continue;
    trail.push([...at, last ? last[4] + step : 0]);
    last = trail[trail.length - 1];
  }
  return trail;
}

/** A circle on the table round everything that will be seen. */
export function extentOf(paths) {
  let [west, east, south, north] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const path of paths) {
    for (const x of path.states) {
      west = Math.min(west, x[A1]);
      east = Math.max(east, x[A1]);
      south = Math.min(south, x[A2]);
      north = Math.max(north, x[A2]);
    }
  }
  return { x: 0.5 * (west + east), y: 0.5 * (south + north), radius: 0.5 * Math.hypot(east - west, north - south) + 1.1 };
}

/** The races of a motion: the state of each turning point, the race angle, and the fall on F beside it. */
export function racesOf(path, numbers) {
  if (!Number.isFinite(numbers.race_angle)) return [];
  const beside = fallOf(stretchOf(path.motion)), whole = fall(beside);
  const left = (tilt) => whole.chi - fall(beside, tilt, whole.parts).chi;
  const least = left(numbers.theta_min);
  /** chi of the fall from a tilt on, in proportion to the way to the smallest tilt; without turning there is none. */
  const rest = (tilt) => (whole.chi * (left(tilt) - least)) / (whole.chi - least) || 0;
  return path.turns.map((_, turn) => {
    const x = turningState(path, turn);
    return { turn, clock: x[CLOCK], chi: x[CHI], centre: [x[A1], x[A2], 0], angle: numbers.race_angle, rest };
  });
}

/** How far the race that is nearest in time has come (rad): chi so far, less that of the fall on F. */
export function raceAt(races, x, face) {
  if (!races.length) return null;
  const near = (race) => Math.abs(race.clock - x[CLOCK]);
  const race = races.reduce((best, other) => (near(other) < near(best) ? other : best));
  const way = Math.sign(x[CLOCK] - race.clock), tilt = tiltOf(x, face);
  if (tilt > 0.5 * Math.PI) return { ...race, turned: 0.5 * race.angle * (1 + way) };
  return { ...race, turned: 0.5 * race.angle + (x[CHI] - race.chi) - way * race.rest(tilt) };
}

export class Scene {
  /**
   * still: the camera sees the whole table; else it follows the disk, unless it has an aim {x, y, z, radius} for good,
   * and a table {x, y, radius} to it.
   */
  constructor(canvas, { still = false, aim = null, table = null } = {}) {
    Object.assign(this, { canvas, still, aim, table });
    this.context = canvas.getContext("2d");
    this.camera = new Camera();
  }

  /** New motions: `paths` is [shown, ghost]; numbers: their readouts. */
  load(paths, inner, numbers) {
    this.trails = paths.map(trailOf);
    this.races = paths.map((path, n) => racesOf(path, numbers[n]));
    this.faces = paths.map((path) => path.motion.face);
    this.extent = extentOf(paths);
    this.inner = inner;
    this.table ??= { ...this.extent };
  }

  /** The camera follows both disks; where the page should not move it sees the whole table instead. */
  follow(poses) {
    if (this.aim) {
      this.camera.aim = this.aim;
      return;
    }
    const now = 1e-3 * performance.now(), frame = Math.min(now - (this.drawn ?? now - 1 / 60), LONGEST_FRAME);
    this.drawn = now;
    const share = (seconds) => 1 - Math.exp(-frame / seconds);
    for (const key of ["x", "y", "radius"]) this.table[key] += share(CATCH_UP) * (this.extent[key] - this.table[key]);
    if (this.still) {
      this.camera.follow({ ...this.extent, z: 0.4 }, share(CATCH_UP));
      return;
    }
    const [a, b] = [poses[0], poses[1] ?? poses[0]].map((pose) => pose.centre);
    const apart = 0.5 * Math.hypot(a[0] - b[0], a[1] - b[1]);
    // The disk is nearly flat for a while and upright for a while; the aim is between.
    const z = 0.1 + 0.4 * (a[2] + b[2]);
    const aim = { x: 0.5 * (a[0] + b[0]), y: 0.5 * (a[1] + b[1]), z, radius: ROOM + 0.75 * apart };
    this.camera.follow(aim, share(FOLLOW));
  }

  /** states: [shown, ghost]; ghost null where it is off. look: colours, `sides` as [r, g, b]. Returns the races. */
  draw(states, look) {
    const { context, camera } = this;
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    if (!width || !height) return [];
    const ratio = this.canvas.width / width;
    const poses = states.map((x) => x && poseOf(x, this.inner));
    this.follow(poses);
    camera.frame(width, height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const lamp = lampOf(camera);
    this.drawTable(look);
    this.clipToTable(() => {
      poses.forEach((pose, n) => pose && drawShadow(context, camera, pose, lamp, n ? 0.45 : look.shadow));
      if (look.trail) [1, 0].forEach((n) => poses[n] && this.drawTrail(this.trails[n], states[n][CLOCK], look.sides[n], n));
    });
    const races = states.map((x, n) => x && raceAt(this.races[n], x, this.faces[n]));
    [1, 0].forEach((n) => {
      const race = races[n];
      if (!race || this.aim) return;
      const strength = 1 - tiltOf(states[n], this.faces[n]) / TAIL_TILT;
      drawTail(context, camera, states[n][CHI], race, n, look.sides[n], look.ground, strength);
    });
    const depths = poses.map((pose) => (pose ? camera.project(pose.centre)[2] : Infinity));
    const order = depths[1] > depths[0] ? [1, 0] : [0, 1];
    for (const n of order) {
      if (!poses[n]) continue;
      if (n) drawGhost(context, camera, poses[n], look.sides[n]);
      else drawDisk(context, camera, poses[n], { ...look, side: this.aim ? look.faceUp : look.sides[0] }, lamp);
    }
    // A disk that lies low would hide where its contact has been: there the trail is seen through it.
    if (this.aim && look.trail) [1, 0].forEach((n) => {
      if (!poses[n]) return;
      context.globalAlpha = Math.max(0, 1 - tiltOf(states[n], this.faces[n]));
      this.drawTrail(this.trails[n], states[n][CLOCK], look.sides[n], n);
      context.globalAlpha = 1;
    });
    if (look.hand) [1, 0].forEach((n) => poses[n] && drawHand(context, camera, poses[n], look.sides[n], n ? 4.5 : 6));
    return races;
  }

  tableTop(lower = 0) {
    const { x, y, radius } = this.table;
    return Array.from({ length: 96 }, (_, n) => {
      const turn = (2 * Math.PI * n) / 96;
      const size = radius + 0.5;
      return this.camera.project([x + size * Math.cos(turn), y + size * Math.sin(turn), -lower]);
    });
  }

  outline(points) {
    this.context.beginPath();
    trace(this.context, points);
    this.context.closePath();
  }

  clipToTable(paint) {
    this.context.save();
    this.outline(this.tableTop());
    this.context.clip();
    paint();
    this.context.restore();
  }

  drawTable(look) {
    const { context, camera } = this;
    this.outline(this.tableTop(0.16));
    context.fillStyle = look.tableEdge;
    context.fill();
    const top = this.tableTop();
    this.outline(top);
    const heights = top.map((p) => p[1]);
    const gradient = context.createLinearGradient(0, Math.min(...heights), 0, Math.max(...heights));
    gradient.addColorStop(0, look.tableFar);
    gradient.addColorStop(1, look.table);
    context.fillStyle = gradient;
    context.fill();
    this.clipToTable(() => {
      const { x, y, radius } = this.table;
      const reach = Math.ceil(radius + 1);
      context.strokeStyle = look.tableLine;
      context.lineWidth = 1;
      context.beginPath();
      for (let n = -reach; n <= reach; n++) {
        const cx = Math.round(x), cy = Math.round(y);
        for (const [from, to] of [
          [[cx + n, cy - reach, 0], [cx + n, cy + reach, 0]],
          [[cx - reach, cy + n, 0], [cx + reach, cy + n, 0]],
        ]) {
          const a = camera.project(from), b = camera.project(to);
          context.moveTo(a[0], a[1]);
          context.lineTo(b[0], b[1]);
        }
      }
      context.stroke();
    });
  }

  /** The way that a contact point has come: a thin line, and a bright end that fades. */
  drawTrail(trail, now, colour, ghost) {
    const width = ghost ? 7 : 2.6;
    const past = trail.filter((at) => at[3] <= now).map((at) => [...this.camera.project(at), at[4]]);
    if (past.length < 2) return;
    const { context } = this, way = past[past.length - 1][3];
    context.lineJoin = context.lineCap = "round";
    const draw = (points, alpha, thickness) => {
      context.strokeStyle = `rgba(${colour.join(",")}, ${alpha})`;
      context.lineWidth = thickness;
      context.beginPath();
      trace(context, points);
      context.stroke();
    };
    draw(past, ghost ? 0.3 : 0.5, width);
    for (let piece = 0; piece < TAIL_PIECES; piece++) {
      const from = way - TAIL * (1 - piece / TAIL_PIECES);
      const part = past.filter((at) => at[3] >= from);
      if (part.length > 1) draw(part, ghost ? 0.09 : 0.3, width * (1.1 + (0.9 * piece) / TAIL_PIECES));
    }
  }
}
