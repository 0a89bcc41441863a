"""`nearflat paper`: the paper as checks, figures and misprints."""

import argparse
from pathlib import Path

from explorer.commands import Answer
from explorer.errors import InputError, note, positive
from explorer.paper.statement import ETA_HAT
from explorer.phase.disk import Disk
from explorer.scenes.options import DISK, FOLDER, NUMBER, TEXT, Options, option, whole_from, workers


class Paper(Options):
    """What is checked or drawn, and where it goes."""

    only: str | None = option(
        TEXT._replace(metavar="NAME"), "one statement, by name or number; nothing is written"
    )
    figure: int | None = option(whole_from(1, 9), "one figure, 1 to 9; no statement is checked")
    disk: Disk | None = option(DISK, "with figure: another body, as for run")
    eta_hat: float = option(
        NUMBER._replace(metavar="SIZE"), "with figure: distance from F, in sqrt(g/r)", default=ETA_HAT
    )
    out: Path = option(FOLDER, "folder", default=Path("results/paper"))
    jobs: int = workers("threads")


add_arguments = Paper.add_to
_ABOUT = """`nearflat paper`. Statements and their numbers: [statements.md](statements.md). Misprints, with the
numbers that prove them: [misprints.md](misprints.md). Cushman & Duistermaat, *Nearly flat falling motions of the
rolling disk*, Regul. Chaotic Dyn. 11 (2006) 31-60. For another body, or closer to the falling set F:
`nearflat paper --figure 8 --disk annulus:0.4 --eta-hat 3e-3`.

All motions start upright with σ₂ = σ₃ = 1, in units m = r = g = 1. For an upright disk, σ₂ is φ̇."""


def call(options: argparse.Namespace) -> Answer:
    """Check the statements, or one; or draw a figure."""
    from explorer.paper.pages import headline, line_of, paper

    given = Paper.said(options)
    chosen = Paper.of(given)
    if chosen.figure is not None:
        return _figure(chosen, chosen.figure, options.quiet)
    for name in ("disk", "eta_hat"):
        if name in given:
            raise InputError(f"{name} {given[name]}: only with a figure; the statements are of the paper's bodies")
    rows = paper(chosen.out, only=chosen.only, jobs=chosen.jobs, quiet=options.quiet)
    if chosen.only is None:
        figures_page(chosen.out)
    holding, lines = sum(row.passed for row in rows), list[str]()
    for row in rows if chosen.only is not None else ():
        lines.append(f"{row.statement.number} {row.statement.name}: {row.statement.text}")
        lines += map(line_of, row.findings)
    record = {"holding": holding, "failing": len(rows) - holding, "rows": [row.describe() for row in rows]}
    return Answer(record, "\n".join([*lines, *headline(rows)]), int(holding < len(rows)))


def figures_page(folder: Path) -> None:
    """Write the README.md of a folder: the figures with their captions, and what was inferred to draw them."""
    from explorer.commands.pages import write_page
    from explorer.paper.figures import FIGURES, INFERRED

    parts = [(f"Figure {n}", list[str](), [folder / "figures" / f"figure-{n}.png"]) for n in FIGURES]
    write_page(folder, "The paper, reproduced", "\n".join([_ABOUT, *INFERRED]), parts)


def _figure(chosen: Paper, number: int, quiet: bool) -> Answer:
    """One figure, and nothing else; the sign of a distance means nothing, since each figure has its own sides."""
    from explorer.paper.pages import one_figure

    if chosen.only is not None:
        raise InputError("only and figure: give one of them")
    if chosen.eta_hat < 0.0:
        note(f"eta_hat {chosen.eta_hat:g}: the sign is left out; each figure shows its own sides of F", quiet)
    note(f"drawing figure {number}; the first time, kernels are compiled", quiet)
    paths = one_figure(chosen.out, number, chosen.disk, positive("eta_hat", abs(chosen.eta_hat)))
    return Answer({"files": [str(path) for path in paths]}, "\n".join(f"wrote {path}" for path in paths))
