// Fixed Runge-Kutta steps on the regularised equations, as one would write them in C++ for speed.
//
// The same tableaux and the same field as nearflat's kernels, in the same order, so that without contraction the
// results are the same to the last bit. One motion is followed by plain scalar code; an inner loop over LANES motions
// stands around it, which the compiler turns into vector instructions. The header with the tableaux is written by
// fixed_steps.py from those of nearflat.

#include "tableaux.h"  // RK4, RK8: { STAGES, A[STAGES][STAGES], B[STAGES] }

#ifndef LANES
#define LANES 8
#endif
#define INLINE static inline __attribute__((always_inline))

namespace {

// As in the kernels: constants of the disk that the field needs.
struct Body {
    double inv_kappa2, J_over_M, inv_M, k, inv_J;
};

struct State {
    double q, z, p, rho, sigma4, t, chi, psi;
};

INLINE State field(const State &x, const Body &b) {
    const double qp = x.q * x.p;
    return {
        x.z * qp,
        -x.q * qp,
        x.z * (x.rho * x.rho) * b.inv_kappa2 - x.q * (b.J_over_M * (x.rho * x.sigma4) + b.inv_M * x.z),
        b.k * (qp * x.sigma4) - x.z * (x.rho * x.p),
        b.inv_J * (qp * x.rho),
        x.q,
        x.rho,
        x.z * x.rho - x.q * x.sigma4,
    };
}

// x + h k
INLINE State shift(const State &x, double h, const State &k) {
    return {
        x.q + h * k.q,           x.z + h * k.z, x.p + h * k.p,       x.rho + h * k.rho,
        x.sigma4 + h * k.sigma4, x.t + h * k.t, x.chi + h * k.chi, x.psi + h * k.psi,
    };
}

// One step of a method; loops over stages have constant bounds and are unrolled.
template <typename Method>
INLINE State step(const State &x, double h, const Body &b) {
    State k[Method::STAGES];
#pragma GCC unroll 16
    for (int i = 0; i < Method::STAGES; ++i) {
        State y = x;
#pragma GCC unroll 16
        for (int j = 0; j < i; ++j)
            if (Method::A[i][j] != 0.0) y = shift(y, h * Method::A[i][j], k[j]);
        k[i] = field(y, b);
    }
    State y = x;
#pragma GCC unroll 16
    for (int i = 0; i < Method::STAGES; ++i)
        if (Method::B[i] != 0.0) y = shift(y, h * Method::B[i], k[i]);
    return y;
}

// states: rows of n numbers each, in the order of State. Motion i makes as many steps as its group of lanes needs
// for its longest s_end at steps of `longest`, all of one length, and so ends at s_end[i].
template <typename Method>
long follow(long n, double *states, const double *s_end, double longest, const Body &b) {
    long made = 0;
    for (long first = 0; first + LANES <= n; first += LANES) {
        double x[8][LANES], h[LANES], most = 0.0;
        for (int i = 0; i < LANES; ++i) most = s_end[first + i] > most ? s_end[first + i] : most;
        const long count = static_cast<long>(most / longest) + 1;
        for (int i = 0; i < LANES; ++i) h[i] = s_end[first + i] / static_cast<double>(count);
        for (int c = 0; c < 8; ++c)
            for (int i = 0; i < LANES; ++i) x[c][i] = states[c * n + first + i];
        for (long now = 0; now < count; ++now) {
#pragma GCC ivdep
            for (int i = 0; i < LANES; ++i) {
                const State before = {x[0][i], x[1][i], x[2][i], x[3][i], x[4][i], x[5][i], x[6][i], x[7][i]};
                const State y = step<Method>(before, h[i], b);
                x[0][i] = y.q, x[1][i] = y.z, x[2][i] = y.p, x[3][i] = y.rho;
                x[4][i] = y.sigma4, x[5][i] = y.t, x[6][i] = y.chi, x[7][i] = y.psi;
            }
        }
        for (int c = 0; c < 8; ++c)
            for (int i = 0; i < LANES; ++i) states[c * n + first + i] = x[c][i];
        made += count * LANES;
    }
    return made;
}

}  // namespace

// n is a multiple of LANES. Returns how many steps were made.
extern "C" long follow_rk4(long n, double *states, const double *s_end, double longest, const Body *b) {
    return follow<RK4>(n, states, s_end, longest, *b);
}

extern "C" long follow_rk8(long n, double *states, const double *s_end, double longest, const Body *b) {
    return follow<RK8>(n, states, s_end, longest, *b);
}
