"""Laws of controls that copy the turns of others: what is left for them makes what was wanted of them in all."""

import numpy as np
import pytest

from morph_retarget.core import euler, quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.mocap import copying
from morph_retarget.core.mocap.copying import ALL, Copy

FRAMES = 40
CHAINS = {
    "a tail": {1: Copy(0), 2: Copy(1), 3: Copy(2)},
    "a tail from its tip": {0: Copy(1), 1: Copy(2), 2: Copy(3)},
    "about two axes": {1: Copy(0, (True, False, True)), 2: Copy(1, (True, False, True), "ZYX")},
    "all of one": {1: Copy(0), 2: Copy(0, (False, True, False))},
}


def _turns(seed: int) -> Array:
    return quat.from_rotation_vector(np.random.default_rng(seed).uniform(-0.6, 0.6, (FRAMES, 4, 3)))


def _whole(copies: dict[int, Copy], own: Array) -> Array:
    """Return the local turns that Blender makes of what channels hold: what is copied, and on top of it the own."""
    out = own.copy()
    for _ in range(own.shape[1]):  # each time one more level is right
        before = out.copy()
        for i, copy in copies.items():
            angles = euler.from_quaternions(before[:, copy.source], copy.order)
            copied = euler.to_quaternions(np.where(copy.axes, angles, 0.0), copy.order)
            out[:, i] = quat.multiply(copied, own[:, i])
    return out


@pytest.mark.parametrize("name", CHAINS)
def test_what_is_left_makes_what_was_wanted(name: str) -> None:
    """Seen from any channels: carried there with what was copied then, and wanted anywhere."""
    copies, before, wanted = CHAINS[name], _turns(1), _turns(2)
    carried = quat.multiply(_whole(copies, before), quat.conjugate(before))
    found = copying.parted(copies, before, quat.multiply(quat.conjugate(carried), wanted))
    assert quat.angle_between(_whole(copies, found), wanted).max() < 1e-9


def test_nothing_is_left_to_do_where_all_is_as_it_was_seen() -> None:
    before = _turns(3)
    for copies in CHAINS.values():
        assert quat.angle_between(copying.parted(copies, before, before), before).max() < 1e-9


def test_copies_that_go_round_in_a_circle_end() -> None:
    found = copying.parted({0: Copy(1), 1: Copy(0)}, _turns(4), _turns(5))
    assert np.isfinite(found).all()
    assert Copy(0).axes == ALL
