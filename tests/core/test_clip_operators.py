"""Clip operators: what holds for all of them, whatever they are made from."""

from collections.abc import Callable

import numpy as np
import pytest

from morph_retarget.core.clips.clip import Clip
from morph_retarget.core.clips.operators.additive import Additive
from morph_retarget.core.clips.operators.blend import Blend
from morph_retarget.core.clips.operators.concatenate import Concatenate
from morph_retarget.core.clips.operators.embed import Embed
from morph_retarget.core.clips.operators.filter import Filter
from morph_retarget.core.clips.operators.loop import Loop
from morph_retarget.core.clips.operators.mask import Mask
from morph_retarget.core.clips.operators.mirror import Mirror
from morph_retarget.core.clips.operators.mix import Mix
from morph_retarget.core.clips.operators.noise import Noise
from morph_retarget.core.clips.operators.overlay import Overlay
from morph_retarget.core.clips.operators.revert import Revert
from morph_retarget.core.clips.operators.section import Section
from morph_retarget.core.clips.operators.time_shift import TimeShift
from morph_retarget.core.clips.operators.time_warp import TimeWarp
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.errors import MotionError
from tests.random_clips import apart, body, difference, times_of, wander

ARMS, ALL = body().part("arms"), body().part("all")
A, B = wander(1), wander(2, 31, first=5.0)
WAVE = wander(3, 30, ARMS, 6.0)
ROUND = Loop(0, A, 6.0)
SMOOTH = (0.25, 0.5, 0.25)

CLIPS: dict[str, Clip] = {
    "shift": TimeShift(3.5, A),
    "section": Section(4.5, 30.0, A),
    "endless section": Section(-2.0, np.inf, A),
    "loop": ROUND,
    "rounds": Loop(3, A),
    "loop of a cycle that was warped": Loop(0, TimeWarp(((0.0, 0.0), (23.0, 36.8)), A), closing=1.6),
    "revert": Revert(18.5, A),
    "warp": TimeWarp(((2.0, 0.0), (9.0, 20.0), (9.0, 24.0), (23.0, 30.0)), A),
    "warp without end": TimeWarp(((2.0, 0.0), (90.0, 30.0)), ROUND),
    "filter": Filter(SMOOTH, -1, A),
    "filter without end": Filter(SMOOTH, -1, ROUND, reflected=True),
    "blend": Blend(0.0, 15.0, 12.0, 20.3, A, B),
    "linear blend": Blend(0.0, 15.0, 12.3, 20.0, A, B, smooth=False),
    "blend into what began before": Blend(3.0, -20.0, 8.0, 16.0, A, ROUND),
    "blend into some joints": Blend(0.0, 10.0, 12.0, 20.0, A, WAVE),
    "blend from some joints": Blend(0.0, 15.0, 12.0, 20.0, WAVE, A),
    "embed": Embed(0.0, 20.0, 15.0, 25.0, 40.0, 58.0, ROUND, B),
    "mask": Mask(ARMS, A),
    "mask with the root": Mask(body().part("trunk"), A),
    "overlay": Overlay(ROUND, WAVE, ARMS, 4.0, 5.0),
    "overlay of the whole body": Overlay(ROUND, B, ALL, 4.0, 5.0),
    "overlay without end": Overlay(A, ROUND, body().part("legs", "trunk"), 4.0),
    "mirror": Mirror(B),
    "additive": Additive(A, B, 0.7),
    "additive of some": Additive(ROUND, WAVE, -0.4, from_rest=True),
    "noise": Noise(ROUND, ARMS, 0.1, 3.0, 4),
    "concatenate": Concatenate(A, B, 12.0),
    "mix of cycles": Mix((Loop(0, A, 6.0), Loop(0, B, 7.0)), (1.0, 2.0)),
    "mix in step": Mix((ROUND, Loop(0, B, 7.0)), (1.0, 2.0), marks=((3.0, 12.0), (26.0, 40.0))),
    "mix": Mix((A, B, WAVE), (1.0, 2.0, 0.5), cyclic=False, marks=((3.0,), (10.0,), (15.0,))),
}


def _tree() -> Clip:
    going = Mix((Loop(0, A, 6.0), Loop(0, Mirror(A), 6.0)), (2.0, 1.0))
    return Noise(Overlay(Blend(0.0, 10.0, 20.0, 30.0, going, Loop(0, B, 8.0)), WAVE, ARMS, 5.0, 5.0), ALL, 0.05)


CLIPS["tree"] = _tree()
every = pytest.mark.parametrize("clip", CLIPS.values(), ids=CLIPS.keys())


@every
def test_a_time_alone_and_among_others_in_any_order_gives_the_same(clip: Clip) -> None:
    times = times_of(clip)
    frames, way = clip.frame(times), clip.travel(times)
    back = np.argsort(times)
    assert difference(clip.frame(times[back]), frames[back]) < 1e-12
    assert apart(clip.travel(times[back]), way[back]) < 1e-12
    for i in range(0, len(times), 7):
        one = np.array([i])
        assert difference(clip.frame(times[one]), frames[one]) < 1e-12
        assert apart(clip.travel(times[one]), way[one]) < 1e-12


@every
def test_poses_and_ways_never_leap(clip: Clip) -> None:
    times = np.arange(clip.start - 3.0, (clip.end if clip.is_finite else 120.0) + 3.0, 0.05)
    # All frames at which something begins or ends, from both sides.
    seams = np.unique(np.concatenate([np.round(times), times]))
    times = np.sort(np.concatenate([seams - 1e-6, seams, seams + 1e-6]))
    frames, way = clip.frame(times), clip.travel(times)
    near = np.diff(times) < 2e-6
    first, second = np.flatnonzero(near), np.flatnonzero(near) + 1
    assert difference(frames[first], frames[second]) < 2e-5
    assert apart(way[first], way[second]) < 2e-6


@every
def test_a_clip_sets_out_from_where_it_starts_and_holds_its_ends(clip: Clip) -> None:
    start = np.array([clip.start, clip.start - 7.0])
    assert apart(clip.travel(start), Travel.still(2)) < 1e-12
    assert difference(clip.frame(start[:1]), clip.frame(start[1:])) < 1e-12
    if clip.is_finite:
        end = np.array([clip.end, clip.end + 7.0])
        assert difference(clip.frame(end[:1]), clip.frame(end[1:])) < 1e-12
        assert apart(clip.travel(end[:1]), clip.travel(end[1:])) < 1e-12


@every
def test_rotations_are_unit_contacts_within_their_bounds_and_joints_without_data_at_rest(clip: Clip) -> None:
    frames = clip.frame(times_of(clip))
    assert np.abs(np.linalg.norm(frames.rotations, axis=-1) - 1.0).max() < 1e-9
    assert frames.contacts.min() >= -1e-12
    assert frames.contacts.max() <= 1.0 + 1e-12
    assert np.abs(np.abs(frames.rotations[:, ~clip.active, 0]) - 1.0).max(initial=0.0) < 1e-12
    assert clip.model is body()


@every
def test_parts_are_not_changed_by_evaluating_what_is_made_from_them(clip: Clip) -> None:
    times = times_of(clip)
    before = [a.copy() for a in (A.data.rotations, A.data.translations, A.data.feet, A.data.contacts, A.way.places)]
    first, again = clip.frame(times), clip.frame(times)
    clip.travel(times)
    after = (A.data.rotations, A.data.translations, A.data.feet, A.data.contacts, A.way.places)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))
    assert difference(first, again) == 0.0


@every
def test_no_times_give_no_frames(clip: Clip) -> None:
    assert len(clip.frame(np.zeros(0))) == len(clip.travel(np.zeros(0))) == 0


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: TimeShift(np.nan, A), "shift is nan"),
        (lambda: Section(5.0, 3.0, A), "before it begins at 5"),
        (lambda: Section(5.0, np.nan, A), "end it later"),
        (lambda: Loop(0, A, 20.0), "blends over 20 frames"),
        (lambda: Loop(0, A, closing=-1.0), "longer closing"),
        (lambda: Revert(np.inf, A), "turning is inf"),
        (lambda: TimeWarp(((0.0, 0.0), (4.0, 3.0), (5.0, 3.0)), A), r"\(4, 3\) and \(5, 3\) are out of order"),
        (lambda: TimeWarp(((4.0, 0.0), (3.0, 3.0)), A), "out of order"),
        (lambda: TimeWarp(((0.0, np.nan),), A), "place of key 0 is nan"),
        (lambda: Filter((0.5, np.nan), 0, A), "coefficient 1 is nan"),
        (lambda: Filter((0.5, 0.5), 1, A), "from 1 to 2"),
        (lambda: Filter((), 0, A), "let 0 be among them"),
        (lambda: Blend(5.0, 0.0, 3.0, 9.0, A, B), "begins at 3, before the first clip does at 5"),
        (lambda: Blend(0.0, 0.0, 9.0, 3.0, A, B), "ends at 3, before it begins at 9"),
        (lambda: Blend(0.0, 20.0, 3.0, 9.0, A, B), "begins at 20, after the blend is over at 9"),
        (lambda: Embed(0.0, 0.0, 3.0, 9.0, 7.0, 12.0, A, B), "leaves the inner clip at 7"),
        (lambda: Embed(0.0, 0.0, 3.0, 2.0, 7.0, 12.0, A, B), "ends at 2"),
        (lambda: Mask(ARMS[:3], A), "3 joints are marked and the body has 22"),
        (lambda: Overlay(A, B, ARMS, 20.0, 20.0), "fade faster"),
        (lambda: Overlay(A, B, ARMS, -1.0), "fade faster"),
        (lambda: Additive(A, B, np.nan), "weight is nan"),
        (lambda: Noise(A, ARMS, -1.0), "0 or more"),
        (lambda: Noise(A, ARMS, 1.0, np.inf), "frequency is inf"),
        (lambda: Concatenate(ROUND, A, 3.0), "has no end"),
        (lambda: Concatenate(A, B, -3.0), "0 frames or more"),
        (lambda: Mix((), ()), "no clips"),
        (lambda: Mix((A, B), (1.0,)), "1 weights are given for 2 clips"),
        (lambda: Mix((A, B), (1.0, -1.0)), "0 or more"),
        (lambda: Mix((A, B), (0.0, 0.0)), "one must be more"),
        (lambda: Mix((A, Mirror(ROUND)), (1.0, 1.0)), "no cycle"),
        (lambda: Mix((A, ROUND), (1.0, 1.0), cyclic=False), "cut a section"),
        (lambda: Mix((A, B), (1.0, 1.0), marks=((1.0,), (6.0, 8.0))), "1, 2 marks"),
        (lambda: Mix((A, B), (1.0, 1.0), False, marks=((4.0, 2.0), (6.0, 8.0))), "ascend"),
        (lambda: Mix((A, B), (1.0, 1.0), marks=((np.nan,), (6.0,))), "not a number"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(make: Callable[[], Clip], told: str) -> None:
    with pytest.raises(MotionError, match=told):
        make()


def test_clips_of_two_bodies_are_not_put_together() -> None:
    other = A.__class__("other", body().__class__(body().character, body().root), A.data, A.way)
    with pytest.raises(MotionError, match="'other' is made for another body"):
        Blend(0.0, 0.0, 3.0, 9.0, A, other)


def test_a_label_tells_each_operator() -> None:
    assert {type(clip).__name__ for clip in CLIPS.values()} == {clip.label.split(" ")[0] for clip in CLIPS.values()}
    assert all(clip.parts for clip in CLIPS.values())
