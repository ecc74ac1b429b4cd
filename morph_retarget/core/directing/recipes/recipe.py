"""Recipes: generalized actions as data, with what a base motion has to know of them (Hecker 2008 §3, §4.1).

A recipe is a file with the channels of an action and their keys. Nothing in it is ever executed.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from ... import quat
from ...arrays import Array
from ...character.morphology import Capability
from ...clips.motions.annotations import Strokes
from ...errors import MotionError
from ...morph import channel_file
from ...morph.bind import GeneralizedAction
from ...morph.branch import Answer, Branch
from ...morph.channels import Channel, Values
from ...morph.context import Context
from .curves import curve

FORMAT = 1
"""Version of the form that recipes are written in."""
_USUAL = Channel("", Context(Capability.ROOT))
"""Files tell what differs from this."""

Track = Mapping[float, tuple[float, ...]]
"""Values by frame."""


@dataclass(frozen=True)
class Tracks:
    """The keys of one channel."""

    position: Track = field(default_factory=dict[float, tuple[float, ...]], hash=False)
    """Generalized positions."""
    turn: Track = field(default_factory=dict[float, tuple[float, ...]], hash=False)
    """Generalized rotations as rotation vectors [deg]."""
    weight: Track = field(default_factory=dict[float, tuple[float, ...]], hash=False)
    """One value each, 1 where there are no keys."""


@dataclass(frozen=True)
class Recipe:
    """A generalized action and what it is for."""

    name: str
    kind: str
    """What commands call it."""
    frames: int
    """Its last frame; the first is 1. The last one of a cycle is the first again."""
    channels: tuple[Channel, ...]
    tracks: tuple[Tracks, ...]
    """Of the channels."""
    branch: Branch = field(default_factory=Branch)
    cycle: bool = False
    anchored: bool = False
    """Whether it is meant for a body that stands on the feet of its gait, and so has no feet of its own."""
    crucial: tuple[str, ...] = ()
    """Channels without which it makes no sense, and whose bodies it needs; all matter where none is named."""
    strokes: Mapping[str, float] = field(default_factory=dict[str, float], hash=False)
    """Frames of a gesture, by the names of `Strokes`."""

    @property
    def action(self) -> GeneralizedAction:
        """The action that it is."""
        return GeneralizedAction(self.name, self.channels, self.branch)

    def values(self, frames: Array) -> Values:
        """Return the values of all channels at frames, shape (n,)."""
        period = self.frames - 1.0 if self.cycle else None
        count = len(self.channels)
        positions, rotations = np.zeros((len(frames), count, 3)), quat.identity(len(frames), count)
        weights = np.ones((len(frames), count))
        for i, own in enumerate(self.tracks):
            if own.position:
                positions[:, i] = curve(*_keys(own.position), frames, period)
            if own.turn:
                when, turns = _keys(own.turn)
                keyed = quat.continuous(quat.from_rotation_vector(np.radians(turns)))
                rotations[:, i] = quat.normalize(curve(when, keyed, frames, period))
            if own.weight:
                weights[:, i] = curve(*_keys(own.weight), frames, period)[:, 0]
        return Values(positions, rotations, weights)

    def strokes_at(self, scale: float) -> Strokes | None:
        """Return the times of the gesture in a clip that is so much longer, None where it is none."""
        if not self.strokes:
            return None
        return Strokes(**{name: scale * (frame - 1.0) for name, frame in self.strokes.items()})


def _keys(track: Track) -> tuple[Array, Array]:
    frames = sorted(track)
    return np.array(frames, dtype=np.float64), np.array([track[frame] for frame in frames], dtype=np.float64)


# --- files ---


def to_text(recipe: Recipe) -> str:
    """Return a recipe as the text of a file: one line for each channel, and one for its keys."""
    usual, *rows = cast("list[Any]", json.loads(channel_file.to_text([_USUAL, *recipe.channels]))["channels"])
    named = {"name": recipe.name, "kind": recipe.kind, "frames": recipe.frames, "cycle": recipe.cycle}
    named |= {"anchored": recipe.anchored, "crucial": list(recipe.crucial), "strokes": dict(recipe.strokes)}
    named["branch"] = {
        name: value for name, value in vars(recipe.branch).items() if value is not None and value != Answer.IGNORE
    }
    lines = [f' "format": {FORMAT}', *(f' "{name}": {_told(value)}' for name, value in named.items() if value)]
    lines.append(' "channels": [\n  ' + ",\n  ".join(_told(_changed(row, usual)) for row in rows) + "\n ]")
    lines.append(' "keys": [\n  ' + ",\n  ".join(_told(_told_tracks(own)) for own in recipe.tracks) + "\n ]")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _told(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False)


def _changed(row: dict[str, Any], usual: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of a channel that are not as usual; capabilities are always told."""
    out = {name: value for name, value in row.items() if name == "context" or value != usual.get(name)}
    for name in out.keys() & {"movement", "context", "secondary"}:
        own = usual[name if name in usual else "context"]
        out[name] = {key: value for key, value in out[name].items() if key == "capability" or value != own.get(key)}
    return out


def _told_tracks(own: Tracks) -> dict[str, list[list[float]]]:
    return {
        name: [[_short(frame), *(_short(round(number, 5)) for number in track[frame])] for frame in sorted(track)]
        for name, track in vars(own).items()
        if track
    }


def _short(number: float) -> float:
    """Return a whole number without its decimals."""
    return int(number) if number == int(number) else number


def parse(text: str, origin: str) -> Recipe:
    """Return the recipe of a file.

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MotionError: It is no recipe, or a newer version made it.
    """
    try:
        data: Any = json.loads(text)
        if data["format"] != FORMAT:
            raise MotionError(
                f"{origin}: was made by a newer version of Morph Retarget: update the extension to use it"
            )
        channels = channel_file.parse(json.dumps({"channels": data["channels"]}), origin)
        tracks = tuple(_read_tracks(row) for row in data["keys"])
        known: dict[str, Any] = {
            name: Answer(v) if name != "leg_count" else v for name, v in data.get("branch", {}).items()
        }
        out = Recipe(
            str(data["name"]),
            str(data["kind"]),
            int(data["frames"]),
            channels,
            tracks,
            Branch(**known),
            bool(data.get("cycle")),
            bool(data.get("anchored")),
            tuple(data.get("crucial", ())),
            data.get("strokes", {}),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise MotionError(f"{origin}: is no recipe of a motion ({error}): write it again") from error
    if len(tracks) != len(channels):
        raise MotionError(f"{origin}: has {len(channels)} channels and keys for {len(tracks)}: give each its own")
    return out


def _read_tracks(row: Any) -> Tracks:
    found = cast("dict[str, list[list[float]]]", row)
    return Tracks(**{name: {key[0]: tuple(key[1:]) for key in keys} for name, keys in found.items()})
