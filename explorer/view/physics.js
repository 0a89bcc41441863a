// The motion in time, by the regularised equations: near flat nothing is divided by a small number.
//
// With rho = sigma3/q and dt = q ds the reduced equations (2.15)-(2.18) become polynomial. An error in rho grows
// like 1/theta_min near flat, so after every step rho and sigma4 are set anew to what the constants of motion
// say at that tilt: eta stays the number that was given, and the contact point races the right way at 1e-12.
// The same is done in kernels/disk/field.py and kernels/disk/constants.py.

import { solutions } from "./chaplygin.js";

/** Places of the components of a state. `clock` is the time of the screen, which is slowed near flat. */
export const Q = 0;
export const Z = 1;
export const P = 2;
export const RHO = 3;
export const SIGMA4 = 4;
export const T = 5;
export const CHI = 6;
export const PSI = 7;
export const A1 = 8;
export const A2 = 9;
export const CLOCK = 10;
export const SIZE = 11;

/** How fast the contact point may turn on the slowed clock, rad per unit of the clock: easily followed by eye. */
export const RACE_RATE = 4;

// Of 1/speed. Steps of Dormand and Prince of this length leave errors of some 1e-7 rad per passage.
const STEP = 0.08;
const MOST_STEPS = 60000;
export const FLAT = 1e-6; // rad of tilt at which a fall on F ends: flat within another 1e-6 of time
const MOST_CLOCK = 120; // a disk that stands still would stand for ever
// Share of the energy below which p is left alone when the energy is set right: it is close to a turning point.
const MOVING = 0.01;

// Dormand & Prince, J. Comput. Appl. Math. 6 (1980) 19-26, RK5(4)7M.
const STAGES = [
  [1 / 5],
  [3 / 40, 9 / 40],
  [44 / 45, -56 / 15, 32 / 9],
  [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
  [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
];
const WEIGHTS = [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84];

/** d/ds of the whole state into `out`: eqs (2.15)-(2.18), (2.22), (2.31), (2.33), regularised. */
export function field(x, body, out) {
  const q = x[Q], z = x[Z], p = x[P], rho = x[RHO], sigma4 = x[SIGMA4];
  const qp = q * p;
  out[Q] = z * qp;
  out[Z] = -q * qp;
  out[P] = (z * rho * rho * body.I1) / body.M - (q * (body.J * rho * sigma4 + z)) / body.M;
  out[RHO] = body.k * qp * sigma4 - z * rho * p;
  out[SIGMA4] = (qp * rho) / body.J;
  out[T] = q;
  out[CHI] = rho;
  out[PSI] = z * rho - q * sigma4;
  const sine = Math.sin(x[CHI]), cosine = Math.cos(x[CHI]);
  out[A1] = q * (sigma4 * sine + qp * cosine);
  out[A2] = q * (qp * sine - sigma4 * cosine);
  out[CLOCK] = Math.sqrt(q * q + (rho * rho) / (RACE_RATE * RACE_RATE));
}

/** Total energy, eq. (2.19), in units of m g r. */
export function energy(x, body) {
  return 0.5 * (body.M * x[P] * x[P] + body.I1 * x[RHO] * x[RHO] + body.J * x[SIGMA4] * x[SIGMA4]) + x[Q];
}

/** eta on the hemisphere of z: on the other one it is 2 I1 r'(0) sigma3_bar less the one that was given. */
export function etaAt(z, motion) {
  const { body, face, sigma3_bar, eta } = motion;
  return (z >= 0 ? 1 : -1) === face ? eta : 2 * body.I1 * body.dr0 * sigma3_bar - eta;
}

/** Sets q^2 + z^2 = 1, and rho and sigma4 to what the constants of the motion say at this tilt. */
export function ontoConstants(x, motion) {
  const { body } = motion;
  const face = x[Z] >= 0 ? 1 : -1;
  if (x[Q] < Math.abs(x[Z])) x[Z] = face * Math.sqrt((1 - x[Q]) * (1 + x[Q]));
  else x[Q] = Math.sqrt((1 - x[Z]) * (1 + x[Z]));
  const q = x[Q];
  const larger = 1 + Math.abs(x[Z]);
  const f = solutions((q * q) / larger, 2 * Math.log(q) - Math.log(larger), body);
  const X = motion.sigma3_bar / body.r0;
  const Y = etaAt(x[Z], motion) / body.I1;
  x[SIGMA4] = (face * (X * f.drho + Y * f.dD)) / body.k;
  x[RHO] = X * f.rhoOverS * (q / larger) + Y * (f.D / q);
}

/** Sets p so that the energy is `total`; near a turning point that waits for a later step. */
function ontoEnergy(x, total, body) {
  const excess = energy(x, body) - total;
  const kinetic = 0.5 * body.M * x[P] * x[P];
  if (kinetic > MOVING * total && Math.abs(excess) < MOVING * kinetic) x[P] *= Math.sqrt(1 - excess / kinetic);
}

/** The state at which a motion starts: its tilt theta from the flat state of its face, its speed towards it. */
export function startOf(motion) {
  // Plain arrays: thousands are kept, and typed ones of this size are slow to make.
  const x = new Array(SIZE).fill(0);
  const upright = motion.theta === 0.5 * Math.PI;
  x[Q] = upright ? 1 : Math.sin(motion.theta);
  x[Z] = upright ? 0 : motion.face * Math.cos(motion.theta);
  x[P] = -motion.face * motion.phidot;
  ontoConstants(x, motion);
  return x;
}

/** One step of Dormand and Prince; x is replaced. `room`: six arrays for the slopes and one for a state. */
function step(x, h, body, room) {
  const { slopes, at } = room;
  field(x, body, slopes[0]);
  for (let stage = 0; stage < STAGES.length; stage++) {
    const row = STAGES[stage];
    for (let i = 0; i < SIZE; i++) {
      let sum = 0;
      for (let j = 0; j <= stage; j++) sum += row[j] * slopes[j][i];
      at[i] = x[i] + h * sum;
    }
    field(at, body, slopes[stage + 1]);
  }
  for (let i = 0; i < SIZE; i++) {
    let sum = 0;
    for (let j = 0; j < WEIGHTS.length; j++) sum += WEIGHTS[j] * slopes[j][i];
    x[i] += h * sum;
  }
}

/**
 * A motion through `bounces` approaches to the flat state of its face, as states at the ends of all steps; it goes
 * on until the clock is at least `until`. With eta = 0 it ends flat.
 *
 * motion: { body, face, sigma3_bar, eta, theta, phidot }, natural units.
 * Returns { motion, states, s, turns }: states as arrays of SIZE numbers, s (same length) their parameter,
 * turns the numbers of the steps after which the tilt begins to grow again.
 */
export function trajectory(motion, bounces, until = 0) {
  const { body, face } = motion;
  const x = startOf(motion);
  const total = energy(x, body);
  const h = STEP / Math.sqrt((2 * total) / body.M);
  const room = { slopes: STAGES.concat([0]).map(() => new Float64Array(SIZE)), at: new Float64Array(SIZE) };
  const states = [x.slice()];
  const turns = [];
  while (states.length < MOST_STEPS && x[CLOCK] < MOST_CLOCK) {
    const before = face * x[P], tilt = face * x[Z];
    step(x, h, body, room);
    ontoConstants(x, motion);
    ontoEnergy(x, total, body);
    states.push(x.slice());
    const after = face * x[P];
    if (before < 0 && after >= 0) turns.push(states.length - 1);
    if (motion.eta === 0 && x[Q] < FLAT) break;
    const done = turns.length >= bounces && x[CLOCK] >= until;
    const back = tilt > face * states[0][Z] && face * x[Z] <= face * states[0][Z];
    if (done && (back || (before > 0 && after <= 0))) break;
  }
  return { motion, states, turns, s: Float64Array.from(states, (_, n) => n * h) };
}

/** Number of the last state whose component `place` (T or CLOCK, which grow) is not above `value`. */
export function stepAt(path, place, value) {
  let low = 0, high = path.states.length - 2;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (path.states[middle][place] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** The state at which T or CLOCK has a value. */
export function stateAt(path, place, value) {
  return within(path, stepAt(path, place, value), place, value);
}

/** The state of a turning point: that of the end of its step lies up to half a radian of chi beside it. */
export function turningState(path, turn) {
  return within(path, path.turns[turn] - 1, P, 0);
}

/** The state in step n at which a component has a value, by cubics through the ends of the step and their slopes. */
function within(path, n, place, value) {
  const { states, s, motion } = path;
  const left = states[n], right = states[n + 1], h = s[n + 1] - s[n];
  const leave = new Float64Array(SIZE), arrive = new Float64Array(SIZE);
  field(left, motion.body, leave);
  field(right, motion.body, arrive);
  const cubic = (i, w) => {
    const v = 1 - w;
    return v * v * ((1 + 2 * w) * left[i] + w * h * leave[i]) + w * w * ((1 + 2 * v) * right[i] - v * h * arrive[i]);
  };
  let low = 0, high = 1;
  let w = Math.min(1, Math.max(0, (value - left[place]) / (right[place] - left[place])));
  for (let i = 0; i < 40 && high - low > 1e-12; i++) {
    const gap = cubic(place, w) - value;
    if (gap > 0 === right[place] > left[place]) high = w;
    else low = w;
    const slope = (leave[place] * (1 - w) + arrive[place] * w) * h;
    const guess = w - gap / slope;
    if (Math.abs(guess - w) < 1e-13) break;
    w = guess > low && guess < high ? guess : 0.5 * (low + high);
  }
  return left.map((_, i) => cubic(i, w));
}

/** By how much the clock of the screen is slowed at a state: dclock/dt. */
export function slowing(x) {
  return Math.hypot(1, x[RHO] / x[Q] / RACE_RATE);
}

/** Tilt (rad) from the flat state of `face`, with its relative accuracy near it. */
export function tiltOf(x, face) {
  return Math.atan2(x[Q], face * x[Z]);
}
