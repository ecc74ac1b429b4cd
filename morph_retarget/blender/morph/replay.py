"""Frames that characters have played, by what they were told: to show one again costs next to nothing.

A pose depends on values and targets alone, so it is known again by these, whatever has been edited in between. What was
shown last at a frame of a scene is likely to be shown there again, which is a guess to be checked.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import bpy

from ...core.play import Played
from .member import Member
from .on_controls import setting_of
from .pose import Setting, Singles
from .stage import ToldTargets

MOST = 4096
"""Frames that are kept of a character; the oldest make room."""

Told = tuple[object, object, object, bytes]
"""Keys of values, targets and the way over the ground, and the rotation modes that the frame is written in."""
Moment = tuple[int, float]
"""A scene, by its session-wide number, and its frame, which need not be whole."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that a character has played."""

    member: Member
    told: Told
    """What it was played from."""
    targets: ToldTargets
    played: Played

    @cached_property
    def setting(self) -> Setting:
        """What it sets on pose bones, in the rotation modes that these have when it is first asked for."""
        return setting_of(self.member, self.played)


@dataclass(frozen=True, eq=False)
class Sight:
    """A frame as a character showed it at a moment."""

    frame: Frame
    basis: bytes
    """How all its bones were then turned, moved and scaled, from `pose.basis`."""
    state: dict[str, Singles]
    """Properties of its bones."""


@dataclass(frozen=True, eq=False)
class _Kept:
    member: Member
    frames: dict[Told, Frame]
    last: dict[Moment, Sight]


_kept: dict[int, _Kept] = {}


def forget(uid: int | None = None) -> None:
    """Drop the frames of a character by its session-wide number, or those of all."""
    if uid is None:
        _kept.clear()
    else:
        _kept.pop(uid, None)


def frame(member: Member, told: Told, targets: ToldTargets, play: Callable[[], Played]) -> Frame:
    """Return a frame of a character.

    Args:
        member: The character as it plays its action.
        told: What the frame is played from.
        targets: Where its targets are.
        play: Returns the frame, if it has not been played before.
    """
    kept = _kept.get(member.rig.uid)
    if kept is None or kept.member is not member:
        kept = _kept[member.rig.uid] = _Kept(member, {}, {})
    found = kept.frames.get(told)
    if found is None:
        found = kept.frames[told] = Frame(member, told, targets, play())
        _make_room(kept.frames)
    return found


def moment(scene: bpy.types.Scene) -> Moment:
    """Return the moment that a scene shows."""
    return scene.session_uid, scene.frame_current_final


def remember(now: Moment, sight: Sight) -> None:
    """Keep in mind what a character, which has just played it, shows at a moment."""
    kept = _kept[sight.frame.member.rig.uid].last
    kept[now] = sight
    _make_room(kept)


def last(uid: int, now: Moment) -> Sight | None:
    """Return what a character, by its session-wide number, showed last at a moment; None if nobody knows."""
    kept = _kept.get(uid)
    return kept.last.get(now) if kept is not None else None


def expect_nothing(uid: int) -> None:
    """Drop what a character showed last, by its session-wide number: where one guess was wrong, others may be.

    So a character that is edited, or that never shows the same again, is guessed at wrongly once and not at each frame.
    """
    _kept[uid].last.clear()


def _make_room(found: dict[Any, Any]) -> None:
    if len(found) > MOST:
        del found[next(iter(found))]
