"""A command line ends with a status and a sentence, whatever words it has."""

import contextlib
import io
import shlex

from hypothesis import given
from hypothesis import strategies as st

from explorer.commands.main import main
from properties.strategies import examples

SENSIBLE = (
    "passage --sigma3-bar 1 --eta-hat 1e-3 --phidot 1 --json",
    "passage --disk hoop --sigma3-bar 1 --eta-hat -1e-9 --phidot 0.5 --face -1 --method dopri5 --accuracy 1e-3",
    "passage --disk I1=0.25,I3=0.5,r=2 --sigma3-bar 0.2 --eta-hat 0 --phidot 1 --window 0.5",
    "plan race-angles --accuracy 1e-9 --json",
    "plan one-sided --method auto",
    "run race-angles --samples 40 --disk uniform --eta-hat 1e-4:1e-2 --seed 3 --out races --replace --json",
    "run falling-set --samples 40 --box phi=0,phidot=-1:1 --energy :3 --grid 5 --out falls --replace --json",
    "run measure-zero --samples 100 --tube 16 --box phidot=norm:0.5:0.3 --out law --replace --json",
    "status races",
    "verify races",
    "resume races --jobs 1",
    "summary races --json",
    "columns race-angles",
    "view --disk hoop --eta-hat 1e-3 --out page.html",
    "cite",
)
NUMBERS = "0.5 3 -1e-3 1e308 5e-324 nan -inf 1e400 0 -0 1j True 0x10 1e6: : 2:1 -1:2 1,5 x.toml"
OTHERS = "hoop race-angles I1=1e308 r=1e308 I1=0.25,I3=0.5,r=5e-324 x/y/z .. - -- --no --help --out portrait"
words = st.sampled_from([*NUMBERS.split(), *OTHERS.split(), "", " ", "²", "é" * 300, "x" * 5000, "1" * 5000])


@st.composite
def command_lines(draw):
    """A sensible command line of which a word or two were replaced, left out or put in."""
    line = shlex.split(draw(st.sampled_from(SENSIBLE)))
    for _ in range(draw(st.sampled_from([0, 1, 1, 2]))):
        place = draw(st.integers(0, max(0, len(line) - 1)))
        if line[place : place + 1] in ([], ["run"], ["--samples"]):  # so that what runs is small
            continue
        how = draw(st.sampled_from(["replace", "replace", "leave out", "put in"]))
        line[place : place + (how != "put in")] = [] if how == "leave out" else [draw(words)]
    return [*line, "--quiet", *(["--no-figures"] if line[:1] == ["run"] else [])]


def test_a_command_line_ends_with_a_status_and_a_sentence(tmp_path_factory, counts):
    @examples(0.15)
    @given(command_lines())
    def claim(line):
        out, err = io.StringIO(), io.StringIO()
        with contextlib.chdir(place), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                status = main(line)
            except SystemExit as end:
                status = end.code or 0
        said = err.getvalue()
        assert status in (0, 1, 2)
        assert len(said.splitlines()) <= 2
        assert (said + out.getvalue()).strip() or status == 0
        counts["command line"][f"status {status}"] += 1

    place = tmp_path_factory.mktemp("lines")
    claim()
