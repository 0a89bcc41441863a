// The disk as a solid: where it is in space, its shadow on the table, and how it is painted.

import { A1, A2, CHI, PSI, Q, Z } from "./physics.js";

const CORNERS = 72; // of the polygon that a rim is drawn as
const THICKNESS = 0.085;
const TURNS = Array.from({ length: CORNERS + 1 }, (_, n) => (2 * Math.PI * n) / CORNERS);
const COSINES = TURNS.map(Math.cos);
const SINES = TURNS.map(Math.sin);
// A lamp has a size: shadows from several of its points make the edge soft where the rim is high above the table.
const LAMP = Array.from({ length: 12 }, (_, n) => [0.075 * Math.cos(2.4 * n) * Math.sqrt(n / 12), 0.075 * Math.sin(2.4 * n) * Math.sqrt(n / 12)]);
const SHADOW = 0.036;

/** Place and directions of the disk at a state; radius 1. The normal points to the side of face +1. */
export function poseOf(x, inner) {
  const c = Math.cos(x[CHI]), s = Math.sin(x[CHI]), q = x[Q], z = x[Z];
  return {
    centre: [x[A1], x[A2], q],
    down: [z * c, z * s, -q],
    along: [-s, c, 0],
    normal: [q * c, q * s, z],
    contact: [x[A1] + z * c, x[A2] + z * s, 0],
    // The sharp rim touches the table: the body lies above it when flat, evenly on both sides when upright.
    low: -0.5 * THICKNESS * (1 - z),
    high: 0.5 * THICKNESS * (1 + z),
    mark: Math.PI - x[PSI],
    // A hoop is drawn with some width, or it could not be seen.
    hole: inner > 0 ? Math.min(inner, 0.86) : 0,
  };
}

function spot(pose, radius, cosine, sine, height) {
  return [0, 1, 2].map(
    (i) => pose.centre[i] + radius * (cosine * pose.down[i] + sine * pose.along[i]) + height * pose.normal[i],
  );
}

function circle(pose, radius, height) {
  return TURNS.map((_, n) => spot(pose, radius, COSINES[n], SINES[n], height));
}

export function trace(context, points) {
  points.forEach(([x, y], n) => (n ? context.lineTo(x, y) : context.moveTo(x, y)));
}

function close(context, points) {
  trace(context, points);
  context.closePath();
}

/** The lamp stands behind the left shoulder of the camera, so that shadows fall into the picture. */
export function lampOf(camera) {
  const angle = camera.azimuth - 0.9;
  return [0.52 * Math.cos(angle), 0.52 * Math.sin(angle), 0.85];
}

export function drawShadow(context, camera, pose, lamp, strength) {
  const rims = [1, pose.hole].filter((radius) => radius > 0).map((radius) => circle(pose, radius, 0));
  context.fillStyle = `rgba(0, 0, 0, ${SHADOW * strength})`;
  for (const [dx, dy] of LAMP) {
    context.beginPath();
    for (const rim of rims) {
      close(context, rim.map((p) => camera.project([p[0] - ((lamp[0] + dx) * p[2]) / lamp[2], p[1] - ((lamp[1] + dy) * p[2]) / lamp[2], 0])));
    }
    context.fill("evenodd");
  }
}

const mixed = (colour, light) => {
  const target = light > 0 ? 255 : 0;
  const share = Math.min(1, Math.abs(light));
  return `rgb(${colour.map((v) => Math.round(v + share * (target - v))).join(",")})`;
};

const shade = (normal, lamp) => normal[0] * lamp[0] + normal[1] * lamp[1] + normal[2] * lamp[2];

/** The band of the rim (outward) or the wall of the hole (inward), the part that is seen. */
function drawBand(context, camera, pose, radius, outward, colour, lamp) {
  for (let n = 0; n < CORNERS; n++) {
    const cosine = 0.5 * (COSINES[n] + COSINES[n + 1]), sine = 0.5 * (SINES[n] + SINES[n + 1]);
    const normal = [0, 1, 2].map((i) => outward * (cosine * pose.down[i] + sine * pose.along[i]));
    const middle = spot(pose, radius, cosine, sine, 0.5 * (pose.low + pose.high));
    if (!camera.faces(middle, normal)) continue;
    const corners = [
      [n, pose.low], [n + 1, pose.low], [n + 1, pose.high], [n, pose.high],
    ].map(([m, height]) => camera.project(spot(pose, radius, COSINES[m], SINES[m], height)));
    context.fillStyle = context.strokeStyle = mixed(colour, 0.42 * shade(normal, lamp) - 0.12);
    context.beginPath();
    close(context, corners);
    context.fill();
    context.stroke();
  }
}

/** A bar on a face or across the rim that belongs to the body, so that its rolling is seen. */
function drawMark(context, camera, pose, height, colour) {
  const inner = Math.max(pose.hole, 0.5);
  const width = 0.055;
  const corners = [[inner, -1], [0.985, -1], [0.985, 1], [inner, 1]].map(([radius, side]) => {
    const turn = pose.mark + (side * width) / radius;
    return camera.project(spot(pose, radius, Math.cos(turn), Math.sin(turn), height));
  });
  context.fillStyle = colour;
  context.beginPath();
  close(context, corners);
  context.fill();
}

function drawFace(context, camera, pose, top, look, lamp) {
  const height = top ? pose.high : pose.low;
  const sign = top ? 1 : -1;
  const normal = pose.normal.map((v) => sign * v);
  const rim = circle(pose, 1, height).map((p) => camera.project(p));
  const colour = top ? look.faceUp : look.faceDown;
  // Light falls off across the face, brighter towards the lamp.
  const towards = camera.project([0, 1, 2].map((i) => pose.centre[i] + lamp[i]));
  const from = camera.project(pose.centre);
  const away = [from[0] - (towards[0] - from[0]), from[1] - (towards[1] - from[1])];
  const gradient = context.createLinearGradient(away[0], away[1], towards[0], towards[1]);
  const light = 0.38 * shade(normal, lamp) - 0.2;
  gradient.addColorStop(0, mixed(colour, light - 0.12));
  gradient.addColorStop(1, mixed(colour, light + 0.16));
  context.fillStyle = gradient;
  context.beginPath();
  close(context, rim);
  if (pose.hole) close(context, circle(pose, pose.hole, height).map((p) => camera.project(p)));
  context.fill("evenodd");
  context.strokeStyle = mixed(colour, light + 0.35);
  context.lineWidth = 1;
  context.stroke();
  context.strokeStyle = mixed(colour, light - 0.22);
  context.beginPath();
  close(context, circle(pose, Math.max(0.9, 0.5 * (1 + pose.hole)), height).map((p) => camera.project(p)));
  context.stroke();
  drawMark(context, camera, pose, height, top ? look.markUp : look.markDown);
}

/** The solid disk. look: colours as [r, g, b] of both faces, marks as CSS colours, `side` as [r, g, b]. */
export function drawDisk(context, camera, pose, look, lamp) {
  context.lineJoin = "round";
  context.lineWidth = 0.8;
  const seen = (top) => {
    const height = top ? pose.high : pose.low;
    const at = [0, 1, 2].map((i) => pose.centre[i] + height * pose.normal[i]);
    return camera.faces(at, pose.normal.map((v) => (top ? v : -v)));
  };
  if (pose.hole) drawBand(context, camera, pose, pose.hole, -1, look.faceDown, lamp);
  context.lineWidth = 0.8;
  drawBand(context, camera, pose, 1, 1, look.side, lamp);
  for (const top of [true, false]) if (seen(top)) drawFace(context, camera, pose, top, look, lamp);
}

/** The outline of a disk; `fill` is how much of the colour the face has. */
export function drawOutline(context, camera, pose, colour, alpha, width, fill) {
  const rims = [1, pose.hole].filter((radius) => radius > 0);
  context.beginPath();
  for (const radius of rims) close(context, circle(pose, radius, 0).map((p) => camera.project(p)));
  context.fillStyle = `rgba(${colour.join(",")}, ${fill})`;
  context.fill("evenodd");
  context.strokeStyle = `rgba(${colour.join(",")}, ${alpha})`;
  context.lineWidth = width;
  context.stroke();
}

/** The disk on the other side of F: its outline, filled with a breath of its colour. */
export function drawGhost(context, camera, pose, colour) {
  drawOutline(context, camera, pose, colour, 0.9, 1.8, 0.16);
  drawMark(context, camera, pose, 0, `rgba(${colour.join(",")}, 0.75)`);
}

/** The hand of the clock that the contact point is: from the centre of the disk to the contact. */
export function drawHand(context, camera, pose, colour, size) {
  const height = camera.faces(pose.centre, pose.normal) ? pose.high : pose.low;
  const from = camera.project(spot(pose, 0, 1, 0, height));
  const rim = camera.project(spot(pose, 1, 1, 0, height));
  const contact = camera.project(pose.contact);
  context.strokeStyle = context.fillStyle = `rgb(${colour.join(",")})`;
  context.lineWidth = 0.45 * size;
  context.lineCap = "round";
  context.beginPath();
  context.moveTo(from[0], from[1]);
  context.lineTo(rim[0], rim[1]);
  context.stroke();
  context.beginPath();
  context.arc(contact[0], contact[1], size, 0, 2 * Math.PI);
  context.fill();
  context.strokeStyle = "#fff";
  context.lineWidth = 1.5;
  context.stroke();
}

// The tail of a race lies on the table round the rim, and the one of the other side round that.
const TAIL_RADIUS = 1.1, TAIL_APART = 0.1, TAIL_GROWTH = 0.3, TAIL_PIECE = 0.06;

/**
 * The race so far as the tail of a comet round the disk: from where it began to the contact, which is at chi.
 *
 * Its pieces overlap and are opaque, so that no seams are seen; `ground` is what they fade into, [r, g, b]. With
 * `head` its end is marked, where no hand marks the contact.
 */
export function drawTail(context, camera, chi, race, n, colour, ground, strength, head = false) {
  if (!(strength > 0) || Math.abs(race.turned) < TAIL_PIECE) return;
  const pieces = Math.ceil(Math.abs(race.turned) / TAIL_PIECE), { centre } = race;
  const points = Array.from({ length: pieces + 1 }, (_, piece) => {
    const angle = chi - race.turned * (1 - piece / pieces);
    const radius = TAIL_RADIUS + n * TAIL_APART + (TAIL_GROWTH * piece * TAIL_PIECE) / Math.abs(race.angle);
    return camera.project([centre[0] + radius * Math.cos(angle), centre[1] + radius * Math.sin(angle), 0]);
  });
  const thick = 0.055 * camera.pixels(centre);
  context.save();
  context.globalAlpha = Math.min(1, strength);
  context.lineCap = "round";
  for (let piece = 0; piece < pieces; piece++) {
    const share = (piece + 1) / pieces;
    const faded = colour.map((v, i) => Math.round(ground[i] + (0.2 + 0.8 * share) * (v - ground[i])));
    context.strokeStyle = `rgb(${faded.join(",")})`;
    context.lineWidth = thick * (0.12 + 0.88 * share);
    context.beginPath();
    trace(context, points.slice(piece, piece + 2));
    context.stroke();
  }
  if (head) {
    context.fillStyle = "#fff";
    context.lineWidth = 0.3 * thick;
    context.beginPath();
    context.arc(...points[pieces].slice(0, 2), 0.75 * thick, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
  context.restore();
}
