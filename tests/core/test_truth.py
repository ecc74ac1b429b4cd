"""The analysis against hand-checked truth about real rigs."""

from pathlib import Path

import pytest

from tests import truth
from tests.truth import CLUTTER, Score, Tally


def _humanoids(data: Path) -> list[truth.Rig]:
    return [truth.rig(data, t) for t in truth.tables(data) if t["kind"] == "humanoid"]


def _total(rigs: list[truth.Rig]) -> Score:
    total = Score()
    for own in rigs:
        total.add(truth.score_joints(own, truth.find(own)))
    return total


def test_nearly_all_joints_of_real_humanoids_are_right(data: Path) -> None:
    total = _total(_humanoids(data))
    assert total.right >= 0.99 * total.known, total.faults
    assert not total.swapped
    assert len(total.claimed) <= 0.01 * total.known, total.claimed


@pytest.mark.parametrize("kind", CLUTTER)
def test_bones_that_are_no_part_of_a_body_do_not_mislead(data: Path, kind: str) -> None:
    offset = list(CLUTTER).index(kind) % 2  # each rig has half of the kinds
    total = _total([truth.cluttered(own, kind) for own in _humanoids(data)[offset::2]])
    assert total.right >= 0.99 * total.known, total.faults
    assert not total.swapped


def test_rests_that_are_bent_mislead_only_where_names_are_of_no_known_family(data: Path) -> None:
    total = _total([truth.bent(own, 0.35, seed=5) for own in _humanoids(data)])
    assert total.right >= 0.95 * total.known, total.faults


def test_most_joints_are_found_without_any_names(data: Path) -> None:
    total = _total([truth.nameless(own) for own in _humanoids(data)])
    assert total.right >= 0.9 * total.known, total.faults


def test_capabilities_of_real_creatures(data: Path) -> None:
    tallies: dict[str, Tally] = {}
    for table in truth.tables(data):
        if table["kind"] == "creature":
            own = truth.rig(data, table)
            truth.score_capabilities(own, truth.find(own), tallies)
    assert {c: t.f1 for c, t in tallies.items() if t.f1 < 0.95} == {}
