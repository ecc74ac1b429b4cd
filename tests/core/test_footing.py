"""Hips that sway over feet that stand: they come down for legs that would not reach, and for nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from morph_retarget.core import play, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.footing import Footing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.hierarchy import Hierarchy
from morph_retarget.core.solve.settings import DEFAULT
from tests.stances import stand
from tools.figure import Build, humanoid, vrm

SWAY = 0.06
"""How far hips sway in a wave [m]."""


class _Body:
    """A figure whose hips and feet have goals: places and turns."""

    def __init__(self, stance: str) -> None:
        self.character = analyze(stand(humanoid(build=Build(arms_down=40.0)), stance, vrm))
        self.rest = Bodies.of(self.character).positions
        self.root = play.root_of(Bodies.of(self.character))
        self.feet = [leg.end for leg in self.character.legs]
        self.wanted = [(body, True, True) for body in (self.root, *self.feet)]
        footing = Footing.of(Hierarchy(self.character, self.rest, self.root), self.wanted, DEFAULT)
        assert footing is not None
        self.footing = footing

    def goals(self, ways: Array, feet: float = 1.0) -> Goals:
        """Return goals that move the hips by ways [m], shape (frame, 3), with feet that count so much."""
        bodies = [body for body, _, _ in self.wanted]
        places = np.tile(self.rest[bodies], (len(ways), 1, 1))
        places[:, 0] += ways
        counts = np.ones(places.shape[:2])
        counts[:, 1:] = feet
        return Goals(np.array(bodies), places, quat.identity(*places.shape[:2]), counts, np.ones_like(counts))

    def slides(self, goals: Goals) -> Array:
        """Return how far the feet end up off their places [m], shape (frame,)."""
        plan = posing.prepare(self.character, self.rest, self.root, self.wanted)
        places = posing.solve(plan, goals).positions[:, self.feet]
        return np.linalg.norm(places - self.rest[self.feet], axis=-1).max(axis=1)


def _aside(count: int = 61) -> Array:
    """Return hips that sway from one side to the other, shape (frame, 3)."""
    return np.linspace(-SWAY, SWAY, count)[:, None] * np.array([1.0, 0.0, 0.0])


def test_feet_of_a_wide_stance_stay_where_they_stand() -> None:
    body = _Body("wide")
    goals = body.goals(_aside())
    assert body.slides(goals).max() > 0.02
    assert body.slides(body.footing.kept(goals)).max() < 0.008


def test_hips_come_down_evenly_and_the_same_on_both_sides() -> None:
    body = _Body("wide")
    ways = _aside()
    down = (body.goals(ways).positions - body.footing.kept(body.goals(ways)).positions)[:, 0]
    assert np.allclose(down, down[::-1], atol=1e-6)
    assert np.abs(down[:, :2]).max() == 0.0
    assert np.abs(np.diff(down[:, 2], 2)).max() < 1e-3, "no knee in their way"
    assert 0.02 < down[-1, 2] < SWAY


@pytest.mark.parametrize("stance", ["wide", "turned out", "fighting"])
def test_hips_that_rest_or_rise_are_left_alone(stance: str) -> None:
    body = _Body(stance)
    up = np.linspace(0.0, 0.4, 9)[:, None] * np.array([0.0, 0.0, 1.0])
    for ways in (np.zeros((3, 3)), up, -0.2 * up):
        goals = body.goals(ways)
        assert np.allclose(body.footing.kept(goals).positions, goals.positions, atol=1e-9)


def test_hips_come_down_as_far_as_is_asked_for() -> None:
    body = _Body("wide")
    hierarchy, goals = Hierarchy(body.character, body.rest, body.root), body.goals(_aside())
    whole = body.footing.kept(goals).positions - goals.positions
    half = Footing.of(hierarchy, body.wanted, replace(DEFAULT, footing=0.5))
    assert half is not None
    assert np.allclose(half.kept(goals).positions - goals.positions, 0.5 * whole)
    assert Footing.of(hierarchy, body.wanted, replace(DEFAULT, footing=0.0)) is None


def test_feet_that_are_lifted_or_count_for_nothing_hold_no_hips() -> None:
    body = _Body("wide")
    goals = body.goals(_aside(), feet=0.0)
    assert body.footing.kept(goals) is goals
    lifted = body.goals(_aside())
    lifted.positions[:, 1:, 2] += 0.2
    assert body.footing.kept(lifted) is lifted


def test_there_is_no_footing_without_places_of_hips_and_feet() -> None:
    body = _Body("wide")
    hierarchy = Hierarchy(body.character, body.rest, body.root)
    assert Footing.of(hierarchy, body.wanted[:1], DEFAULT) is None
    assert Footing.of(hierarchy, body.wanted[1:], DEFAULT) is None
