"""Cases of the command line: every command, with words that make no sense among those that do."""

import contextlib
import random
import shlex

from .judge import judge_command
from .values import TEXTS

# Command lines that end soon; {} is a folder that may be written.
SENSIBLE = (
    "passage --sigma3-bar 1 --eta-hat 1e-3 --phidot 1 --json",
    "passage --disk hoop --sigma3-bar 1 --eta-hat -1e-9 --phidot 0.5 --face -1 --method dopri5 --accuracy 1e-3",
    "passage --disk I1=0.25,I3=0.5,r=2 --sigma3-bar 0.2 --eta-hat 0 --phidot 1 --window 0.5",
    "plan race-angles --accuracy 1e-9 --json",
    "plan one-sided --method auto",
    "run race-angles --disk uniform --samples 40 --eta-hat 1e-4:1e-2 --seed 3 --jobs 1 --out {} --json --quiet",
    "run falling-set --samples 40 --box phi=0,phidot=-1:1 --energy :3 --grid 5 --out {} --json --quiet",
    "run measure-zero --samples 100 --tube 16 --gaussian phidot=0.5:0.3 --out {} --json --quiet",
    "run portrait --sigma3-bar 0.2 --eta-hat 1e-3 --energy 1:2 --out {} --json --quiet",
    "status {}",
    "verify {}",
    "resume {} --jobs 1",
    "summary {} --json",
    "columns race-angles",
    "view --disk hoop --eta-hat 1e-3 --out {}/page.html",
    "gallery {}",
    "portrait --only x --out {}",
    "paper --only x",
    "trade --samples x",
    "demo --jobs x",
)
NUMBERS = "-1e-3 1e308 5e-324 nan -inf 1e400 0 -0 1j True 0x10 1e6: 2:1 -1:2"
OTHERS = "I1=1e308 r=1e308 I1=0.25,I3=0.5,r=5e-324 uniform:m=x \0.toml /dev/zero /dev/tty/x .. -- - --help --no"
NASTY = (*TEXTS, *NUMBERS.split(), *OTHERS.split(" "), "9" * 400, "é" * 300)


def case(rng, folder):
    """The words of one command line."""
    words = [word.replace("{}", str(folder)) for word in shlex.split(rng.choice(SENSIBLE))]
    for _ in range(rng.choices((0, 1, 2), (0.1, 0.7, 0.2))[0]):
        place, what = rng.randrange(len(words)), rng.random()
        # The folder stays where it is: what is tried may write.
        if what < 0.75 and (str(folder) not in words[place] or rng.random() < 0.2) and place > 0:
            words[place] = rng.choice(NASTY)
        elif what < 0.85 and place > 0:
            words.pop(place)
        else:
            words.insert(place, rng.choice(NASTY))
    # Some commands take minutes when nothing is wrong with their words.
    if words and words[0] in ("demo", "trade", "paper", "portrait", "warmup", "gallery") and "--help" not in words:
        words.append("--nonsense" if words[0] != "gallery" else str(folder))
    if "run" in words and "--samples" not in words:
        words += ["--samples", "40"]
    return [word for word in words if word not in ("--open",)]


def run(cases, seed, place):
    """(words, verdict) of so many command lines; `place` is a folder that may be filled."""
    rng = random.Random(seed)
    for number in range(cases):
        words = case(rng, place / f"{number}")
        with contextlib.chdir(place):  # a word that stands for a folder may be a relative one
            verdict = judge_command(words)
        yield shlex.join(words), words, verdict
