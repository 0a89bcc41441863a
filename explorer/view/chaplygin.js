// Chaplygin's equations: the two solutions from which all constants of motion are made.
//
// S = 1 - |sin phi| is the distance from the nearer flat state. With X = sigma3_bar / r(0) and Y = eta / I1,
//     sigma3        = X rho(S)  + Y D(S)
//     face k sigma4 = X rho'(S) + Y D'(S),     k = I3 / I1, ' = d/dS,
// so eta enters as a number of its own, and eta_hat = 1e-300 is an ordinary input. The same formulas are in
// kernels/disk/chaplygin.py; section 5 of the paper.

// The nearest singularity is S = 2, so Chebyshev coefficients on [0, 1] fall like 5.8^-n: 20 is at rounding.
const DEGREE = 20;
// The power series gains one bit per term at S = 1.
const TERMS = 90;

/** Sum of numbers with the rounding errors carried along (Neumaier). */
function exactSum(values) {
  let total = 0;
  let lost = 0;
  for (const value of values) {
    const next = total + value;
    lost += Math.abs(total) >= Math.abs(value) ? total - next + value : value - next + total;
    total = next;
  }
  return total + lost;
}

/** Ascending powers of S of the recessive solution (eqs 5.1-5.3) and of v, the smooth part of the dominant one. */
function powerSeries(c) {
  const r = new Float64Array(TERMS + 2);
  r[1] = 1;
  for (let n = 1; n <= TERMS; n++) r[n + 1] = ((c + n * (n - 1)) / (2 * n * (n + 1))) * r[n];
  const v = new Float64Array(TERMS + 2);
  v[0] = 1;
  for (let k = 1; k <= TERMS; k++) {
    const source = 0.5 * c * (2 * (2 * k + 1) * r[k + 1] - (2 * k - 1) * r[k]);
    v[k + 1] = ((k * (k - 1) + c) * v[k] - source) / (2 * k * (k + 1));
  }
  // A multiple of the recessive solution may be added to v; v(1) = 0 fixes it.
  const share = exactSum(v) / exactSum(r);
  return { r, v: v.map((value, n) => value - share * r[n]) };
}

/** Ascending powers of S on [0, 1] -> ascending powers of 2S - 1, by way of Chebyshev polynomials. */
function economise(coefficients) {
  const chebyshev = [];
  for (let j = 0; j <= DEGREE; j++) {
    const terms = [];
    coefficients.forEach((a, n) => {
      if (n < j) return;
      // C(2n, n - j) / 4^n, factor by factor, so that nothing overflows
      let weight = 1;
      for (let i = 1; i <= n; i++) weight *= (2 * i - 1) / (2 * i);
      for (let i = 1; i <= j; i++) weight *= (n - i + 1) / (n + i);
      terms.push(a * weight);
    });
    chebyshev.push(exactSum(terms) * (j === 0 ? 1 : 2));
  }
  return chebyshevToPowers(chebyshev);
}

/** Coefficients of Chebyshev polynomials -> ascending powers, by Clenshaw's recurrence on polynomials. */
function chebyshevToPowers(chebyshev) {
  let last = new Float64Array(DEGREE + 1);
  let first = new Float64Array(DEGREE + 1);
  for (let j = DEGREE; j >= 1; j--) {
    const next = new Float64Array(DEGREE + 1);
    for (let n = 0; n < DEGREE; n++) next[n + 1] = 2 * first[n];
    for (let n = 0; n <= DEGREE; n++) next[n] -= last[n];
    next[0] += chebyshev[j];
    last = first;
    first = next;
  }
  const powers = new Float64Array(DEGREE + 1);
  for (let n = 0; n < DEGREE; n++) powers[n + 1] = first[n];
  for (let n = 0; n <= DEGREE; n++) powers[n] -= last[n];
  powers[0] += chebyshev[0];
  return powers;
}

/** Polynomials in 2S - 1 for rho/S, rho', v, v', (rho' - 1)/S, as five rows, with r(0) and r'(0). */
export function makeSeries(c) {
  const { r, v } = powerSeries(c);
  const slope = (a) => Float64Array.from(a, (_, n) => (n + 1 < a.length ? (n + 1) * a[n + 1] : 0));
  const dr = slope(r);
  const shifted = (a) => Float64Array.from(a, (_, n) => (n + 1 < a.length ? a[n + 1] : 0));
  const rows = [shifted(r), dr, v, slope(v), shifted(dr)].map(economise);
  return { rows, r0: exactSum(r), dr0: exactSum(dr) };
}

/** The constants of a body in natural units (m = r = g = 1); `series` where Python has computed it already. */
export function makeBody(I1, I3, series = undefined) {
  const M = I1 + 1;
  const J = I3 + 1;
  const c = I3 / (J * I1);
  const { rows, r0, dr0 } = series ?? makeSeries(c);
  const kappa = Math.sqrt(M / I1);
  return { I1, I3, M, J, kappa, c, k: I3 / I1, r0, dr0, rows: rows.map((row) => Float64Array.from(row)) };
}

/** A flat uniform ring; `inner` is its inner over its outer radius: 0 is the uniform disk, 1 the hoop. */
export function annulus(inner) {
  const I3 = 0.5 * (1 + inner * inner);
  return makeBody(0.5 * I3, I3);
}

function horner(row, x) {
  let total = row[DEGREE];
  for (let n = DEGREE - 1; n >= 0; n--) total = total * x + row[n];
  return total;
}

/** rho/S, rho', D, D' and (rho' - 1)/S at 0 <= S <= 1; ln S is passed because S may underflow. */
export function solutions(S, logS, body) {
  const x = 2 * S - 1;
  const [over, slope, v, dv, excess] = body.rows;
  const rhoOverS = horner(over, x);
  const drho = horner(slope, x);
  const D = 0.5 * body.c * S * rhoOverS * logS + horner(v, x);
  const dD = 0.5 * body.c * (drho * logS + rhoOverS) + horner(dv, x);
  return { rhoOverS, drho, D, dD, excess: horner(excess, x) };
}

/** The slope sigma4_bar / sigma3_bar of the line l+, eq. (6.1); l- has the opposite one. */
export function lineSlope(body) {
  return (body.I1 * body.dr0) / (body.I3 * body.r0);
}

/** eta = I3 r(0) eta_hat. */
export function etaHatToEta(etaHat, body) {
  return etaHat * body.I3 * body.r0;
}
