"""Nodding, shaking, tilting the head, and the jumps of the eyes."""

from itertools import pairwise

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.clips.behaviours import nodding, saccades
from morph_retarget.core.clips.behaviours.behaviour import Cue
from morph_retarget.core.clips.commands.command import Command
from tests.behaving import RATE, Subject, creature, figure, reset, start, stop

HEADS = {"figure": figure(), **{name: creature(name) for name in ("biped", "hound", "spider")}}
each = pytest.mark.parametrize("subject", HEADS.values(), ids=HEADS)
TIMES = np.arange(241) / RATE


@each
@pytest.mark.parametrize("model", ["nod", "shake"])
def test_a_head_that_has_nodded_is_where_it_was(subject: Subject, model: str) -> None:
    shown = subject.act([start(0.5, model, repeats=3.0, speed=2.0)], seconds=4.0)
    turns, base = shown.acted.posture.turns, shown.base.turns
    moving = quat.angle_between(turns, base).max(axis=1)
    assert moving[: shown.frame(0.5) + 1].max() < 1e-9
    assert moving[shown.frame(2.0) :].max() < 1e-9
    assert moving.max() > np.radians(8.0)


@each
def test_a_nod_turns_the_head_down_by_its_amplitude(subject: Subject) -> None:
    actor = subject.actor
    shown = subject.act([start(0.0, "nod", repeats=5.0, amplitude=20.0, speed=1.0)], seconds=6.0)
    looks, base = (p.seen(actor.head, actor.forward) for p in (shown.acted.posture, shown.base))
    down = np.arcsin(base[:, 2]) - np.arcsin(looks[:, 2])
    assert down.min() > -0.01
    assert abs(np.degrees(down.max()) - 20.0) < 4.0
    aside = np.cross(looks, base)[..., 2]
    assert np.abs(aside).max() < 1e-6


def test_shaking_is_to_both_sides_and_tilting_to_one() -> None:
    subject = HEADS["figure"]
    actor = subject.actor
    shaken = subject.act([start(0.0, "shake", repeats=4.0, speed=1.0)], seconds=5.0)
    to_side = shaken.acted.posture.seen(actor.head, actor.forward)[:, 0]
    assert to_side.max() > 0.15
    assert to_side.min() < -0.15
    tilted = subject.act([start(0.0, "tilt", amplitude=20.0), stop(2.0, "tilt")], seconds=5.0).acted.posture
    crown = tilted.seen(actor.head, np.array([0.0, 0.0, 1.0]))
    assert abs(np.degrees(np.arcsin(crown[45, 0])) - 20.0) < 0.1
    assert np.abs(crown[-1] - crown[0]).max() < 1e-9


@pytest.mark.parametrize("end", [stop(0.8, "nod"), start(0.8, "nod", repeats=2.0), reset(0.8, "nod")])
def test_a_nod_that_is_broken_off_ends(end: Command) -> None:
    subject = HEADS["biped"]
    shown = subject.act([start(0.0, "nod", repeats=20.0), end], seconds=8.0)
    still = quat.angle_between(shown.acted.posture.turns, shown.base.turns).max(axis=1)
    assert still[shown.frame(3.0) :].max() < 1e-9
    step = quat.angle_between(shown.acted.posture.turns[1:], shown.acted.posture.turns[:-1]).max()
    assert step < np.radians(20.0)


# --- saccades ---


def _cue(**values: float | str) -> Cue:
    command = start(0.0, "saccade", **values)
    return Cue(0.0, command.parameters, command)


def test_jumps_of_the_eyes_follow_the_main_sequence() -> None:
    jumps = list(saccades.jumps(_cue(), 600.0))
    assert len(jumps) > 200
    sizes = np.degrees([jump.size for jump in jumps])
    lasts = np.array([jump.lasts for jump in jumps])
    assert np.abs(lasts - (0.025 + 0.0024 * sizes)).max() < 1e-12
    assert sizes.max() < 2.0 * 30.0
    away = [np.hypot(*jump.end) for jump in jumps if jump.start == (0.0, 0.0)]
    # -6.9 ln(P / 15.7), P even from 0 to 15: the median is at P = 7.5.
    assert abs(np.degrees(np.median(away)) - 6.9 * np.log(15.7 / 7.5)) < 0.8


def test_jumps_follow_each_other_and_are_never_two_at_a_time() -> None:
    for mood in ("talk", "listen"):
        jumps = list(saccades.jumps(_cue(mood=mood), 300.0))
        for before, after in pairwise(jumps):
            assert after.at >= before.at + before.lasts + saccades.LEAST - 1e-9
            assert after.start == before.end


def test_the_same_seed_is_the_same_life_and_another_is_another() -> None:
    own, again, other = (list(saccades.jumps(_cue(seed=seed), 60.0)) for seed in (1.0, 1.0, 2.0))
    assert own == again
    assert own != other


def test_eyes_come_back_when_they_are_stopped() -> None:
    subject = HEADS["biped"]
    shown = subject.act([start(0.5, "saccade", seed=3.0), stop(6.0, "saccade")], seconds=8.0)
    off = quat.angle_between(shown.acted.posture.turns, shown.base.turns)
    assert off[: shown.frame(0.5)].max() < 1e-9
    assert off[shown.frame(6.1) :].max() < 1e-9
    assert 0.02 < off.max() < np.radians(40.0)
    others = [body for body in range(off.shape[1]) if body not in subject.actor.eyes]
    assert off[:, others].max() < 1e-9


def test_a_longer_clip_begins_as_a_shorter_one() -> None:
    subject = HEADS["biped"]
    commands = [start(0.5, "saccade"), start(1.0, "nod", repeats=9.0)]
    short, long = (subject.act(commands, seconds=seconds).acted.posture for seconds in (3.0, 9.0))
    assert np.abs(short.turns - long.turns[: len(short)]).max() < 1e-12


def test_nothing_nods_without_a_command() -> None:
    assert not nodding.nod_angles(TIMES, ()).any()
    assert not nodding.tilt_angles(TIMES, ()).any()
