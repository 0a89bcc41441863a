// One passage near flat as an integral: what the readouts say, independent of the frames of the picture.
//
// With h = 2 sin(theta/2) = h_m cosh y, where h_m is the turning point, time and angles are integrals over y of
// analytic functions. Gauss's rule on panels; towards
// the start the panels shrink, since a slow start has a branch point close by.

import { solutions } from "./chaplygin.js";

const VERTICAL = Math.SQRT2;
const NODES = 16;
// Each panel towards the start is a quarter of the one before; the last, 4^-14 of the first, takes a square root out.
const SHRINK = 4;
const PANELS = 14;
// Tilts tried on the way to flat, for a barrier that turns the motion back before it gets there.
const SCAN = 240;
const FORCE_POINTS = 400;

/** Nodes and weights of Gauss and Legendre on (0, 1). */
const GAUSS = (() => {
  const rule = [];
  for (let i = 1; i <= NODES; i++) {
    let x = Math.cos((Math.PI * (i - 0.25)) / (NODES + 0.5));
    let slope = 1;
    for (let pass = 0; pass < 30; pass++) {
      let before = 1, value = x;
      for (let n = 2; n <= NODES; n++) [before, value] = [value, ((2 * n - 1) * x * value - (n - 1) * before) / n];
      slope = (NODES * (before - x * value)) / (1 - x * x);
      x -= value / slope;
    }
    rule.push([0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)]);
  }
  return rule;
})();

/** The motion with constants (X, Y) at h on its own hemisphere; V is counted from V_0, slope is h dV/dh. */
export function point(h, X, Y, body) {
  const S = 0.5 * h * h;
  const f = solutions(S, 2 * Math.log(h) - Math.LN2, body);
  const shape = Math.sqrt(1 - 0.5 * S);
  const ratio = (0.5 * X * f.rhoOverS * h + (Y * f.D) / h) / shape;
  const flat = X / body.k;
  // sigma4 less its value at flat, from the difference itself: near flat V - V_0 is all there is
  const rise = (X * S * f.excess + Y * f.dD) / body.k;
  const sigma4 = flat + rise;
  const q = h * shape, z = 1 - S;
  const gyration = body.I1 * ratio * ratio;
  const V = 0.5 * gyration + 0.5 * body.J * rise * (2 * flat + rise) + q;
  const slope = (h / shape) * (body.J * ratio * sigma4 + z) - (z * gyration) / (shape * shape);
  return { q, z, shape, ratio, sigma4, V, slope };
}

/** Sum over the panels of [0, length] counted from a slow start; f(d, weight) adds to the sums itself. */
function gradedSum(length, f) {
  let outer = length;
  for (let n = 0; n < PANELS; n++) {
    const inner = outer / SHRINK;
    for (const [x, w] of GAUSS) f(inner + (outer - inner) * x, (outer - inner) * w);
    outer = inner;
  }
  for (const [x, w] of GAUSS) f(outer * x * x, 2 * outer * x * w);
}

/** The root of level - V between ln h = low (negative) and high (positive), by bracketed Newton in ln h. */
function refine(low, high, level, X, Y, body) {
  let x = 0.5 * (low + high);
  for (let i = 0; i < 200; i++) {
    const at = point(Math.exp(x), X, Y, body);
    const gap = level - at.V;
    if (gap < 0) low = x;
    else high = x;
    const newton = x + gap / at.slope;
    const [a, b] = low < high ? [low, high] : [high, low];
    const guess = newton > a && newton < b ? newton : 0.5 * (low + high);
    if (Math.abs(guess - x) <= 4e-16 * Math.max(1, Math.abs(x))) return Math.exp(guess);
    x = guess;
  }
  return Math.exp(x);
}

/** h of the first turning point on the way from `h` to flat. A wall of height eta^2/h^2 always stands there. */
function turningPoint(hEnd, level, X, Y, body) {
  let above = Math.log(hEnd);
  const leading = Math.log(Math.abs(Y)) + 0.5 * Math.log((0.5 * body.I1) / level);
  for (let i = 1; i < SCAN; i++) {
    const here = Math.log(hEnd * (1 - i / SCAN));
    if (level < point(Math.exp(here), X, Y, body).V) return refine(here, above, level, X, Y, body);
    above = here;
  }
  // Near flat h_m = |Y| sqrt(I1/M) / A to leading order: the walk down begins a little above it.
  if (leading + 2 < above) above = leading + 2;
  for (let below = above - 0.5; below > -740; below -= 0.5) {
    if (level < point(Math.exp(below), X, Y, body).V) return refine(below, below + 0.5, level, X, Y, body);
  }
  return NaN;
}

/**
 * The stretch of a motion on the hemisphere of its face: where it begins, E - V_0, and X, Y.
 *
 * It begins at the vertical, or at rest at a turning point where the motion does not get there. `null` where the
 * motion stays on the other hemisphere.
 */
export function stretchOf(motion) {
  const { body, face, sigma3_bar, eta, theta, phidot } = motion;
  const X = sigma3_bar / body.r0;
  const Y = eta / body.I1;
  const other = (2 * body.dr0 * sigma3_bar) - Y;
  const upright = theta === 0.5 * Math.PI;
  const here = upright || theta < 0.5 * Math.PI;
  const h = upright ? VERTICAL : 2 * Math.sin(0.5 * (here ? theta : Math.PI - theta));
  const level = 0.5 * body.M * phidot * phidot + point(h, X, here ? Y : other, body).V;
  const common = { body, face, X, Y, level };
  if (upright) return { ...common, hEnd: VERTICAL, rest: phidot === 0 };
  // Up to the vertical in small steps: does the motion get there?
  let below = h;
  for (let i = 1; i <= SCAN; i++) {
    const next = h + ((VERTICAL - h) * i) / SCAN;
    if (level < point(next, X, here ? Y : other, body).V) {
      if (!here) return null;
      return { ...common, hEnd: refine(Math.log(next), Math.log(below), level, X, Y, body), rest: true };
    }
    below = next;
  }
  return { ...common, hEnd: VERTICAL, rest: false };
}

/** chi, psi, time and theta_min of the passage over a stretch to its turning point and back. */
export function passage(stretch) {
  const { body, X, Y, level, hEnd, rest, face } = stretch;
  if (rest && !(point(hEnd, X, Y, body).slope > 0)) return null;
  const hTurn = turningPoint(hEnd, level, X, Y, body);
  if (!(hTurn < hEnd)) return null;
  const yEnd = Math.acosh(hEnd / hTurn);
  const decay = 1 + Math.exp(-2 * yEnd);
  const sums = { chi: 0, psi: 0, time: 0 };
  const add = (y, h, weight) => {
    const at = point(h, X, Y, body);
    const left = Math.max(level - at.V, 1e-300);
    const dt = (weight * h * Math.tanh(y)) / (at.shape * Math.sqrt((2 * left) / body.M));
    sums.time += dt;
    sums.chi += (at.ratio / at.q) * dt;
    sums.psi += ((at.z * at.ratio) / at.q - at.sigma4) * dt;
  };
  const end = Math.min(1, 0.5 * yEnd);
  gradedSum(end, (d, w) => add(yEnd - d, (hEnd * Math.exp(-d) * (1 + Math.exp(2 * (d - yEnd)))) / decay, w));
  const panels = Math.ceil(yEnd - end);
  const width = (yEnd - end) / panels;
  for (let n = 0; n < panels; n++) {
    for (const [x, w] of GAUSS) {
      const y = width * (n + x);
      const half = Math.sinh(0.5 * y);
      add(y, hTurn * (1 + 2 * half * half), w * width);
    }
  }
  return {
    delta_chi: 2 * sums.chi,
    delta_psi: 2 * sums.psi * face,
    duration: 2 * sums.time,
    theta_min: 2 * Math.asin(0.5 * hTurn),
    hTurn,
  };
}

/** Time and increase of chi of the fall on F itself (eta = 0), down to a tilt, with the same sigma3_bar and energy. */
export function fall(stretch, tilt = 0) {
  const { body, X, level } = stretch;
  if (!(level > 0)) return { time: NaN, chi: NaN };
  let h = stretch.hEnd;
  if (level < point(h, X, 0, body).V || stretch.rest) {
    // On F the same energy may not reach as far: then the fall begins at rest, later.
    let low = 0, high = h;
    for (let i = 0; i < 60; i++) {
      const middle = 0.5 * (low + high);
      if (level < point(middle, X, 0, body).V) high = middle;
      else low = middle;
    }
    h = level < point(h, X, 0, body).V ? low : h;
  }
  const start = 2 * Math.asin(0.5 * h);
  const sums = { time: 0, chi: 0 };
  const add = (theta, weight) => {
    const at = point(2 * Math.sin(0.5 * theta), X, 0, body);
    const dt = weight / Math.sqrt((2 * Math.max(level - at.V, 1e-300)) / body.M);
    sums.time += dt;
    sums.chi += (at.ratio / at.q) * dt;
  };
  const part = 0.25 * Math.max(0, start - tilt);
  gradedSum(part, (d, w) => add(start - d, w));
  for (let n = 0; n < 3; n++) for (const [x, w] of GAUSS) add(tilt + part * (n + x), part * w);
  return sums;
}

/** Least normal force (m g) and largest needed friction coefficient over a passage, on a grid as in Python. */
export function passageForces(stretch, hTurn) {
  const { body, X, Y, level, hEnd } = stretch;
  const yEnd = Math.acosh(Math.max(hEnd / hTurn, 1));
  let least = Infinity, most = 0;
  for (let j = 0; j <= FORCE_POINTS; j++) {
    const share = j / FORCE_POINTS;
    const y = share < 0.5 ? Math.min(20 * share, yEnd * share) : yEnd - Math.min(20, yEnd) * (1 - share);
    const h = hTurn * Math.cosh(y);
    const at = point(h, X, Y, body);
    const speed2 = (2 * Math.max(level - at.V, 0)) / body.M;
    const acceleration = (-at.slope * at.shape) / h / body.M;
    const normal = 1 + at.z * acceleration - at.q * speed2;
    const along = acceleration * at.q + speed2 * at.z + (at.ratio * at.sigma4) / at.q;
    const across = at.ratio * Math.sqrt(speed2) * (1 - 1 / body.J);
    least = Math.min(least, normal);
    most = Math.max(most, normal > 0 ? Math.hypot(along, across) / normal : Infinity);
  }
  return { least, most };
}

/** All that the page says about one motion in numbers; entries that do not exist are NaN. */
export function readouts(motion) {
  const limit = Math.sign(motion.eta) * motion.body.kappa * Math.PI;
  const nothing = { limit, race_angle: NaN, delta_chi: NaN, fall_angle: NaN, theta_min: NaN, duration: NaN };
  const stretch = stretchOf(motion);
  const way = stretch && passage(stretch);
  if (!way) return { ...nothing, min_normal_force: NaN, max_friction: NaN, impact_speed: NaN };
  const fallAngle = 2 * fall(stretch).chi;
  const forces = passageForces(stretch, way.hTurn);
  return {
    limit,
    race_angle: way.delta_chi - fallAngle,
    delta_chi: way.delta_chi,
    fall_angle: fallAngle,
    theta_min: way.theta_min,
    duration: way.duration,
    min_normal_force: forces.least,
    max_friction: forces.most,
    impact_speed: Math.sqrt((2 * stretch.level) / motion.body.M),
  };
}
