"""Chains that bend until their bones span a distance: of limbs and of spines."""

from types import ModuleType

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.solve import closing, spanning, spine_closing

FRAMES = 3 * spanning.FEW
LENGTHS = np.array([[0.0, 0.3, 0.2, 0.4], [0.2, 0.2, 0.2, 0.2]])


def _chains(seed: int) -> tuple[Array, Array]:
    """Return bowed chains and the lines along which they reach, unit vectors."""
    rng = np.random.default_rng(seed)
    axis = quat.unit(rng.normal(size=(FRAMES, 2, 3)))
    side = quat.unit(quat.cross(axis, rng.normal(size=(FRAMES, 2, 3))))[:, :, None]
    bow = np.cos(np.pi * np.linspace(0.1, 0.9, 4))[:, None] * rng.uniform(0.2, 1.0, (FRAMES, 2, 1, 1))
    return quat.unit(axis[:, :, None] + bow * side), axis


@pytest.mark.parametrize("kind", [closing, spine_closing])
def test_chains_are_as_long_as_asked_or_as_long_as_they_are(kind: ModuleType) -> None:
    shape, axis = _chains(1)
    full = LENGTHS.sum(axis=-1)
    distance = full * np.random.default_rng(2).uniform(0.7, 1.3, (FRAMES, 2))
    found = kind.close(shape, LENGTHS, axis, distance)
    ends = quat.length((LENGTHS[..., None] * found).sum(axis=2))
    np.testing.assert_allclose(quat.length(found), 1.0, atol=1e-12)
    np.testing.assert_allclose(ends, np.minimum(distance, full), atol=1e-8)


@pytest.mark.parametrize("kind", [closing, spine_closing])
def test_chains_bend_alike_alone_and_among_many(kind: ModuleType) -> None:
    """To the bit, however many steps the others take: some cannot get there at all."""
    shape, axis = _chains(3)
    distance = LENGTHS.sum(axis=-1) * np.random.default_rng(4).uniform(0.01, 1.1, (FRAMES, 2))
    together = kind.close(shape, LENGTHS, axis, distance)
    for i in range(0, FRAMES, 7):
        row = slice(i, i + 1)
        np.testing.assert_array_equal(kind.close(shape[row], LENGTHS, axis[row], distance[row]), together[row])
