"""`nearflat paper`: every statement checked, every figure drawn, every misprint shown with its evidence."""

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed

from explorer import compiled
from explorer.errors import InputError, note
from explorer.paper.statement import Finding, Statement, chosen

_MODULES = ("mechanics", "reduction", "chaplygin", "fall", "membership", "race", "jump", "figure_statement")
_SEAL = "<!-- sha256 of all above: "
DPI = 150


@dataclass(frozen=True)
class Row:
    """A statement with what was found; `trouble` says why it could not be computed."""

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
                {
                    "computed": f.computed,
                    "measured": printed(f.measured),
                    "expected": printed(f.expected),
                    "error": f.error if math.isfinite(f.error) else None,
                    "tolerance": f.tolerance,
                    "reason": f.reason,
                    "verdict": verdict(f.passed),
                }
                for f in self.findings
            ],
        }


def verdict(passed: bool) -> str:
    return "holds" if passed else "FAILS"


def all_statements(only: str | None = None) -> list[Statement]:
    """The rows of the paper in order. Raises InputError where `only` names none of them."""
    for name in _MODULES:
        import_module(f"explorer.paper.{name}")
    return chosen(only)


def check_row(row: Statement) -> Row:
    """Compute one statement. Whatever goes wrong in it is a failure of that row alone."""
    try:
        return Row(row, tuple(row.check()))
    except Exception as error:
        return Row(row, (), f"{type(error).__name__}: {error}")


def check_all(only: str | None = None, jobs: int = 2) -> list[Row]:
    """Check all statements, or one."""
    rows = all_statements(only)
    compiled.warmup()
    return list(Parallel(n_jobs=jobs, backend="threading")(delayed(check_row)(row) for row in rows))


def paper(out: Path | str, *, only: str | None = None, jobs: int = 2, quiet: bool = True) -> list[Row]:
    """Check the statements; all of them, then write statements.md, misprints.md and the figures.

    Raises InputError for an unknown statement or a folder that cannot be written.
    """
    if not isinstance(jobs, int) or jobs < 1:
        raise InputError(f"--jobs {jobs}: give a whole number, 1 or more")
    folder = Path(out)
    if folder.exists() and not folder.is_dir():
        raise InputError(f"--out {folder}: is a file; give a folder")
    all_statements(only)
    note("checking the statements", quiet)
    rows = check_all(only, jobs)
    if only is None:
        try:
            _write(folder, rows, quiet)
        except OSError as error:
            raise InputError(f"--out {folder}: cannot be written ({error.strerror})") from None
    return rows


def _write(folder: Path, rows: Sequence[Row], quiet: bool) -> None:
    """All pages and pictures."""
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    write_sealed(folder / "statements.md", statements_page(rows))
    note("drawing the figures", quiet)
    _write_figures(folder / "figures")
    (folder / "README.md").write_text(figures_page(), encoding="utf-8")
    note("weighing the misprints", quiet)
    write_sealed(folder / "misprints.md", import_module("explorer.paper.misprints").misprints_page())


def _write_figures(folder: Path) -> None:
    figures = import_module("explorer.paper.figures")
    for number in sorted(figures.FIGURES):
        drawn = figures.figure(number)
        for kind in ("png", "svg"):
            drawn.savefig(folder / f"figure-{number}.{kind}", dpi=DPI)


def figures_page() -> str:
    """The figures with their captions, as Markdown."""
    figures = import_module("explorer.paper.figures").FIGURES
    lines = [
        "# The paper, reproduced",
        "",
        "Made by `nearflat paper`. Statements and what was found: [statements.md](statements.md). Misprints, with",
        "the numbers that decide them: [misprints.md](misprints.md). Cushman & Duistermaat, *Nearly flat falling",
        "motions of the rolling disk*, Regul. Chaotic Dyn. 11 (2006) 31-60.",
    ]
    for number in sorted(figures):
        lines += ["", f"## Figure {number}", "", f'<img src="figures/figure-{number}.png" width="700">', ""]
        lines.append(figures[number].caption)
    return "\n".join(lines) + "\n"


def statements_page(rows: Sequence[Row]) -> str:
    """The statements with what was computed, found and expected, as Markdown."""
    failed = [row.statement.name for row in rows if not row.passed]
    lines = [
        "# The statements of the paper, checked",
        "",
        "Made by `nearflat paper`. Cushman & Duistermaat, *Nearly flat falling motions of the rolling disk*,",
        "Regul. Chaotic Dyn. 11 (2006) 31-60. [corrected]: as `misprints.md` says.",
        "",
        f"{len(rows) - len(failed)} of {len(rows)} hold." + (f" Failing: {', '.join(failed)}." if failed else ""),
    ]
    for row in rows:
        lines += [
            "",
            f"## {row.statement.number}. {row.statement.name}: {verdict(row.passed)}",
            "",
            row.statement.text,
        ]
        if row.trouble is not None:
            lines += ["", f"Could not be computed: {row.trouble}"]
        if row.findings:
            lines += [
                "",
                "| computed | measured | expected | compared | at most | because | |",
                "|---|---|---|---|---|---|---|",
            ]
            lines += [_cells(finding) for finding in row.findings]
    return "\n".join(lines) + "\n"


def _cells(finding: Finding) -> str:
    cells = (
        finding.computed,
        printed(finding.measured),
        printed(finding.expected),
        f"{finding.error:.1e}",
        f"{finding.tolerance:.1e}",
        finding.reason,
        verdict(finding.passed),
    )
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def printed(value: Any) -> str:
    """A number, a list of numbers or words, to ten digits."""
    if isinstance(value, str | bool):
        return str(value)
    if isinstance(value, float | int):
        return f"{value:.10g}"
    try:
        return ", ".join(printed(item) for item in value)
    except TypeError:
        return f"{float(value):.10g}"


def write_sealed(path: Path, text: str) -> None:
    """A generated page with a digest of itself at its end, by which a hand edit is noticed."""
    digest = hashlib.sha256(text.encode()).hexdigest()
    path.write_text(f"{text}\n{_SEAL}{digest} -->\n", encoding="utf-8")


def is_sealed(path: Path) -> bool:
    """Whether a page is as it was generated."""
    text, seal, rest = path.read_text(encoding="utf-8").rpartition(f"\n{_SEAL}")
    return bool(seal) and rest.split(" ")[0] == hashlib.sha256(text.encode()).hexdigest()


def headline(rows: Sequence[Row]) -> Iterator[str]:
    """Lines for a person: what fails, and how many hold."""
    for row in rows:
        if row.passed:
            continue
        yield f"{row.statement.number} {row.statement.name} FAILS: {row.trouble or row.statement.text}"
        for finding in row.findings:
            if not finding.passed:
                found = f"{printed(finding.measured)}, expected {printed(finding.expected)}"
                off = f"compared {finding.error:.1e}, at most {finding.tolerance:.1e}"
                yield f"  {finding.computed}: {found} ({off})"
    yield f"{sum(row.passed for row in rows)} of {len(rows)} statements hold."
