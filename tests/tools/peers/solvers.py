"""Every peer as its own users would write it: a maker for each, from a tolerance to a function that
solves the first n trajectories and returns chi (n). Makers compile; what they return is timed."""

import warnings

import numpy as np
from tools.peers.problem import I1, KAPPA2, T_END, J, K, M, plain_field, regular_field, work


def scipy_on(method, regular):
    from scipy.integrate import solve_ivp

    starts = work().regular if regular else work().plain
    field = (lambda _s, v: regular_field(v)) if regular else (lambda _t, v: plain_field(v, np.sin, np.cos))
    ends = work().s_end if regular else np.full(starts.shape[1], T_END)

    def make(tolerance):
        def solve(n):
            options = {"method": method, "rtol": tolerance, "atol": tolerance}
            return np.array([solve_ivp(field, (0, ends[i]), starts[:, i], **options).y[-1, -1] for i in range(n)])

        return solve

    return make


def heyoka_scalar(regular):
    import heyoka as hy

    starts, ends = _starts_and_ends(regular)

    def make(tolerance):
        solver = hy.taylor_adaptive(_heyoka_equations(regular), np.zeros(starts.shape[0]), tol=tolerance)

        def solve(n):
            chi = np.empty(n)
            for i in range(n):
                solver.time = 0.0
                solver.state[:] = starts[:, i]
                solver.propagate_until(ends[i])
                chi[i] = solver.state[-1]
            return chi

        return solve

    return make


def heyoka_batch(regular, width=8):
    import heyoka as hy

    starts, ends = _starts_and_ends(regular)

    def make(tolerance):
        zeros = np.zeros((starts.shape[0], width))
        solver = hy.taylor_adaptive_batch(_heyoka_equations(regular), zeros, tol=tolerance)

        def solve(n):
            chi = np.empty(n)
            for i in range(0, n, width):
                solver.set_time(0.0)
                solver.state[:] = starts[:, i : i + width]
                solver.propagate_until(list(ends[i : i + width]))
                chi[i : i + width] = solver.state[-1]
            return chi

        return solve

    return make


def numbalsoda_on(name, regular):
    import numbalsoda
    from numba import carray, cfunc, njit

    method = getattr(numbalsoda, name)
    starts, ends = _starts_and_ends(regular)
    starts = np.ascontiguousarray(starts.T)

    field, size = _compiled_field(regular), starts.shape[1]

    @cfunc(numbalsoda.lsoda_sig)
    def right_hand_side(_t, u, du, _data):
        field(carray(u, size), carray(du, size))

    address = right_hand_side.address

    @njit
    def run(n, tolerance):
        chi = np.empty(n)
        for i in range(n):
            times = np.array([0.0, ends[i]])
            solution, _success = method(address, starts[i], times, rtol=tolerance, atol=tolerance, mxstep=100000)
            chi[i] = solution[-1, -1]
        return chi

    def make(tolerance):
        run(1, tolerance)
        return lambda n: run(n, tolerance)

    return make


def cyrk_on(regular):
    from CyRK import nbsolve_ivp
    from numba import njit

    starts, ends = _starts_and_ends(regular)
    starts = np.ascontiguousarray(starts.T)

    field, size = _compiled_field(regular), starts.shape[1]

    @njit
    def right_hand_side(_t, u):
        du = np.empty(size)
        field(u, du)
        return du

    @njit
    def run(n, tolerance):
        chi = np.empty(n)
        for i in range(n):
            span = (0.0, ends[i])
            solution = nbsolve_ivp(
                right_hand_side, span, starts[i], rtol=tolerance, atol=tolerance, rk_method=2, warnings=False
            )
            chi[i] = solution.y[-1, -1]
        return chi

    def make(tolerance):
        run(1, tolerance)
        return lambda n: run(n, tolerance)

    return make


def diffrax_on(regular):
    import jax

    jax.config.update("jax_enable_x64", True)
    import diffrax
    import jax.numpy as jnp

    starts, ends = _starts_and_ends(regular)

    def field(_t, v, _args):
        return jnp.stack(regular_field(v) if regular else plain_field(v, jnp.sin, jnp.cos))

    def make(tolerance):
        control = diffrax.PIDController(rtol=tolerance, atol=tolerance)

        def one(start, end):
            solution = diffrax.diffeqsolve(
                diffrax.ODETerm(field), diffrax.Dopri8(), 0.0, end, 0.01, start,
                stepsize_controller=control, max_steps=100_000, throw=False, adjoint=diffrax.ForwardMode(),
            )  # fmt: skip
            return solution.ys[-1, -1]

        many = jax.jit(jax.vmap(one))

        def solve(n):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                return np.asarray(many(jnp.asarray(starts[:, :n].T), jnp.asarray(ends[:n])))

        return solve

    return make


def _starts_and_ends(regular):
    if regular:
        return work().regular, work().s_end
    return work().plain, np.full(work().plain.shape[1], T_END)


def _compiled_field(regular):
    """Writes du; for the peers that take a compiled right-hand side, which inlines it."""
    from numba import njit

    @njit
    def regular_into(u, du):
        q, z, p, rho, s4 = u[0], u[1], u[2], u[3], u[4]
        du[0], du[1] = z * q * p, -q * q * p
        du[2] = z * rho * rho / KAPPA2 - q * (J / M * rho * s4 + z / M)
        du[3] = K * q * s4 * p - z * rho * p
        du[4], du[5] = q * p * rho / J, rho

    @njit
    def plain_into(u, du):
        q, z, s3, s4 = np.cos(u[0]), np.sin(u[0]), u[2], u[3]
        du[0] = u[1]
        du[1] = (-I1 * z * s3 * s3 / (q * q * q) + J * s3 * s4 / q + z) / M
        du[2], du[3] = -K * q * u[1] * s4, -u[1] * s3 / (q * J)
        du[4] = s3 / (q * q)

    return regular_into if regular else plain_into


def _heyoka_equations(regular):
    import heyoka as hy

    names = hy.make_vars(*(("q", "z", "p", "rho", "s4", "chi") if regular else ("phi", "w", "s3", "s4", "chi")))
    right = regular_field(names) if regular else plain_field(names, hy.sin, hy.cos)
    return list(zip(names, right, strict=True))
