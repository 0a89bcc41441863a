"""Chaplygin's solutions and motions by mpmath: slow, to forty digits, and sharing no code with the kernels."""

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


class SlowMotion:
    """A motion in natural units, at first on face +1: sigma3 = X rho + Y D, and (I3/I1) sigma4 = X rho' + Y D'."""

    def __init__(self, disk, X, Y, S, phidot):
        with mpmath.workdps(40):
            self.I1, self.I3, self.X = mpmath.mpf(disk.I1), mpmath.mpf(disk.I3), X
            self.c = self.I3 / ((1 + self.I3) * self.I1)
            rho, drho, _D, _dD = hypergeometric(self.c, 1)
            sigma3, turned = self._rates(Y, mpmath.mpf(1))
            self.sides = Y, rho * turned + drho * sigma3
            self.energy = (self.I1 + 1) / 2 * mpmath.mpf(phidot) ** 2 + self.potential(Y, S)

    @classmethod
    def of_state(cls, disk, phi, phidot, sigma3, sigma4):
        """Seen from the flat state that is nearer, be it face +1 or -1: eq. (3.2)."""
        with mpmath.workdps(40):
            S = 1 - abs(mpmath.sin(mpmath.mpf(phi)))
            rho, drho, D, dD = hypergeometric(mpmath.mpf(disk.I3) / disk.I1 / (1 + mpmath.mpf(disk.I3)), S)
            turned = mpmath.mpf(sigma4) * (1 if phi >= 0.0 else -1) * mpmath.mpf(disk.I3) / disk.I1
            return cls(disk, turned * D - sigma3 * dD, drho * sigma3 - rho * turned, S, phidot)

    @classmethod
    def of_constants(cls, disk, sigma3_bar, eta_hat, phidot, phi=0.0):
        """eta_hat: of face +1."""
        with mpmath.workdps(40):
            I1, I3 = mpmath.mpf(disk.I1), mpmath.mpf(disk.I3)
            r0 = hypergeometric(I3 / ((1 + I3) * I1), 1)[0]
            S = 1 - mpmath.sin(mpmath.mpf(phi))
            return cls(disk, sigma3_bar / r0, I3 / I1 * r0 * mpmath.mpf(eta_hat), S, phidot)

    def _rates(self, Y, S):
        rho, drho, D, dD = hypergeometric(self.c, S)
        return self.X * rho + Y * D, self.X * drho + Y * dD

    def potential(self, Y, S):
        """The amended potential on the face with this Y, eq. (3.8)."""
        with mpmath.workdps(40):
            q2, (sigma3, turned) = S * (2 - S), self._rates(Y, S)
            spin = (1 + self.I3) * (turned * self.I1 / self.I3) ** 2
            return (self.I1 * sigma3**2 / q2 + spin) / 2 + mpmath.sqrt(q2)

    def turns_between(self, low, high):
        """Whether on either face it gets to the tilt `high` (rad), and not to the tilt `low`."""
        with mpmath.workdps(40):
            S = [2 * mpmath.sin(mpmath.mpf(theta) / 2) ** 2 for theta in (low, high)]
            return any(self.potential(Y, S[0]) > self.energy > self.potential(Y, S[1]) for Y in self.sides)
