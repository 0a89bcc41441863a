// What is shown, in one place: the motion, how it is played, and the address that carries both.

import { annulus, etaHatToEta, lineSlope, makeBody } from "./chaplygin.js";
import { readouts } from "./passage.js";
import { CLOCK, trajectory } from "./physics.js";

/** Approaches to flat that are shown before the picture begins anew: enough for the two sides to part. */
const BOUNCES = 3;
const UPRIGHT = 0.5 * Math.PI;
/** Smallest and largest |eta_hat| of the controls; an address or Python may go further. */
export const SMALLEST = 1e-12;
export const LARGEST = 1;
const EDGE = 0.02; // where |eta_hat| is SMALLEST on the ruler; nearer to its middle than half of this is F itself
const MOST = 1e3; // of the numbers of an address: faster motions are over before anything is seen

const NUMBERS = { face: 1, sigma3_bar: 1, eta_hat: 0.01, theta: UPRIGHT, phidot: 1, pace: 1 };
const FLAGS = { slow: true, ghost: true };

/** The body of a name: one that Python sent with its series, or an annulus computed here. */
export function bodyOf(name, bodies) {
  const given = bodies.find((body) => body.name === name);
  if (given) return { ...makeBody(given.I1, given.I3, given.series), name, label: given.label, inner: given.inner };
  const inner = Number(name.replace("annulus:", ""));
  if (!name.startsWith("annulus:") || !(inner >= 0 && inner <= 1)) return bodyOf(bodies[0].name, bodies);
  return { ...annulus(inner), name, label: `ring, hole ${inner.toFixed(2)}`, inner };
}

/** The part of an address after #, read; what cannot be used is left out. */
export function readHash(hash) {
  const found = {};
  for (const [key, text] of new URLSearchParams(hash.replace(/^#/, ""))) {
    if (key === "disk" && text) found.disk = text;
    else if (key in NUMBERS && text.trim() !== "" && Math.abs(Number(text)) <= MOST) found[key] = Number(text);
    else if (key in FLAGS) found[key] = text !== "0";
  }
  if (found.face !== undefined && Math.abs(found.face) !== 1) delete found.face;
  if (found.theta !== undefined && !(found.theta > 0 && found.theta < Math.PI)) delete found.theta;
  if (found.pace !== undefined && !(found.pace > 0)) delete found.pace;
  return found;
}

/** The same, written: only what differs from a fresh page, so that addresses stay short. */
export function writeHash(shown) {
  const parts = [`disk=${shown.disk}`];
  for (const key of Object.keys(NUMBERS)) {
    const always = key === "sigma3_bar" || key === "eta_hat" || key === "phidot";
    if (always || shown[key] !== NUMBERS[key]) parts.push(`${key}=${shown[key]}`);
  }
  for (const key of Object.keys(FLAGS)) if (shown[key] !== FLAGS[key]) parts.push(`${key}=${shown[key] ? 1 : 0}`);
  return `#${parts.join("&")}`;
}

/** Place on the signed logarithmic ruler, -1 ... 1: F lies in the middle, |eta_hat| grows by decades outwards. */
export function etaHatToPlace(etaHat) {
  const decades = Math.log10(LARGEST / SMALLEST);
  const size = Math.min(LARGEST, Math.max(SMALLEST, Math.abs(etaHat)));
  return Math.sign(etaHat) * (EDGE + ((1 - EDGE) * Math.log10(size / SMALLEST)) / decades);
}

/** The inverse; the middle itself is F. */
export function placeToEtaHat(place) {
  if (Math.abs(place) < 0.5 * EDGE) return 0;
  const decades = Math.log10(LARGEST / SMALLEST);
  const share = Math.max(0, Math.abs(place) - EDGE) / (1 - EDGE);
  return Math.sign(place) * SMALLEST * 10 ** (decades * Math.min(1, share));
}

/** sigma4_bar of a motion, from its sigma3_bar and its distance to the line of its face. */
export function sigma4Bar(shown, body) {
  return shown.face * (lineSlope(body) * shown.sigma3_bar - shown.eta_hat);
}

/** Keeps the shown motion and everything that follows from it; tells its listeners when that has changed. */
export class Store {
  /** bounces: so many approaches to flat are followed. */
  constructor(start, bodies, bounces = BOUNCES) {
    this.bodies = bodies;
    this.bounces = bounces;
    this.start = { ...NUMBERS, ...FLAGS, disk: bodies[0].name, ...start };
    this.listeners = [];
    this.shown = { ...this.start };
    this.compute();
  }

  listen(listener) {
    this.listeners.push(listener);
  }

  /** Change some of what is shown. Physics is computed anew only where it must be. */
  set(changes) {
    const before = this.shown;
    this.shown = { ...before, ...changes };
    const moved = ["disk", "face", "sigma3_bar", "eta_hat", "theta", "phidot"].some((k) => before[k] !== this.shown[k]);
    if (moved) this.compute();
    for (const listener of this.listeners) listener(moved, before);
  }

  reset() {
    this.set({ ...this.start });
  }

  /** The motion that is shown. What follows from it is computed when somebody first looks at it. */
  compute() {
    const { disk, face, sigma3_bar, eta_hat, theta, phidot } = this.shown;
    if (this.body?.name !== disk) this.body = bodyOf(disk, this.bodies);
    this.shown.disk = this.body.name; // an unknown name is that of the first body
    const motion = { body: this.body, face, sigma3_bar, theta, phidot, eta: etaHatToEta(eta_hat, this.body) };
    this.main = trajectory(motion, this.bounces);
    this.beside = { ...motion, eta: -motion.eta };
    this.known = {};
  }

  /** The motion at -eta_hat, on the other side of F; on F both are one. */
  get other() {
    const { states } = this.main, end = states[states.length - 1][CLOCK];
    this.known.other ??= this.beside.eta ? trajectory(this.beside, this.bounces, end) : this.main;
    return this.known.other;
  }

  get numbers() {
    return (this.known.numbers ??= readouts(this.main.motion));
  }

  get otherNumbers() {
    return (this.known.otherNumbers ??= readouts(this.beside));
  }
}
