"""The compiled layer of nearflat: numbers in, numbers out.

No kernel reads a file, prints, draws or raises; a failed sample carries a :class:`kernels.status.Status`. Where
numba is called, in :mod:`kernels._jit`, the cache of compiled code is kept; and tableaux check their own order
when they are loaded.

Every quantity is in the disk's natural units: length r, time sqrt(r/g), mass m, so that
m = r = g = 1. ``explorer`` converts. "eq. (n.m)" is the number in Cushman & Duistermaat,
"Nearly flat falling motions of the rolling disk", Regul. Chaotic Dyn. 11 (2006) 31-60.

Nomenclature (natural units; angles in radians):

==============  ===========  ================================================================
paper           code         meaning
==============  ===========  ================================================================
I1, I3          I1 I3        transverse and axial moment of inertia, eq. (2.3)
I1 + m r^2      M            inertia of the tilting motion, eq. (3.10)
I3 + m r^2      J            inertia of the rolling motion
kappa           kappa        race number sqrt(M / I1); the contact point races by kappa pi, (7.9)
c               c            m r^2 I3 / (J I1), eq. (4.3)
phi             phi          angle of the disk's plane to the vertical; flat at +-pi/2
--              theta        pi/2 - phi, the angle of the body axis to the vertical
cos phi         q            height of the centre over r; carried as a state of its own
sin phi         z            sigma_1, eq. (2.14)
-phi'           p            d theta / dt; sigma_2 = -q p
sigma_3         sigma3       eq. (2.14)
--              rho          sigma_3 / q, bounded by the energy
sigma_4         sigma4       spin about the body axis, eq. (2.14)
chi, psi        chi psi      angle of contact in space (2.30) and in the body (2.21)
a               a1 a2        horizontal position of the centre of mass
sigma_3-bar     sigma3_bar   sigma_3 continued to the vertical, a constant of motion (3.5)
eta_+-          eta          signed distance to the lines l_+-, eq. (6.2)
--              eta_hat      eta / (I3 r(0)): how far sigma_4-bar is from its value on the line
--              side         sign of eta: which side of the falling set
r(z)            recessive    recessive solution of Chaplygin's equations, eqs (5.1)-(5.3)
--              dominant     the solution that diverges logarithmically at flat, eq. (5.5)
r(0), r'(0)     r0 dr0       their values at the vertical, eqs (5.11), (5.12)
--              face         +1 or -1: the flat state at phi = +pi/2 or -pi/2
--              s            regularised time, dt = q ds
--              fall_angle   by how much chi turns on the falling set, eta = 0, over the same stretch
--              race_angle   the turn of chi less fall_angle; tends to side kappa pi, (7.9)
==============  ===========  ================================================================
"""
