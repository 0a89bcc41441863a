"""Chaplygin's solutions by mpmath: slow, to forty digits, and sharing no code with the kernels."""

import math

import mpmath


def hypergeometric(c, S):
    """rho, rho', D, D' from hypergeometric functions: no series of ours, no recurrence.

    rho = S F(a, b; 2; S/2) with a + b = 1, ab = c. The solution recessive at the other flat state
    is rho(2 - S), and the one that vanishes at S = 1 with Wronskian -1 is
    D = (rho(2 - S) - rho(S)) / (2 r(0) r'(0)).
    """
    digits = 40 + max(0, int(-math.log10(S)))
    with mpmath.workdps(digits):
        c, S = mpmath.mpf(c), mpmath.mpf(S)
        root = mpmath.sqrt(1 - 4 * c)
        a, b = (1 + root) / 2, (1 - root) / 2

        def rho(x):
            return (x * mpmath.hyp2f1(a, b, 2, x / 2)).real

        def drho(x):
            return mpmath.hyp2f1(a, b, 1, x / 2).real  # d/dx [x F(a,b;2;x/2)] = F(a,b;1;x/2)

        scale = 2 * rho(mpmath.mpf(1)) * drho(mpmath.mpf(1))
        other, dother = rho(2 - S), drho(2 - S)
        return rho(S), drho(S), (other - rho(S)) / scale, -(dother + drho(S)) / scale
