"""The comparison with other solvers: its loop in C++, and that its tables hold what was measured."""

import re
from pathlib import Path

import numpy as np
import pytest
from tools.peers import cpp, tables
from tools.peers.measuring import PEER, PUBLIC, Row
from tools.peers.problem import DISK

from explorer import compiled

ROOT = Path(__file__).parents[1]
LONG = 1e6  # so that the time does not shorten a step
STEPS = 64


def recorded(method, control):
    """(states (8, n) before each step, states after it, steps (n)) of our kernel, one motion that runs free."""
    body, x = DISK.natural.body, compiled.field.reduced_state(1.0, 0.0, -1.0, 1.0, 0.65)
    unit, attempt = compiled.field.pace(x, body), compiled.engine.at_depth(method, 8)
    control, length = compiled.attempt.first_step(method, control, unit)
    states = [x]
    for _ in range(STEPS):
        x, _accepted, _following = attempt(x, length, control, unit, body)
        states.append(x)
    rows = np.array(states)[:, :8]
    return rows[:-1].T, rows[1:].T, np.full(STEPS, length)


@pytest.mark.skipif(cpp.compiler() is None, reason=cpp.NO_COMPILER)
@pytest.mark.parametrize(("name", "method", "control"), [("rk4", 0, 0.05), ("rk8", 2, 0.3)])
def test_the_loop_in_cpp_makes_our_steps_to_rounding(name, method, control):
    before, after, steps = recorded(method, control)
    count = steps.size // cpp.LANES * cpp.LANES
    assert count > 2 * cpp.LANES
    states = np.ascontiguousarray(before[:, :count])
    assert cpp.follow(name, False, states, np.ascontiguousarray(steps[:count]), LONG) == count
    np.testing.assert_allclose(states, after[:, :count], rtol=1e-13, atol=1e-13)


@pytest.mark.skipif(cpp.compiler() is None, reason=cpp.NO_COMPILER)
def test_the_loop_in_cpp_takes_as_many_steps_as_its_longest_lane_needs():
    before, _after, _steps = recorded(0, 0.05)
    together = np.ascontiguousarray(before[:, : cpp.LANES])
    alone, s_end = together.copy(), np.resize([1.0, 0.25], cpp.LANES)
    assert cpp.follow("rk4", False, together, s_end, 0.13) == 8 * cpp.LANES
    for _ in range(8):
        assert cpp.follow("rk4", False, alone, s_end / 8.0, 1.0) == cpp.LANES
    np.testing.assert_array_equal(together, alone)
    with pytest.raises(ValueError, match="multiple of"):
        cpp.follow("rk4", False, together, s_end[:3], 0.1)


def row(name, setting, kind, p99, rate, wrong=0, unresolved=0):
    return Row(name, setting, kind, p99 / 3.0, p99, wrong, unresolved, rate)


ROWS = [
    row("passages, rk4", 1e-3, PUBLIC, 2e-4, 4000.0),
    row("passages, rk8", 1e-3, PUBLIC, 1e-4, 6000.0),
    row("passages, rk8", 1e-6, PUBLIC, 2e-6, 5000.0),  # misses what was asked
    row("passages, dop853", 1e-6, PUBLIC, 2e-7, 9000.0, unresolved=1),
    row("passages, dopri5", 1e-6, PUBLIC, 2e-7, 3000.0),
    row("passages, quadrature", 1e-11, PUBLIC, 4e-14, 90000.0),
    row("heyoka batch, plain", 1e-3, PEER, 7.0, 9000.0, wrong=11),
    row("heyoka batch, plain", 1e-4, PEER, 3e-4, 2000.0),
    row("heyoka batch, plain", 1e-7, PEER, 1e-7, 1500.0),
    row("heyoka batch, plain", 1e-12, PEER, 1e-10, 100.0),
]


def cells(lines, name):
    (line,) = (line for line in lines if line.startswith(f"| {name} |"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


def test_ratios_are_of_rows_that_were_measured_and_hold_the_error_with_every_trajectory_right():
    found = cells(tables.ratios(ROWS), "heyoka batch, plain")
    integrated, simulated, quadrature = found[:3], found[3:6], found[6:]
    assert integrated == ["3.0", "2.0", "-"]
    assert simulated == ["-", "-", "-"]
    assert quadrature == ["-", "-", "900", "900"]
    assert len(tables.ratios(ROWS)) == 3  # a head, a rule and the one peer that was there


def test_what_the_readme_quotes_is_what_the_results_say():
    front = next(line for line in (ROOT / "README.md").read_text("utf-8").splitlines() if tables.FRONT in line)
    page = (ROOT / "results" / "peers" / "README.md").read_text("utf-8").splitlines()
    plain, regular = (
        cells([line for line in page if line.count("|") > 10], f"heyoka batch, {kind}")
        for kind in ("plain", "regularised")
    )
    said = re.findall(r"\d+(?:\.\d+)?", front.removeprefix(tables.FRONT))[:4]
    assert said == [plain[7], plain[1], regular[7], regular[1]]
