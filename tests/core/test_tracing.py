"""Looking into motion trees: branches that are asked at a frame, and their own frames."""

import numpy as np
import pytest

from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import Clip, ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.operators.blend import Blend
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.mix import Mix
from morph_retarget.core.clips.operators.overlay import Overlay
from morph_retarget.core.clips.operators.time_shift import TimeShift
from morph_retarget.core.clips.tracing import trace
from morph_retarget.core.clips.travel import Travel
from tests.legged import crawler
from tests.skeletons import skeleton_of

MODEL = CharacterModel(analyze(skeleton_of(crawler(2))), 0)


def _clip(name: str, count: int = 10) -> ClipPrimitive:
    joints, feet = len(MODEL), len(MODEL.feet)
    turns = np.zeros((count, joints, 4))
    turns[..., 0] = 1.0
    moving = np.zeros((count, len(MODEL.moving), 3))
    data = Frames(turns, moving, np.zeros((count, feet, 3)), np.zeros((count, feet)))
    return ClipPrimitive(name, MODEL, data, Travel.still(count))


def _seen(tree: Clip, frame: float) -> list[tuple[int, str, float | None]]:
    return [(branch.depth, branch.clip.label, branch.frame) for branch in trace(tree, frame)]


def test_a_blend_asks_the_parts_that_count() -> None:
    tree = Blend(0.0, 5.0, 5.0, 9.0, _clip("a"), TimeShift(100.0, _clip("b")))
    assert _seen(tree, 2.0) == [(0, "Blend", 2.0), (1, "a", 2.0), (1, "TimeShift", None)]
    assert _seen(tree, 7.0) == [(0, "Blend", 7.0), (1, "a", 7.0), (1, "TimeShift", 102.0), (2, "b", 2.0)]
    assert _seen(tree, 12.0) == [(0, "Blend", 12.0), (1, "a", None), (1, "TimeShift", 107.0), (2, "b", 7.0)]


def test_frames_are_those_of_each_clip_itself() -> None:
    tree = Overlay(Loop(0, _clip("walk")), TimeShift(20.0, _clip("wave")), MODEL.part("upper"), 2.0, 2.0)
    assert _seen(tree, 24.0)[-1] == (2, "wave", 4.0)
    walk = _seen(tree, 24.0)[2]
    assert walk[:2] == (2, "walk")
    assert walk[2] == 4.0


def test_a_clip_that_is_in_a_tree_twice_and_lists_of_clips_are_seen() -> None:
    clip = _clip("a")
    assert [label for _, label, _ in _seen(Mix([clip, clip], [1.0, 2.0]), 3.0)].count("a") == 2


def test_the_tree_is_left_as_it_is() -> None:
    tree = Blend(0.0, 5.0, 5.0, 9.0, _clip("a"), _clip("b"))
    before = set(vars(tree))
    seen = _seen(tree, 7.0)
    assert "frame" not in set(vars(tree)) - before
    assert _seen(tree, 7.0) == seen, "what was noted before is forgotten"


def test_the_tree_is_left_as_it_is_by_what_fails_too() -> None:
    clip = _clip("a")
    tree = TimeShift(3.0, clip)
    object.__setattr__(clip, "data", None)
    with pytest.raises(AttributeError):
        trace(tree, 7.0)
    assert "frame" not in vars(tree)
    assert "frame" not in vars(clip)
