"""Passages by tables against arcs, sample by sample, ordinary and hostile."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from conftest import BODIES
from passing import batch, draw

import explorer as ex
from explorer.motion.falls import departures_of_energy, falls_as_arcs
from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.integrals import passages, tabulated
from kernels.integrals.tables import Low
from kernels.types import Matrix, Vector

ROOT = Path(__file__).parents[3]
EXTREME_BODIES = {
    "rim": ex.Disk(I1=1e-4, I3=2e-4),
    "massive-core": ex.Disk(I1=1e3, I3=2e3),
    "thin-axis": ex.Disk(I1=0.4, I3=4e-4),
}
ALL = {**BODIES, **EXTREME_BODIES}


@pytest.mark.parametrize("wild", [False, True], ids=["ordinary", "wild"])
@pytest.mark.parametrize("name", ALL)
def test_tables_and_arcs_agree_within_their_stated_errors(name, wild):
    samples = draw(np.random.default_rng(3), 3000, wild)
    for accuracy in (1e-11, 1e-6, 1e-4, 1e-3):
        fast, fast_status = batch(ALL[name], *samples, accuracy, True)
        slow, slow_status = batch(ALL[name], *samples, accuracy, False)
        # Where an estimate lies next to the accuracy asked, one may give it and the other not.
        assert np.mean(fast_status != slow_status) < 0.02
        ok = (fast_status == 0) & (slow_status == 0)
        angle = np.fmax(abs(fast[1] - slow[1]), abs(fast[2] - slow[2]))[ok]
        scale = np.fmax(abs(fast[3] / slow[3] - 1), abs(fast[0] / slow[0] - 1))[ok]
        assert (angle <= 10 * (fast[5] + slow[5])[ok] + 1e-13).all()
        assert (scale <= 10 * (fast[6] + slow[6])[ok] + 1e-13).all()
        assert (fast[5:7][:, ok] >= 0.0).all()
        assert (slow[5:7][:, ok] >= 0.0).all()
        assert (np.sign(fast[7][ok]) == np.sign(slow[7][ok])).all()


@pytest.mark.parametrize("name", ["uniform", "hoop", "matching"])
def test_ordinary_passages_are_all_left_to_the_tables(name):
    rng = np.random.default_rng(4)
    disk, n = BODIES[name], 20_000
    s3, speed = rng.uniform(-2, 2, n), rng.uniform(0.5, 2, n)
    eta_hat = rng.choice([-1.0, 1.0], n) * 10.0 ** rng.uniform(-280, -2, n)
    fast = batch(disk, s3, eta_hat, speed, 1e-11, True)[0]
    slow = batch(disk, s3[:500], eta_hat[:500], speed[:500], 1e-11, False)[0]
    assert not (fast[5, :500] == slow[5]).any()  # estimates of two kinds
    assert (fast[5] <= 1e-11 * np.fmax(1.0, abs(fast[1]))).all()


def test_a_few_passages_are_left_to_the_tables_and_agree_with_arcs():
    samples = np.array([[1.0, -0.3, 0.5], [1e-3, -1e-8, 1e-5], [1.0, 1.5, 0.7]])
    (fast, _), (slow, _) = (batch(BODIES["uniform"], *samples, 1e-11, tables) for tables in (True, False))
    assert not (fast[5:7] == slow[5:7]).any()
    assert (abs(fast - slow)[1:4] <= 1e-11 * slow[3]).all()
    assert (fast[5:7] <= 1e-11).all()


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick", "coin"])
def test_falls_by_tables_and_as_arcs_agree(name):
    disk, n = BODIES[name], 2000
    rng = np.random.default_rng(7)
    b = disk.body
    s3, speed = rng.uniform(-3, 3, n), rng.uniform(0.05, 3, n)
    sigma4 = b.dr0 * s3 / (b.k * b.r0)
    energy = 0.5 * (b.M * speed**2 + b.I1 * s3**2 + b.J * sigma4**2) + 1.0
    departures, tables = departures_of_energy(disk, s3, energy), np.empty((4, n))
    passages.fall_batch(departures, 0.0, disk.tables, disk.natural, tables)
    arcs = falls_as_arcs(disk, departures, np.arange(n), 0.0, 1e-13)
    served = np.isfinite(tables[0])
    assert served.mean() > 0.8
    assert (abs(tables[:3] - arcs[:3]) <= 10 * (tables[3] + arcs[3]) + 1e-13)[:, served].all()
    assert (arcs[3] <= 1e-9).all()


def test_the_lanes_are_really_vectorised():
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Matrix, Body, Low)))
    options = tabulated.near_panel.targetoptions
    fresh = numba.njit(signature, fastmath=options["fastmath"], error_model="numpy")(tabulated.near_panel.py_func)
    (assembly,) = fresh.inspect_asm().values()
    found = re.findall(r"^\s+v?f?n?m?(?:add|sub|mul)\w*(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 10 * found.count("sd")


# Rows of the work arrays are numbered by one range in each file; these put them into another order.
_ORDERS = ("range(ROWS)", "reversed(range(ROWS))", "(7 * row % ROWS for row in range(ROWS))")
_PASSAGES = """
import numpy as np
from kernels.disk.body import make_disk
from kernels.integrals import passages
from kernels.integrals.tables import make_tables
gauss = lambda n: np.stack(np.polynomial.legendre.leggauss(n))
disk = make_disk(0.25, 0.5)
few, many = (gauss(10), gauss(10), gauss(10)), (gauss(24), gauss(40), gauss(56))
tables = make_tables(disk, [few] * 4 + [many] * 7)
crossings = passages.Crossings(*np.array([[1.0, -0.3, 1e3], [1e-3, -1e-200, 0.2], [1.0, 0.7, 1e-3]]))
out, status, falls = np.empty((8, 3)), np.zeros(3, np.int8), np.empty((4, 3))
passages.rough_batch(crossings, 1e-3, tables, disk, out, status)
found = [*out.ravel()]
passages.passage_batch(crossings, 1e-9, tables, disk, out, status)
given = passages.Departures(*np.array([[1.0, -0.3, 0.5], [2.5, 1.9, 2.4], [1.0, 0.8, 1e-9], [1e-16] * 3]))
passages.fall_batch(given, 0.0, tables, disk, falls)
print([x.hex() for x in (*found, *out.ravel(), *falls.ravel())], status.tolist())
"""


def test_no_answer_depends_on_the_order_of_the_rows(tmp_path):
    """Interpreted, so that the rows may be renumbered without compiling."""
    shutil.copytree(ROOT / "kernels", tmp_path / "kernels", ignore=shutil.ignore_patterns("__pycache__"))
    path = tmp_path / "kernels" / "integrals" / "sums.py"
    text = path.read_text(encoding="utf-8")
    assert text.count(") = range(ROWS)") == 1
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_DISABLE_JIT": "1"}
    answers = set()
    for order in _ORDERS:
        path.write_text(text.replace(") = range(ROWS)", f") = {order}"), encoding="utf-8")
        command = [sys.executable, "-c", _PASSAGES]
        done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        answers.add(done.stdout)
    assert len(answers) == 1
