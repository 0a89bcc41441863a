#!/usr/bin/env -S uv run --script
# /// script
# dependencies = ["nox"]
# ///
"""Sessions: `nox` runs tests and lint, `nox --list` names the others, `nox -s NAME -- ...` passes arguments on."""

import tempfile

import nox

nox.needs_version = ">=2024.4.15"
nox.options.default_venv_backend = "uv|virtualenv"


@nox.session(python=["3.11", "3.12", "3.13"])
def tests(session):
    """The suite, in two processes."""
    session.install("--editable", ".[test]")
    session.run("python", "-m", "pytest", *session.posargs)


@nox.session
def lint(session):
    """Style, format, types, and who imports whom."""
    session.install("--editable", ".[test]")
    session.run("ruff", "check", *session.posargs)
    session.run("ruff", "format", "--check")
    session.run("mypy")
    session.run("lint-imports")


@nox.session(default=False)
def docs(session):
    """Build the site into build/site; a warning is an error. It opens from files."""
    session.install("--editable", ".[docs]")
    session.run("python", "-m", "sphinx", "-W", "--keep-going", "docs", "build/site", *session.posargs)


@nox.session(default=False)
def pictures(session):
    """Run all pages of the guide and write their pictures and made parts anew."""
    session.install("--editable", ".[test,peers]")
    session.run("python", "tests/tools/reference_pages.py")
    session.run("python", "tests/tools/pages.py", *session.posargs)


@nox.session(default=False)
def bounds(session):
    """The tests of kernels with every index checked, compiled into a cache of their own."""
    session.install("--editable", ".[test]")
    environment = {"NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": tempfile.mkdtemp()}
    session.run("python", "-m", "pytest", "tests/kernels", *session.posargs, env=environment)


@nox.session(default=False)
def page(session):
    """Compare the page with Python at all 1,512 settings of its sliders; the suite takes a tenth."""
    session.install("--editable", ".[test]")
    session.run(
        "python", "-m", "pytest", "-n", "0", "tests/browser/test_settings.py", env={"NEARFLAT_SETTINGS": "1"}
    )


@nox.session(default=False)
def peers(session):
    """Write results/peers/: other programs on the same work, on one core. Some minutes."""
    session.install("--editable", ".[peers]")
    session.chdir("tests")
    session.run("python", "-m", "tools.peers.report_peers", env={"OMP_NUM_THREADS": "1"})


@nox.session(python="3.11", venv_backend="uv", default=False)
def lowest(session):
    """The suite with the oldest versions that pyproject.toml allows.

    Old versions warn of newer ones of what they depend on, so warnings are no errors here.
    """
    session.install("--resolution", "lowest-direct", "--editable", ".[test]")
    session.run("python", "-m", "pytest", "-W", "default", *session.posargs)


@nox.session(default=False)
def next(session):
    """The suite with the next releases of numba, NumPy and SciPy, also of those that are not allowed yet."""
    session.install("--editable", ".[test]")
    session.install("--pre", "--upgrade", "numba", "numpy", "scipy")
    session.run("python", "-m", "pytest", *session.posargs)


@nox.session(default=False)
def probability(session):
    """Intervals of `ex.probability` in 100 repetitions, and its agreement with 10^7 plain draws."""
    session.install("--editable", ".[test]")
    more = {"NEARFLAT_REPETITIONS": "100", "NEARFLAT_DRAWS": "10000000"}
    command = ["python", "-m", "pytest", "-n", "0", "tests/explorer/measure/test_probability.py"]
    session.run(*command, *session.posargs, env=more)


@nox.session(default=False)
def fuzz(session):
    """Write results/faults/fuzz.json: 20,000 calls, command lines and edited run folders. Up to half an hour."""
    session.install("--editable", ".[test]")
    command = ["python", "-m", "pytest", "-n", "0", "tests/properties", *session.posargs]
    session.run(*command, env={"NEARFLAT_EXAMPLES": "20000"})


if __name__ == "__main__":
    nox.main()
