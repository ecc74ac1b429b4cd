"""Annotations on actions: kept, read as the core takes them, and written by what finds them."""

from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.directing import annotations
from morph_retarget.blender.directing.annotations import MORPHRETARGET_PG_annotations
from morph_retarget.blender.morph import definitions
from morph_retarget.core.clips.motions.annotations import Annotations, Phase, Strike, Strokes
from morph_retarget.core.errors import MotionError
from tests.blender import scenes

FEET = ["Foot.L", "Foot.R"]
FOUR = ["A", "B", "C", "D"]
FULL = Annotations(
    kind="walk",
    style="happy",
    cycle=True,
    strikes=(Strike(1, 2.0), Strike(0, 10.0)),
    speed=1.2,
    turn_rate=0.3,
    direction=-0.1,
    phase=Phase.LOOP,
    strokes=Strokes(1.0, 2.0, 3.5, 4.0, 6.0),
    side="left",
    parts=("left arm", "head"),
    parameters={"height": 0.4, "speed": 1.2},
)

pytestmark = pytest.mark.usefixtures("registered")


def _action() -> bpy.types.Action:
    return bpy.data.actions.new("Walk")


def _markers(action: bpy.types.Action) -> list[tuple[str, int]]:
    return sorted((marker.name, marker.frame) for marker in action.pose_markers)


def test_what_is_written_is_read_again() -> None:
    action = _action()
    annotations.write(action, FULL, FEET, 5.0, 1.0)
    assert annotations.read(action, FEET, 5.0, 1.0) == FULL
    assert _markers(action) == [("strike left", 15), ("strike right", 7)]
    assert annotations.of_action(action).is_annotated
    plain = Annotations(kind="idle")
    annotations.write(action, plain, FEET, 5.0, 1.0)
    assert annotations.read(action, FEET, 5.0, 1.0) == plain
    assert not _markers(action)


def test_times_are_frames_of_the_action_whatever_its_rate() -> None:
    action = _action()
    annotations.write(action, FULL, FEET, 100.0, 0.5)
    assert _markers(action) == [("strike left", 120), ("strike right", 104)]
    assert annotations.of_action(action).stroke == 107.0
    assert annotations.read(action, FEET, 100.0, 0.5) == FULL


@pytest.mark.parametrize(
    ("feet", "name", "foot"),
    [(FEET, "strike left", 0), (FEET, "Strike RIGHT", 1), (FEET, "strike Foot.R", 1), (FOUR, "strike C", 2)],
)
def test_a_marker_names_a_foot_by_its_side_or_its_bone(feet: list[str], name: str, foot: int) -> None:
    action = _action()
    annotations.of_action(action).kind = "walk"
    action.pose_markers.new(name).frame = 8
    action.pose_markers.new("footstep").frame = 9
    assert annotations.strikes_of(action, feet) == [(foot, 8.0)]


@pytest.mark.parametrize(
    ("feet", "name", "said"),
    [(FOUR, "strike left", "strike A, strike B, strike C, strike D"), (FEET, "strike", "strike left, strike right"),
     ([], "strike left", "there are no feet")],
)  # fmt: skip
def test_a_marker_that_names_no_foot_is_told(feet: list[str], name: str, said: str) -> None:
    action = _action()
    annotations.of_action(action).kind = "walk"
    action.pose_markers.new(name).frame = 8
    with pytest.raises(MotionError, match=rf"action 'Walk': marker '{name}' names no foot: .*{said}"):
        annotations.read(action, feet, 1.0, 1.0)


def test_what_makes_no_sense_is_told_with_the_action() -> None:
    action = _action()
    own = annotations.of_action(action)
    own.kind, own.is_gesture, own.ready = "wave", True, 50.0
    with pytest.raises(MotionError, match="action 'Walk': annotation 'strokes' is not in order"):
        annotations.read(action, FEET, 1.0, 1.0)


def test_clearing_leaves_other_markers_and_the_action_alone() -> None:
    action = _action()
    annotations.write(action, FULL, FEET, 1.0, 1.0)
    action.pose_markers.new("footstep").frame = 3
    annotations.of_action(action).clear()
    annotations.clear_strikes(action)
    assert _markers(action) == [("footstep", 3)]
    own = annotations.of_action(action)
    fresh = annotations.of_action(bpy.data.actions.new("Fresh"))
    for prop in MORPHRETARGET_PG_annotations.bl_rna.properties:
        if prop.type not in {"POINTER", "COLLECTION"}:
            assert getattr(own, prop.identifier) == getattr(fresh, prop.identifier)
    assert not own.is_annotated


def test_an_annotated_action_is_still_an_ordinary_one() -> None:
    action = _action()
    annotations.write(action, FULL, FEET, 1.0, 1.0)
    assert not definitions.is_generalized(action)


def test_annotations_are_saved_and_loaded(tmp_path: Path) -> None:
    action = _action()
    action.use_fake_user = True
    annotations.write(action, FULL, FEET, 1.0, 1.0)
    path = tmp_path / "walk.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    scenes.empty()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    assert annotations.read(bpy.data.actions["Walk"], FEET, 1.0, 1.0) == FULL


def test_annotations_cannot_be_keyed() -> None:
    for group in annotations.CLASSES:
        for name, prop in group.bl_rna.properties.items():
            if name not in {"rna_type", "name"}:
                assert not prop.is_animatable or prop.type == "COLLECTION"
