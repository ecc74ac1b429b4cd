"""Rigs that come again: what they were found to be holds as long as nothing is changed that the analysis goes by."""

from dataclasses import replace

import bpy
import numpy as np
import pytest

from morph_retarget.blender import recognition, retarget, rig
from morph_retarget.blender.rig import Rig
from morph_retarget.core.character.analysis import Overrides
from tests.blender import scenes


@pytest.fixture
def own() -> Rig:
    return rig.read(scenes.sprout())


def test_a_rig_that_comes_again_as_it_was_is_the_character_that_it_was(own: Rig) -> None:
    was = retarget.character_of(own)
    scenes.empty()
    assert retarget.character_of(rig.read(scenes.sprout("Another"))) is was


@pytest.mark.parametrize("part", ["names", "parents", "rest_positions", "rest_tails", "deform", "inherits"])
def test_a_rig_that_has_changed_is_analysed_anew(own: Rig, part: str) -> None:
    changed = {
        "names": ("Other", *own.skeleton.names[1:]),
        "parents": np.maximum(own.skeleton.parents - np.eye(len(own.skeleton), dtype=np.intp)[-1], -1),
        "rest_positions": own.skeleton.rest_positions * 1.001,
        "rest_tails": own.skeleton.rest_tails * 1.001,
        "deform": ~own.skeleton.deform,
        "inherits": None,
    }
    other = replace(own, skeleton=replace(own.skeleton, **{part: changed[part]}))
    assert retarget.character_of(other) is not retarget.character_of(own)


def test_a_rig_that_was_moved_or_corrected_is_analysed_anew(own: Rig) -> None:
    was = retarget.character_of(own)
    own.object.location.x += 1.0
    bpy.context.view_layer.update()
    moved = retarget.character_of(rig.read(own.object))
    assert moved is not was
    assert moved.placement.translation[0] == pytest.approx(was.placement.translation[0] + 1.0)
    corrected = retarget.character_of(own, Overrides(joints={"head": own.skeleton.names[0]}))
    assert corrected.bone("head") == 0
    turned = retarget.character_of(own, Overrides(forward=np.array([1.0, 0.0, 0.0])))
    assert turned.frame.forward[0] > 0.99
    assert retarget.character_of(own) is was


def test_a_rig_is_judged_by_the_pose_that_is_given(own: Rig) -> None:
    heads = own.skeleton.rest_positions
    upright = recognition.recognized(own.skeleton, own.placement, Overrides(), heads)
    lying = recognition.recognized(own.skeleton, own.placement, Overrides(), heads[:, [0, 2, 1]])
    assert lying is not upright


def test_only_those_used_last_are_kept(own: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recognition, "MOST", 2)
    monkeypatch.setattr(recognition, "_known", {})
    rigs = [replace(own, placement=replace(own.placement, scale=1.0 + i)) for i in range(3)]
    was = [retarget.character_of(one) for one in rigs]
    assert len(recognition._known) == 2
    assert [retarget.character_of(rigs[i]) is was[i] for i in (2, 1, 0, 2, 1)] == [True, True, False, False, False]
