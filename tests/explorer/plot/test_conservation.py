"""The picture of what is kept over many passages."""

from conftest import BODIES

from explorer import plot
from explorer.portrait.conservation import conservation


def test_every_accuracy_and_the_solver_have_a_name_and_a_mark_of_their_own():
    found = conservation(BODIES["hoop"], most=10, most_by_solver=2, accuracies=(1e-4, 1e-6))
    figure = plot.conservation(found)
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert names == ["accuracy $10^{-4}$", "accuracy $10^{-6}$", "SciPy DOP853, rtol $10^{-8}$"]
    assert len({line.get_marker() for line in figure.axes[0].lines}) == 3
