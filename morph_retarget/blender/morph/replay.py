"""Frames that characters have played, by what they were told: to show one again costs next to nothing.

A pose depends on values and targets alone, so it is known again by these, whatever has been edited in between.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from ...core.play import Played
from .cast import Member
from .pose import Setting

MOST = 4096
"""Frames that are kept of a character; the oldest make room."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that a character has played."""

    member: Member
    played: Played

    @cached_property
    def setting(self) -> Setting:
        """What it sets on pose bones, in the rotation modes that these have when it is first asked for."""
        return Setting.of(self.member.rig, self.played)


@dataclass(frozen=True, eq=False)
class _Kept:
    member: Member
    frames: dict[tuple[object, ...], Frame]


_kept: dict[int, _Kept] = {}


def forget(uid: int | None = None) -> None:
    """Drop the frames of a character by its session-wide number, or those of all."""
    if uid is None:
        _kept.clear()
    else:
        _kept.pop(uid, None)


def frame(member: Member, told: tuple[object, ...], play: Callable[[], Played]) -> Frame:
    """Return a frame of a character.

    Args:
        member: The character as it plays its action.
        told: All that the frame and the way it is written depend on.
        play: Returns the frame, if it has not been played before.
    """
    kept = _kept.get(member.rig.uid)
    if kept is None or kept.member is not member:
        kept = _kept[member.rig.uid] = _Kept(member, {})
    found = kept.frames.get(told)
    if found is None:
        found = Frame(member, play())
        if len(kept.frames) >= MOST:
            del kept.frames[next(iter(kept.frames))]
        kept.frames[told] = found
    return found
