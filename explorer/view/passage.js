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
// A start with less kinetic energy than SLOW is beside a turning point: up to BESIDE, E - V is summed from slopes.
const SLOW = 1e-3, BESIDE = 0.05;
// Slopes of V are known to 1e-16: from a start at rest with less than this the time cannot be told.
const LEAST_SLOPE = 1e-9;
// Panels are halved until time and angle have settled to this; a crest of V on the way may need many.
const SETTLED = 1e-8, MOST_PARTS = 128;
const ROUNDING = 1e-12; // of slopes and of normal forces

/** What is said where there are no numbers. */
const TOLD = {
  rests: "starts at an equilibrium",
  near: "comes too near an equilibrium to tell when it leaves",
  away: "moves towards the other face",
  far: "does not come near flat on this face",
  falls: "falls flat; the equations do not say what comes next",
};

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

/** Sum over [from, to] by panels; f(x, weight) adds to the sums itself. */
function panelSum(from, to, panels, f) {
  const width = (to - from) / panels;
  for (let n = 0; n < panels; n++) for (const [x, w] of GAUSS) f(from + width * (n + x), width * w);
}

/** Sum over [0, length] counted from a slow start. */
function gradedSum(length, parts, f) {
  let outer = length;
  for (let n = 0; n < PANELS; n++) {
    panelSum(outer / SHRINK, outer, parts, f);
    outer /= SHRINK;
  }
  for (const [x, w] of GAUSS) f(outer * x * x, 2 * outer * x * w);
}

/** sums(parts), with parts doubled until chi and time stay as they are; null where they do not. */
function settled(sums) {
  let before = sums(1);
  for (let parts = 2; parts <= MOST_PARTS; parts *= 2) {
    const now = sums(parts);
    if (Math.abs(now.chi - before.chi) + Math.abs(now.time - before.time) < SETTLED * (1 + now.time)) return { ...now, parts };
    before = now;
  }
  return null;
}

/** E - V at h; `start` is what it is at hEnd. */
function left(stretch, h, at) {
  const { body, X, Y, level, hEnd, start } = stretch;
  const down = Math.log(hEnd / h);
  if (start > SLOW || down > BESIDE) return level - at.V;
  const slope = (x) => point(hEnd * Math.exp(-x * down), X, Y, body).slope;
  return start + down * GAUSS.reduce((sum, [x, w]) => sum + w * slope(x), 0);
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
 * It begins at the vertical with the kinetic energy `start`, or at rest at a turning point where the motion does
 * not get there. `null` where the motion stays on the other hemisphere.
 */
export function stretchOf(motion) {
  const { body, face, sigma3_bar, eta, theta, phidot } = motion;
  const X = sigma3_bar / body.r0;
  const Y = eta / body.I1;
  const other = (2 * body.dr0 * sigma3_bar) - Y;
  const upright = theta === 0.5 * Math.PI;
  const here = upright || theta < 0.5 * Math.PI;
  const h = upright ? VERTICAL : 2 * Math.sin(0.5 * (here ? theta : Math.PI - theta));
  const kinetic = 0.5 * body.M * phidot * phidot;
  const level = kinetic + point(h, X, here ? Y : other, body).V;
  const common = { body, face, X, Y, level, hEnd: VERTICAL };
  if (upright) return { ...common, start: kinetic };
  // Up to the vertical in small steps: does the motion get there?
  let below = h;
  for (let i = 1; i <= SCAN; i++) {
    const next = h + ((VERTICAL - h) * i) / SCAN;
    if (level < point(next, X, here ? Y : other, body).V) {
      if (!here) return null;
      return { ...common, hEnd: refine(Math.log(next), Math.log(below), level, X, Y, body), start: 0 };
    }
    below = next;
  }
  return { ...common, start: level - point(VERTICAL, X, Y, body).V };
}

/** chi, time and theta_min of the passage over a stretch to its turning point and back, or { told }. */
export function passage(stretch) {
  const { body, X, Y, level, hEnd, start } = stretch;
  if (start === 0) {
    const { slope } = point(hEnd, X, Y, body);
    if (Math.abs(slope) < LEAST_SLOPE) return { told: Math.abs(slope) < ROUNDING ? TOLD.rests : TOLD.near };
    if (slope < 0) return { told: TOLD.away };
  }
  const hTurn = turningPoint(hEnd, level, X, Y, body);
  if (!(hTurn < hEnd)) return { told: TOLD.far };
  const yEnd = Math.acosh(hEnd / hTurn);
  const decay = 1 + Math.exp(-2 * yEnd);
  const end = Math.min(1, 0.5 * yEnd);
  const found = settled((parts) => {
    const sums = { chi: 0, time: 0 };
    const add = (y, h, weight) => {
      const at = point(h, X, Y, body);
      const dt = (weight * h * Math.tanh(y)) / (at.shape * Math.sqrt((2 * left(stretch, h, at)) / body.M));
      sums.time += dt;
      sums.chi += (at.ratio / at.q) * dt;
    };
    const farH = (d) => (hEnd * Math.exp(-d) * (1 + Math.exp(2 * (d - yEnd)))) / decay;
    const nearH = (y) => hTurn * (1 + 2 * Math.sinh(0.5 * y) ** 2);
    gradedSum(end, parts, (d, w) => add(yEnd - d, farH(d), w));
    panelSum(0, yEnd - end, parts * Math.ceil(yEnd - end), (y, w) => add(y, nearH(y), w));
    return sums;
  });
  if (!found) return { told: TOLD.near };
  return {
    delta_chi: 2 * found.chi,
    duration: 2 * found.time,
    theta_min: 2 * Math.asin(0.5 * hTurn),
    hTurn,
  };
}

/** The fall on F (eta = 0) with the same sigma3_bar and energy, as a stretch: it may begin later, at rest. */
export function fallOf(stretch) {
  const { body, X, Y, level, hEnd } = stretch;
  const here = point(hEnd, X, Y, body), there = point(hEnd, X, 0, body);
  // From the differences themselves: near F the two energies agree in most digits.
  const start = stretch.start
    + 0.5 * body.I1 * (here.ratio - there.ratio) * (here.ratio + there.ratio)
    + 0.5 * body.J * (here.sigma4 - there.sigma4) * (here.sigma4 + there.sigma4);
  if (start >= 0) return { ...stretch, Y: 0, start };
  let low = 0, high = hEnd;
  for (let i = 0; i < 60; i++) {
    const middle = 0.5 * (low + high);
    if (level < point(middle, X, 0, body).V) high = middle;
    else low = middle;
  }
  return { ...stretch, Y: 0, hEnd: low, start: 0 };
}

/** Time and increase of chi of a fall, down to a tilt; null where they cannot be told. panels: as many, if given. */
export function fall(stretch, tilt = 0, panels = 0) {
  const { body, X, level, hEnd } = stretch;
  if (!(level > 0)) return null;
  const begin = 2 * Math.asin(0.5 * hEnd), near = 0.25 * Math.max(0, begin - tilt);
  const sumsOf = (parts) => {
    const sums = { time: 0, chi: 0 };
    const add = (theta, weight) => {
      const h = 2 * Math.sin(0.5 * theta), at = point(h, X, 0, body);
      const dt = weight / Math.sqrt((2 * left(stretch, h, at)) / body.M);
      sums.time += dt;
      sums.chi += (at.ratio / at.q) * dt;
    };
    gradedSum(near, parts, (d, w) => add(begin - d, w));
    panelSum(tilt, begin - near, 3 * parts, add);
    return sums;
  };
  return panels ? sumsOf(panels) : settled(sumsOf);
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
    const exact = 1 + at.z * acceleration - at.q * speed2, normal = Math.abs(exact) < ROUNDING ? 0 : exact;
    const along = acceleration * at.q + speed2 * at.z + (at.ratio * at.sigma4) / at.q;
    const across = at.ratio * Math.sqrt(speed2) * (1 - 1 / body.J);
    least = Math.min(least, normal);
    most = Math.max(most, normal > 0 ? Math.hypot(along, across) / normal : Infinity);
  }
  return { least, most };
}

/** All that the page says about one motion in numbers; where they are NaN, `told` says why. */
export function readouts(motion) {
  const limit = Math.sign(motion.eta) * motion.body.kappa * Math.PI;
  const nothing = { race_angle: NaN, delta_chi: NaN, fall_angle: NaN, theta_min: NaN, duration: NaN };
  const none = (told) => ({ limit, told, ...nothing, min_normal_force: NaN, max_friction: NaN });
  const stretch = stretchOf(motion);
  if (!stretch) return none(TOLD.away);
  if (motion.eta === 0) return none(TOLD.falls);
  const way = passage(stretch);
  if (way.told) return none(way.told);
  const beside = fall(fallOf(stretch));
  const fallAngle = beside ? 2 * beside.chi : NaN;
  const forces = passageForces(stretch, way.hTurn);
  return {
    limit,
    told: beside ? "" : TOLD.near,
    race_angle: way.delta_chi - fallAngle,
    delta_chi: way.delta_chi,
    fall_angle: fallAngle,
    theta_min: way.theta_min,
    duration: way.duration,
    min_normal_force: forces.least,
    max_friction: forces.most,
  };
}
