"""`ex.run`, `ex.plan` and `ex.trade`: their options are those that scenes declare; `calls.pyi` names them all.

`python tests/tools/reference_pages.py` makes that file, from which editors and type checkers complete.
"""

import inspect
from collections.abc import Callable
from textwrap import fill, indent
from typing import Any

from explorer.commands.plan import RunPlan, planned
from explorer.commands.trade import TradeOptions, measured
from explorer.motion.work_precision import Trade
from explorer.runs.run import Run, execute
from explorer.runs.settings import Settings, asked
from explorer.scenes.options import Options, described, names_of, options_of
from explorer.scenes.scene import NAMES, Scene, scene_class


def run(scene: str | type[Scene], **options: Any) -> Run:
    """Answer a question about many initial states.

    The options of a scene mean the same here, on the command line, in a TOML file and in run.json, and may be
    given as text. "Units of the disk" are those of its m, r and g; a natural unit of a rate is
    sqrt(g/r), one of an energy is m g r.

    Parameters
    ----------
    scene : str or type
        "falling-set", "measure-zero", "one-sided" or "race-angles"; or a scene of your own, by its class, by
        "my.py:Scene" or, once it is registered, by its name.

    Returns
    -------
    Run
        With the numbers (`summary`), the samples (`frame`, `arrow`, `tables`) and the pictures (`figure`).

    Raises
    ------
    InputError
        For an option that the scene does not take or cannot use; raised before anything is written.
    RunError
        If writing fails or no sample can be computed. What was finished is kept, unless no sample is good.

    Examples
    --------
    >>> import explorer as ex
    >>> races = ex.run("race-angles", disk="hoop", samples=1000)
    >>> races.summary["wrong_way"], round(races.summary["median_plus"], 3)
    (0, 5.441)
    """
    return execute(*asked(scene, options))


def plan(scene: str | type[Scene], **options: Any) -> RunPlan:
    """Show how a run would be computed and what it would cost, without storing anything.

    Parameters
    ----------
    scene : str or type
        As for `run`.

    Returns
    -------
    RunPlan
        Its estimate is good to a factor of two on an idle machine.

    Raises
    ------
    InputError
        As `run` does.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.plan("falling-set", samples=1000).model
    'quadrature'
    """
    return planned(*asked(scene, options))


def trade(**options: Any) -> Trade:
    """Measure the error and the cost of every method on passages near the falling set.

    It is `compare` at several accuracies, beside a quadrature that uses no precomputed tables. Times are on the
    clock, on one core, without compile time. For your own states, use `compare`.

    Parameters
    ----------

    Returns
    -------
    Trade
        `ex.picture("work-precision", found)` draws it; if you print it, you get its table.

    Raises
    ------
    InputError
        For an option that it does not take, and for too few samples.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade(disk="hoop", samples=1024)  # doctest: +SKIP
    """
    return measured(TradeOptions.of(options))


def _entries(kinds: list[type[Options]]) -> dict[str, str]:
    """What help says of each option of a call, by its name: those of the call first, and then those of scenes."""
    takers: dict[str, list[str]] = {}
    texts, entries = dict[str, Any](), dict[str, str]()
    for kind in kinds:
        for each in options_of(kind):
            for name in names_of(each):
                takers.setdefault(name, []).append(kind.name if issubclass(kind, Scene) else "")
                texts.setdefault(name, each)
    for name, each in texts.items():
        some = "" in takers[name] or len(takers[name]) == len(NAMES)
        whose = "" if some else f"For {', '.join(takers[name])}: "
        text = fill(f"{whose}{described(each) if name == each.name else f'another name of {each.name}'}.", 110)
        entries[name] = f"{name} : {each.metadata['reader'].accepts}\n{indent(text, '    ')}"
    return entries


def _document(function: Callable[..., Any], kinds: list[type[Options]]) -> None:
    """Let help() and inspect.signature() name all options."""
    entries, signature = _entries(kinds), inspect.signature(function)
    *others, _ = signature.parameters.values()
    words = [inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, default=None) for word in entries]
    vars(function)["__signature__"] = signature.replace(parameters=[*others, *words])
    text = inspect.cleandoc(function.__doc__ or "")  # empty where docstrings are left out (python -OO)
    function.__doc__ = text.replace("\n\nReturns\n", "\n" + "\n".join(entries.values()) + "\n\nReturns\n", 1)


for _function in (run, plan):
    _document(_function, [Settings, *map(scene_class, NAMES)])
_document(trade, [TradeOptions])
