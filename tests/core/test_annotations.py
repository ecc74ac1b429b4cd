"""Annotations, base motions and libraries: what they refuse, and that files give back what was put into them."""

import dataclasses
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.clip import ClipPrimitive
from morph_retarget.core.clips.frames import Frames
from morph_retarget.core.clips.motions import annotation_data, library_file
from morph_retarget.core.clips.motions.annotations import Annotations, Phase, Strike, Strokes
from morph_retarget.core.clips.motions.base_motion import BaseMotion
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.errors import FileError, MotionError
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tests.legged import crawler
from tests.skeletons import skeleton_of
from tools.figure import humanoid

RNG = np.random.default_rng(11)
FULL = Annotations(
    kind="walk",
    style="happy",
    cycle=True,
    strikes=(Strike(1, 7.25), Strike(0, 0.5)),
    speed=1.4,
    turn_rate=0.2,
    direction=-0.5,
    phase=Phase.LOOP,
    strokes=Strokes(0.0, 1.0, 2.0, 2.0, 5.5),
    side="left",
    parts=("left leg", "trunk"),
    parameters={"speed": 1.4, "turn": 0.2, "height": 0.1},
)


def _model(bones: list[Any] | None = None) -> CharacterModel:
    character = analyze(skeleton_of(bones or humanoid(), np.random.default_rng(2)))
    return CharacterModel(character, root_of(Bodies.of(character)))


def _clip(model: CharacterModel, count: int = 12) -> ClipPrimitive:
    data = Frames(
        quat.normalize(RNG.normal(size=(count, len(model), 4))),
        RNG.normal(size=(count, len(model.moving), 3)),
        RNG.normal(size=(count, len(model.feet), 3)),
        RNG.uniform(size=(count, len(model.feet))),
    )
    return ClipPrimitive("made up", model, data, Travel(RNG.normal(size=(count, 2)), RNG.normal(size=count)))


def _library() -> Library:
    model = _model()
    loop = BaseMotion("Walk", _clip(model), FULL)
    active = model.part("arms")
    wave = dataclasses.replace(_clip(model, 5), joints=active)
    return Library(model, (loop, BaseMotion("Wave", wave, Annotations("wave", side="right"))))


# --- annotations ---


def test_annotations_are_the_same_after_a_way_through_json() -> None:
    for own in (FULL, Annotations("idle")):
        assert annotation_data.from_data(json.loads(json.dumps(annotation_data.to_data(own))), "file") == own


def test_annotations_that_hold_nothing_are_not_written() -> None:
    assert annotation_data.to_data(Annotations("idle")) == {"kind": "idle"}


def test_strikes_are_in_order_of_time() -> None:
    assert [strike.frame for strike in FULL.strikes] == [0.5, 7.25]
    assert FULL.strikes_of(1) == (7.25,)


def test_annotations_seen_twice_in_a_mirror_are_what_they_were() -> None:
    once = FULL.mirrored((1, 0))
    assert once.strikes_of(0) == (7.25,)
    assert (once.side, once.parts) == ("right", ("right leg", "trunk"))
    assert (once.turn_rate, once.direction, once.parameters["turn"]) == (-0.2, 0.5, -0.2)
    assert once.mirrored((1, 0)) == FULL


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"kind": " "}, "kind"),
        ({"phase": "middle"}, "phase"),
        ({"side": "top"}, "side"),
        ({"speed": -1.0}, "speed"),
        ({"turn_rate": float("nan")}, "turn_rate"),
        ({"parameters": {"height": float("inf")}}, "height"),
        ({"strikes": (Strike(-1, 3.0),)}, "strikes"),
        ({"strikes": (Strike(0, float("nan")),)}, "strikes"),
    ],
)
def test_annotations_that_make_no_sense_are_named(wrong: dict[str, Any], named: str) -> None:
    values: dict[str, Any] = {"kind": "walk"}
    with pytest.raises(MotionError, match=named):
        Annotations(**values | wrong)


def test_strokes_that_are_out_of_order_are_refused() -> None:
    with pytest.raises(MotionError, match="order"):
        Strokes(0.0, 3.0, 2.0, 4.0, 5.0)
    with pytest.raises(MotionError, match="number"):
        Strokes(0.0, float("nan"), 2.0, 4.0, 5.0)


@pytest.mark.parametrize(
    ("data", "named"),
    [
        ([], "annotations"),
        ({}, "kind"),
        ({"kind": 3}, "kind"),
        ({"kind": "walk", "pace": 1}, "pace"),
        ({"kind": "walk", "cycle": 1}, "cycle"),
        ({"kind": "walk", "speed": "fast"}, "speed"),
        ({"kind": "walk", "speed": True}, "speed"),
        ({"kind": "walk", "strikes": [[0]]}, "strikes"),
        ({"kind": "walk", "strikes": [[0.5, 1]]}, "strikes"),
        ({"kind": "walk", "strokes": {"ready": 1}}, "strokes"),
        ({"kind": "walk", "parts": "arms"}, "parts"),
        ({"kind": "walk", "parameters": {"speed": None}}, "speed"),
    ],
)
def test_data_that_are_no_annotations_are_refused_with_their_origin(data: object, named: str) -> None:
    with pytest.raises(MotionError, match=named) as error:
        annotation_data.from_data(data, "dance.toml")
    assert str(error.value).startswith("dance.toml")


# --- base motions and libraries ---


def test_a_base_motion_starts_and_ends_with_its_clips_first_and_last_frame() -> None:
    motion = _library().named("Walk")
    assert (motion.start_pose.rotations == motion.clip.frame(np.array([0.0])).rotations).all()
    last = motion.clip.frame(np.array([motion.clip.end]))
    assert quat.angle_between(motion.end_pose.rotations, last.rotations).max() < 1e-6


@pytest.mark.parametrize(
    ("own", "named"),
    [
        (Annotations("walk", strikes=(Strike(2, 1.0),)), "foot 2"),
        (Annotations("walk", strikes=(Strike(0, 11.5),)), "frame 11.5"),
        (Annotations("walk", parts=("left wing",)), "left wing"),
    ],
)
def test_annotations_that_do_not_fit_the_clip_are_named(own: Annotations, named: str) -> None:
    with pytest.raises(MotionError, match=named):
        BaseMotion("Walk", _clip(_model()), own)


def test_a_strike_between_the_last_and_the_first_frame_of_a_cycle_is_its_own() -> None:
    own = Annotations("walk", cycle=True, strikes=(Strike(0, 11.5),))
    assert BaseMotion("Walk", _clip(_model()), own).annotations.strikes == (Strike(0, 11.5),)


def test_a_base_motion_that_does_not_start_at_0_is_refused() -> None:
    late = dataclasses.replace(_clip(_model()), first=3.0)
    with pytest.raises(MotionError, match="start at 0"):
        BaseMotion("Walk", late, Annotations("walk"))


def test_a_library_finds_motions_by_kind_and_by_name() -> None:
    own = _library()
    assert own.kinds == ("walk", "wave")
    assert [motion.name for motion in own.of_kind("wave")] == ["Wave"]
    assert own.of_kind("swim") == ()
    with pytest.raises(MotionError, match="Walk, Wave"):
        own.named("Swim")


def test_a_library_refuses_motions_of_another_body_and_two_of_one_name() -> None:
    own = _library()
    with pytest.raises(MotionError, match="another body"):
        own.with_motions([BaseMotion("Run", _clip(_model()), Annotations("run"))])
    with pytest.raises(MotionError, match="two base motions"):
        Library(own.model, (own.motions[0], own.motions[0]))


def test_a_motion_of_a_name_that_is_there_replaces_it() -> None:
    own = _library()
    new = BaseMotion("Walk", _clip(own.model), Annotations("run"))
    assert own.with_motions([new]).named("Walk") is new
    assert len(own.with_motions([new])) == len(own)


# --- files ---


@pytest.mark.parametrize("bones", [humanoid(), crawler(6)], ids=["humanoid", "six legs"])
def test_a_library_is_the_same_after_a_way_through_a_file(bones: list[Any], tmp_path: Path) -> None:
    model = _model(bones)
    motion = BaseMotion("Walk", _clip(model), Annotations("walk", strikes=(Strike(1, 2.5),)))
    own = Library(model, (motion,))
    library_file.save(own, tmp_path / "own.npz")
    back = library_file.load(tmp_path / "own.npz")
    ours, theirs = own.model.character, back.model.character
    for field in dataclasses.fields(ours):
        if field.name not in {"skeleton", "placement", "frame"}:
            assert getattr(theirs, field.name) == getattr(ours, field.name)
    for name in ("rest_positions", "rest_rotations", "rest_tails", "parents"):
        assert (getattr(theirs.skeleton, name) == getattr(ours.skeleton, name)).all()
    assert (theirs.frame.origin == ours.frame.origin).all()
    assert (back.model.feet == own.model.feet).all()
    assert back.named("Walk").annotations == motion.annotations
    for name in ("rotations", "translations", "feet", "contacts"):
        there, here = getattr(back.motions[0].clip.data, name), getattr(motion.clip.data, name)
        assert np.abs(there - here).max() < 1e-6
    assert np.abs(back.motions[0].clip.way.places - motion.clip.way.places).max() < 1e-6
    assert [path.name for path in tmp_path.iterdir()] == ["own.npz"]


def test_joints_that_have_no_data_have_none_after_a_way_through_a_file() -> None:
    own = _library()
    back = library_file.decoded(library_file.encoded(own), "file")
    assert (back.named("Wave").clip.active == own.named("Wave").clip.active).all()


def _spoiled(change: dict[str, Any]) -> bytes:
    """Return a library's file with some arrays changed, or taken out where None."""
    with np.load(io.BytesIO(library_file.encoded(_library()))) as archive:
        arrays = {name: archive[name] for name in archive.files} | change
    out = io.BytesIO()
    np.savez(out, **{name: values for name, values in arrays.items() if values is not None})
    return out.getvalue()


def _header(**change: Any) -> bytes:
    with np.load(io.BytesIO(library_file.encoded(_library()))) as archive:
        header = json.loads(archive["header"].tobytes()) | change
    return _spoiled({"header": np.frombuffer(json.dumps(header).encode(), dtype=np.uint8)})


def _npy() -> bytes:
    out = io.BytesIO()
    np.save(out, np.zeros(3))
    return out.getvalue()


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"no archive",
        _npy(),
        library_file.encoded(_library())[:-4000],
        _spoiled({"header": None}),
        _spoiled({"header": np.zeros(4)}),
        _header(**{"is": "something else"}),
        _header(format=99),
        _header(body={}),
        _header(motions=3),
        _header(motions=[{"name": "Walk", "clip": "x", "annotations": {"kind": ""}}]),
        _spoiled({"0.rotations": None}),
        _spoiled({"0.rotations": np.zeros((12, 3, 4))}),
        _spoiled({"0.travel": np.full((12, 3), np.nan)}),
        _spoiled({"0.feet": np.zeros((3, 2, 3))}),
        _spoiled({"body.parents": np.arange(99)}),
        _spoiled({"1.joints": np.array([True, False])}),
        _spoiled({"0.rotations": np.array([{"an": "object"}], dtype=object)}),
    ],
)
def test_a_file_that_is_no_whole_library_is_refused_by_name(content: bytes) -> None:
    with pytest.raises(FileError, match=r"^other\.npz: "):
        library_file.decoded(content, "other.npz")


def test_a_file_with_a_wrong_byte_is_refused_or_read_but_nothing_else() -> None:
    whole = library_file.encoded(_library())
    refused = 0
    for place in RNG.integers(0, len(whole), 200).tolist():
        wrong = bytearray(whole)
        wrong[place] ^= 0xFF
        try:
            library_file.decoded(bytes(wrong), "other.npz")
        except FileError:
            refused += 1
    assert refused > 100


def test_a_missing_file_and_a_missing_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(FileError, match=r"none\.npz"):
        library_file.load(tmp_path / "none.npz")
    with pytest.raises(FileError, match=r"folder/own\.npz"):
        library_file.save(_library(), tmp_path / "folder" / "own.npz")
