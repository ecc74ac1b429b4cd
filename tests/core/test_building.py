"""Building a library from clips of any rigs."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.clips import posing, spots
from morph_retarget.core.clips.character_model import RATE, CharacterModel
from morph_retarget.core.clips.motions.annotations import Annotations, Phase, Strike
from morph_retarget.core.clips.motions.base_motion import BaseMotion
from morph_retarget.core.clips.motions.library import Library
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.directing import building
from morph_retarget.core.directing.building import Builder, SourceClip, build, kind_of
from morph_retarget.core.directing.performing import model_of
from morph_retarget.core.directing.starter import starter
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import Bone


@cache
def _source(name: str = "biped") -> Library:
    return starter(analyze(skeleton_of(CREATURES[name]())), ("walk", "wave"))


@cache
def _target(size: float = 1.5) -> CharacterModel:
    """Return a human of another size, with bone axes that mean nothing."""
    bones = [
        Bone(part.name, part.parent, *(tuple(size * np.array(p)) for p in (part.head, part.tail)))
        for part in CREATURES["biped"]()
    ]
    return model_of(analyze(skeleton_of(bones, np.random.default_rng(1))))


def _clip(motion: BaseMotion, rounds: int = 3, name: str = "", rate: float = 2.0) -> SourceClip:
    """Return a base motion as a clip of its rig at some frames for each of its own; a cycle several times in a row."""
    clip = Loop(rounds, motion.clip) if motion.annotations.cycle else motion.clip
    times = np.arange(0.0, clip.end, 1.0 / rate)
    model = motion.clip.model
    pose = posing.pose_of(model, clip.frame(times), clip.travel(times))
    return SourceClip(name or motion.name, model.character, pose, 1.0 / (rate * RATE))


def _walk() -> BaseMotion:
    return _source().named("walk")


def test_a_walk_of_another_rig_becomes_a_cycle_of_walking_at_the_size_of_the_body() -> None:
    size = 1.5
    built = build(_target(size), [_clip(_walk())])
    (motion,) = built.library.motions
    known, own = _walk().annotations, motion.annotations
    assert (own.kind, own.cycle, own.phase) == ("walk", True, Phase.LOOP)
    assert abs(motion.clip.length - _walk().clip.length) <= 1.0
    assert abs(own.speed / (size * known.speed) - 1.0) < 0.05
    assert sorted(strike.foot for strike in own.strikes) == [0, 1]
    assert built.taken[0].kept
    assert "walk" in str(built.taken[0])
    assert "cycle" in str(built.taken[0])


def test_transferred_cycles_close_and_their_feet_stand() -> None:
    model = _target()
    (motion,) = build(model, [_clip(_walk())]).library.motions
    data, height = motion.clip.data, model.character.frame.height
    steps = quat.angle_between(np.roll(data.rotations, -1, axis=0), data.rotations)
    assert steps[-1].max() < 1.5 * steps[:-1].max()
    places = spots.in_world(data.feet, motion.clip.way)
    both = np.minimum(data.contacts[1:], data.contacts[:-1]) > 0.5
    slid = np.linalg.norm(np.diff(places[..., :2], axis=0), axis=-1)
    assert slid[both].max() < 5e-3 * height


def test_clips_of_the_body_itself_are_taken_as_they_are() -> None:
    motion = _walk()
    known = replace(motion.annotations, cycle=False, phase=Phase.WHOLE)
    clip = replace(_clip(motion, rate=1.0), known=known)
    (own,) = build(motion.clip.model, [clip]).library.motions
    # But for the root, which sways beside the way that was found.
    others = np.arange(len(motion.clip.model)) != motion.clip.model.root
    apart = quat.angle_between(own.clip.data.rotations[:20], motion.clip.data.rotations[:20])
    assert apart[:, others].max() < 1e-9


def test_what_is_known_by_hand_counts_and_feet_are_those_of_the_body() -> None:
    strikes = (Strike(0, 4.0), Strike(1, 12.0), Strike(1, 4000.0))
    known = Annotations("stroll", style="sad", strikes=strikes, speed=1.0, parameters={"speed": 1.0, "mood": 0.2})
    size = 1.5
    (own,) = build(_target(size), [replace(_clip(_walk()), known=known)]).library.motions
    assert (own.kind, own.annotations.style) == ("stroll", "sad")
    assert own.annotations.strikes == strikes[:2]
    assert abs(own.annotations.speed - size) < 0.02
    assert own.annotations.parameters["mood"] == 0.2


def test_the_last_frame_of_a_cycle_that_is_known_by_hand_is_its_first_and_falls_away() -> None:
    motion = _walk()
    count = int(motion.clip.length)
    whole = replace(motion.annotations, strikes=())
    times = np.arange(count + 1.0)
    looped = Loop(0, motion.clip)
    pose = posing.pose_of(motion.clip.model, looped.frame(times), looped.travel(times))
    clip = SourceClip("walk", motion.clip.model.character, pose, 1.0 / RATE, known=whole)
    (own,) = build(motion.clip.model, [clip]).library.motions
    assert own.clip.length == count


def test_clips_that_cannot_be_used_are_told_of_and_the_others_are_kept() -> None:
    short = _clip(_walk())
    short = replace(short, name="short", pose=type(short.pose)(short.pose.rotations[:2], short.pose.positions[:2]))
    snake = starter(analyze(skeleton_of(CREATURES["snake"]())), ("walk",))
    legless = _clip(snake.named("walk"), name="crawl")
    built = build(_target(), [short, legless, _clip(_walk())])
    assert [taken.kept for taken in built.taken] == [False, False, True]
    assert "short is left out: it has 2 frames" in str(built.taken[0])
    assert "crawl is left out: the source armature has no legs" in str(built.taken[1])
    assert len(built.library) == 1


def test_clips_of_one_name_get_names_of_their_own() -> None:
    built = build(_target(), [_clip(_walk())] * 2)
    assert [motion.name for motion in built.library.motions] == ["walk", "walk 2"]


def test_what_the_finder_has_no_name_for_is_called_by_that_of_its_clip() -> None:
    wave = _clip(_source().named("wave left"), name="Big Wave.001")
    (taken,) = (built := build(_target(), [wave])).taken
    assert built.library.kinds == ("big_wave_001",)
    assert "big_wave_001" in taken.told
    named = build(_target(), [replace(wave, kind="wave", style="big")]).library.motions[0]
    assert (named.kind, named.annotations.style) == ("wave", "big")


def test_kinds_are_single_words() -> None:
    assert kind_of("Rig|Walk Happy-01") == "rig_walk_happy_01"
    assert kind_of("...") == "other"


def _hips_beside_the_trunk() -> Character:
    """Return a human whose pelvis carries the legs alone; it and the spine hang on a hip bone."""
    out: list[Bone] = []
    for part in CREATURES["biped"]():
        parent = part.parent
        if part.name == "Hips":
            out.append(Bone("Hip", parent, part.head, part.tail))
            out.append(Bone("Pelvis", "Hip", part.head, part.tail))
            continue
        if parent == "Hips":
            parent = "Hip" if part.name == "Spine" else "Pelvis"
        out.append(Bone(part.name, parent, part.head, part.tail))
    return analyze(skeleton_of(out))


def test_a_root_above_the_pelvis_carries_the_whole_body() -> None:
    character = _hips_beside_the_trunk()
    model = model_of(character)
    assert character.head is not None
    assert character.head in character.skeleton.tree.below(model.root)
    (motion,) = build(model, [_clip(_walk())]).library.motions
    pose = posing.pose_of(model, motion.clip.data)
    places = character.local_to_character.points(pose.positions)
    away = np.linalg.norm(places[:, character.head] - places[:, model.root], axis=-1)
    rest = character.local_to_character.points(character.skeleton.rest_positions)
    assert np.abs(away / np.linalg.norm(rest[character.head] - rest[model.root]) - 1.0).max() < 0.1


def test_a_builder_takes_clips_one_by_one() -> None:
    builder = Builder(Library(_target()))
    assert builder.take(_clip(_walk())).kept
    assert len(builder.library) == 1
    assert builder.take(_clip(_source().named("wave right"), name="wave")).kept
    assert len(builder.library) == 2


@pytest.mark.parametrize("name", ["hound", "beetle"])
def test_four_and_six_legs_are_built_from_their_own_kind(name: str) -> None:
    source = starter(analyze(skeleton_of(CREATURES[name]())), ("walk",))
    target = model_of(analyze(skeleton_of(CREATURES[name](), np.random.default_rng(3))))
    (taken,) = (built := build(target, [_clip(source.named("walk"))])).taken
    assert taken.kept, taken
    assert built.library.motions[0].annotations.speed > 0.0


def test_feet_of_two_bodies_are_matched_by_side_and_row() -> None:
    biped, hound = (analyze(skeleton_of(CREATURES[name]())) for name in ("biped", "hound"))
    assert building.feet_between(biped, biped) == {0: 0, 1: 1}
    assert building.feet_between(hound, biped) == {0: 0, 1: 1}
