"""Irreducible and smallest sets against the enumeration of all subsets."""

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from hysdel_py.analysis.subsets import irreducible, smallest, smallest_hitting_set

ELEMENTS = range(7)
SETS = st.lists(st.frozensets(st.sampled_from(ELEMENTS), min_size=1, max_size=5), min_size=1, max_size=6)


def oracle(cores):
    """A monotone property: what contains one of the cores contradicts itself."""
    return lambda elements: any(core <= elements for core in cores)


def correction_of(contradicts):
    def correction(consistent):
        inside = set(consistent)
        for element in ELEMENTS:
            if not contradicts(frozenset(inside | {element})):
                inside.add(element)
        return frozenset(ELEMENTS) - inside

    return correction


@given(SETS)
def test_no_element_can_be_left_out(cores):
    contradicts = oracle(cores)
    found = frozenset(irreducible(contradicts, frozenset(), tuple(ELEMENTS)))
    assert contradicts(found)
    assert not any(contradicts(found - {element}) for element in found)


@given(SETS, st.frozensets(st.sampled_from(ELEMENTS), max_size=3))
def test_background_comes_on_top(cores, background):
    contradicts = oracle(cores)
    rest = tuple(e for e in ELEMENTS if e not in background)
    found = frozenset(irreducible(contradicts, background, rest))
    assert contradicts(found | background)
    assert not any(contradicts((found - {element}) | background) for element in found)


@given(SETS)
def test_smallest_is_that_of_all_subsets(cores):
    contradicts = oracle(cores)
    known = frozenset(irreducible(contradicts, frozenset(), tuple(ELEMENTS)))
    found, proven = smallest(contradicts, correction_of(contradicts), known)
    assert proven
    assert contradicts(found)
    assert len(found) == min(map(len, cores))


def test_giving_up_keeps_what_is_known():
    contradicts = oracle([frozenset({0, 1, 2}), frozenset({3})])
    known = frozenset({0, 1, 2})
    assert smallest(contradicts, correction_of(contradicts), known, lambda: True) == (known, False)
    assert smallest(contradicts, correction_of(contradicts), known) == (frozenset({3}), True)


@given(SETS)
def test_smallest_hitting_set(sets):
    found = smallest_hitting_set(sets)
    assert all(found & one for one in sets)
    smaller = combinations(ELEMENTS, len(found) - 1)
    assert not any(all(set(candidate) & one for one in sets) for candidate in smaller)


def test_preferred_elements_decide_among_equals():
    sets = [frozenset({0, 5}), frozenset({1, 6})]
    assert smallest_hitting_set(sets, preferred=frozenset({5, 6})) == {5, 6}
    assert smallest_hitting_set(sets, preferred=frozenset({0, 6})) == {0, 6}
