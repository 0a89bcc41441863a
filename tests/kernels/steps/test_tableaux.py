"""Tableaux that refuse a misprint."""

from dataclasses import replace
from fractions import Fraction

import pytest

from kernels.steps.tableaux import CLASSICAL_RK4, DORMAND_PRINCE_54, DORMAND_PRINCE_853, trees


def test_there_are_as_many_rooted_trees_as_the_books_say():
    assert [len(trees(n)) for n in range(1, 7)] == [1, 1, 2, 4, 9, 20]


@pytest.mark.parametrize("tableau", [CLASSICAL_RK4, DORMAND_PRINCE_54], ids=lambda t: t.name)
def test_a_tableau_does_not_claim_more_order_than_it_has(tableau):
    with pytest.raises(ValueError, match="order condition"):
        replace(tableau, order=tableau.order + 1)


def test_the_embedded_solution_of_dormand_prince_is_of_order_four_only():
    ((_order, weights),) = DORMAND_PRINCE_54.errors
    with pytest.raises(ValueError, match="order condition"):
        replace(DORMAND_PRINCE_54, errors=((5, weights),))


def test_a_misprinted_weight_is_refused():
    b = list(CLASSICAL_RK4.b)
    b[0] += Fraction(1, 10**9)
    with pytest.raises(ValueError, match="order condition"):
        replace(CLASSICAL_RK4, b=tuple(b))


@pytest.mark.parametrize("row", [2, 6, 11])
def test_a_misprint_in_the_eighth_order_method_is_refused(row):
    a = [list(entries) for entries in DORMAND_PRINCE_853.a]
    a[row][0] += 1e-11
    with pytest.raises(ValueError, match="order condition"):
        replace(DORMAND_PRINCE_853, a=tuple(map(tuple, a)))
    fifth, third = (weights for _order, weights in DORMAND_PRINCE_853.errors)
    for place, weights in enumerate((DORMAND_PRINCE_853.b, fifth, third)):
        found = [DORMAND_PRINCE_853.b, fifth, third]
        found[place] = (*weights[:row], weights[row] + 1e-11, *weights[row + 1 :])
        with pytest.raises(ValueError, match="order condition"):
            replace(DORMAND_PRINCE_853, b=found[0], errors=((5, found[1]), (3, found[2])))
