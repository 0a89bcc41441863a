"""`nearflat paper`: every statement checked, every figure drawn, every misprint shown with its evidence."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.errors import InputError, jobs_of, note
from explorer.paper import (
    figure_numbers,
    section_2,
    section_3_4,
    section_5,
    section_6_1,
    section_6_2,
    section_6_3,
    section_7_1,
    section_7_3,
)
from explorer.paper.figures import ETA_HAT, FIGURES, INFERRED, INFERRED_TOO, figure
from explorer.paper.misprints import misprints_page
from explorer.paper.statement import Finding, Statement, chosen, shown
from explorer.phase.disk import Disk
from explorer.phase.paths import made_folder, path_of
from explorer.pictures.register import save

# The statements of these are registered as they are imported.
SECTIONS = (
    *(section_2, section_3_4, section_5, section_6_1, section_6_2, section_6_3, section_7_1, section_7_3),
    figure_numbers,
)

_EACH = 10  # statements after which a line says how far the checks are


@dataclass(frozen=True)
class Row:
    """A statement with its findings; `trouble` says why it could not be computed."""

    statement: Statement
    findings: tuple[Finding, ...]
    trouble: str | None = None

    @property
    def passed(self) -> bool:
        return self.trouble is None and bool(self.findings) and all(f.passed for f in self.findings)

    def describe(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "number": self.statement.number,
            "name": self.statement.name,
            "statement": self.statement.text,
            "verdict": verdict(self.passed),
            "trouble": self.trouble,
            "findings": [
                asdict(f)
                | {"measured": shown(f.measured), "expected": shown(f.expected), "verdict": verdict(f.passed)}
                | {"error": f.error if math.isfinite(f.error) else None}
                for f in self.findings
            ],
        }


def verdict(passed: bool) -> str:
    """How a row or a finding came out, in a word."""
    return "holds" if passed else "FAILS"


def check_row(row: Statement) -> Row:
    """Compute one statement. Whatever goes wrong in it is a failure of that row alone."""
    try:
        return Row(row, tuple(row.check()))
    except Exception as error:
        return Row(row, (), f"{type(error).__name__}: {error}")


def check_all(only: str | None = None, jobs: int = 2, quiet: bool = True) -> list[Row]:
    """Check all statements, or one, and say how far it is. Raises InputError where `only` names none of them."""
    from joblib import Parallel, delayed

    rows = chosen(only)
    compiled.warmup()
    done = []
    side_by_side = Parallel(n_jobs=jobs, backend="threading", return_as="generator")
    for row in side_by_side(delayed(check_row)(statement) for statement in rows):
        done.append(row)
        if len(done) % _EACH == 0:
            note(f"checked {len(done)} of {len(rows)}", quiet)
    return done


def paper(out: Path | str, *, only: str | None = None, jobs: int = 2, quiet: bool = True) -> list[Row]:
    """Check the statements; all of them, then write statements.md, misprints.md and the figures.

    Raises InputError for an unknown statement or a folder that cannot be written.
    """
    jobs, folder = jobs_of("--jobs", jobs), Path(out) if only is not None else path_of("--out", out)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"--out {folder}: is a file; give a folder")
    chosen(only)
    note("checking the statements", quiet)
    rows = check_all(only, jobs, quiet)
    if only is None:
        _write(made_folder("--out", folder), rows, quiet)
    return rows


def _write(folder: Path, rows: Sequence[Row], quiet: bool) -> None:
    """All pages and pictures."""
    (folder / "figures").mkdir(exist_ok=True)
    for name, page in pages(rows).items():
        (folder / name).write_text(page, encoding="utf-8")
    for number in sorted(FIGURES):
        note(f"drawing figure {number}", quiet)
        drawn = figure(number)
        for kind in ("png", "svg"):
            save(drawn, folder / "figures" / f"figure-{number}.{kind}")


def one_figure(folder: Path | str, number: int, disk: Disk | None, eta_hat: float) -> list[Path]:
    """Draw one figure, of the paper's own body or of another, into figures/ of a folder; returns the files.

    Raises InputError.
    """
    where = made_folder("--out", path_of("--out", folder) / "figures")
    drawn = figure(number, disk, eta_hat)
    name = f"figure-{number}"
    if disk is not None or eta_hat != ETA_HAT:
        name += f"-{(disk or FIGURES[number].disk).name}-{eta_hat:g}"
    paths = [where / f"{name}.{kind}" for kind in ("png", "svg")]
    for path in paths:
        save(drawn, path)
    return paths


def pages(rows: Sequence[Row]) -> dict[str, str]:
    """The Markdown pages of checked rows, by the name of the file."""
    return {
        "statements.md": statements_page(rows),
        "misprints.md": misprints_page((row.statement, row.findings) for row in rows),
        "README.md": figures_page(),
    }


def figures_page() -> str:
    """The figures with their captions, as Markdown."""
    lines = [
        "# The paper, reproduced",
        "",
        "Made by `nearflat paper`. Statements and their numbers: [statements.md](statements.md). Misprints, with",
        "the numbers that decide them: [misprints.md](misprints.md). Cushman & Duistermaat, *Nearly flat falling",
        "motions of the rolling disk*, Regul. Chaotic Dyn. 11 (2006) 31-60. Another body, or nearer to F:",
        "`nearflat paper --figure 8 --disk annulus:0.4 --eta-hat 3e-3`.",
        "",
        "All start upright with σ₂ = σ₃ = 1, in units m = r = g = 1.",
        INFERRED,
        *INFERRED_TOO,
    ]
    for number in sorted(FIGURES):
        caption = FIGURES[number].caption(FIGURES[number].disk, ETA_HAT)
        picture = f'<img src="figures/figure-{number}.png" width="700" alt="{caption}">'
        lines += ["", f"## Figure {number}", "", picture, "", caption]
    return "\n".join(lines) + "\n"


def statements_page(rows: Sequence[Row]) -> str:
    """The statements with what was computed, measured and expected, as Markdown."""
    failed = [row.statement.name for row in rows if not row.passed]
    lines = [
        "# The statements of the paper, checked",
        "",
        "Made by `nearflat paper`. Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*,",
        "Regul. Chaotic Dyn. 11 (2006) 31-60. [corrected]: as `misprints.md` says.",
        "",
        "Each comparison gives what was computed, the number that came out, the one that the paper leads to, how",
        "far they are apart (compared), how far they may be (at most) and why that much (because).",
        "",
        f"{len(rows) - len(failed)} of {len(rows)} hold." + (f" Failing: {', '.join(failed)}." if failed else ""),
    ]
    for row in rows:
        heading = f"## {row.statement.number}. {row.statement.name}: {verdict(row.passed)}"
        lines += ["", heading, "", row.statement.text]
        if row.trouble is not None:
            lines += ["", f"Could not be computed: {row.trouble}"]
        if row.findings:
            lines += [
                "",
                "| computed | measured | expected | compared | at most | because | |",
                "|---|---|---|---|---|---|---|",
                *(_cells(finding) for finding in row.findings),
            ]
    return "\n".join(lines) + "\n"


def _cells(finding: Finding) -> str:
    cells = (
        finding.computed,
        shown(finding.measured),
        shown(finding.expected),
        f"{finding.error:.1e}",
        f"{finding.tolerance:.1e}",
        finding.reason,
        verdict(finding.passed),
    )
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def line_of(finding: Finding) -> str:
    """A finding in one line for the terminal."""
    values = f"{shown(finding.measured)}, expected {shown(finding.expected)}"
    off = f"compared {finding.error:.1e}, at most {finding.tolerance:.1e}"
    return f"  {finding.computed}: {values} ({off})"


def headline(rows: Sequence[Row]) -> Iterator[str]:
    """Lines for the user: what fails, and how many hold."""
    for row in rows:
        if not row.passed:
            yield f"{row.statement.number} {row.statement.name} FAILS: {row.trouble or row.statement.text}"
            yield from (line_of(finding) for finding in row.findings if not finding.passed)
    yield f"{sum(row.passed for row in rows)} of {len(rows)} statements hold."
