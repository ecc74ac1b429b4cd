"""Patterns: the gait parameters of a group of feet at any speed, from one style or several layered ones.

Between the speeds for which manners are authored they are interpolated, below and above they are held (Hecker 2008
§4.2). A trigger goes the shorter way round the cycle from one manner to the next. Layers are blended by their weights
along ways that do not depend on the speed, so a pattern is continuous in speed and weights.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from ...arrays import Array
from .manner import MOST_BEATS, Manner
from .styles import STYLES, Change, Style

LEAST_DUTY, MOST_DUTY = 0.05, 0.95
"""Every foot stands and flies for some part of each cycle."""

_BODY = ("stride", "lift", "sway", "yaw", "roll", "pitch", "lean", "crouch", "swing", "toe_off", "heel_strike")
_FACTORS = ("stride", "lift", "yaw", "roll", "pitch", "swing", "toe_off", "heel_strike")
_ADDED = ("sway", "lean", "crouch")


@dataclass(frozen=True, eq=False)
class Pattern:
    """How a group of feet goes over samples of its speed; see `Manner` for what the parameters mean."""

    duty: Array
    """Shape (sample, foot)."""
    triggers: Array
    """In [0, 1), shape (sample, foot)."""
    stride: Array
    """[hip heights], above 0, shape (sample,), as all that follow but the waves."""
    lift: Array
    sway: Array
    yaw: Array
    roll: Array
    pitch: Array
    lean: Array
    crouch: Array
    swing: Array
    toe_off: Array
    heel_strike: Array
    waves: Array
    """Up and down of the body [leg lengths]: cosine and sine parts of waves of one, two … beats, (sample, beat, 2)."""

    def __len__(self) -> int:
        return len(self.stride)

    def bob(self, phase: Array) -> Array:
        """Return how high the body is [leg lengths] at the phase of the cycle of each sample, shape (sample,)."""
        return (self.waves * _turned(np.asarray(phase))).sum(axis=(-1, -2))

    def between(self, places: Array) -> "Pattern":
        """Return the pattern at places between its samples, 0 the first and 1 the second one, shape (n,)."""
        left = np.clip(np.floor(places).astype(np.intp), 0, max(len(self) - 2, 0))
        right = np.minimum(left + 1, len(self) - 1)
        share = np.clip(places - left, 0.0, 1.0)
        rows = dict[str, Array]()
        for item in fields(self):
            values: Array = getattr(self, item.name)
            low, way = values[left], values[right] - values[left]
            if item.name == "triggers":
                way -= np.round(way)
            rows[item.name] = low + share.reshape(-1, *[1] * (values.ndim - 1)) * way
        rows["triggers"] = _wrapped(rows["triggers"])
        return Pattern(**rows)


def pattern(layers: Sequence[tuple[Style, float]], sides: Sequence[int], speed: Array) -> Pattern:
    """Return the pattern of a group of feet.

    Args:
        layers: Styles and how much each counts, 0 or more. Those with manners of their own are averaged by that, `auto`
            where none counts; then those that change others are laid over it, each by its own weight.
        sides: Of the feet from the rear to the front, left before right: +1 left, -1 right, 0 in the middle.
        speed: Dimensionless, u = v / sqrt(g h), shape (sample,).
    """
    speed = np.asarray(speed, dtype=np.float64)
    slots = slots_of(sides)
    own = [(style, weight) for style, weight in layers if style.change is None and weight > 0.0]
    total = sum(weight for _, weight in own)
    tables = [_table(style.manners(len(sides)), slots) for style, _ in own or [(STYLES["auto"], 1.0)]]
    shares = [weight / total for _, weight in own] or [1.0]
    out = _blended([_aligned(table, tables[0]) for table in tables], shares, speed)
    for style, weight in layers:
        if style.change is not None and weight > 0.0:
            out = _changed(out, style.change, weight, slots)
    duty = np.clip(out.duty, LEAST_DUTY, MOST_DUTY)
    return replace(out, duty=duty, triggers=_wrapped(out.triggers))


def slots_of(sides: Sequence[int]) -> tuple[int, ...]:
    """Return which foot of the authored order each foot of a group is.

    The authored order has pairs from the rear to the front, left before right, and then the odd foot, if any. A foot
    takes the hindmost place of its side that is left; who finds none takes the hindmost of all that are left.

    Args:
        sides: Of the feet from the rear to the front, left before right.
    """
    count = len(sides)
    paired = 2 * (count // 2)
    free = {1: list(range(0, paired, 2)), -1: list(range(1, paired, 2)), 0: list(range(paired, count))}
    found = [free[side].pop(0) if free[side] else None for side in sides]
    rest = iter(sorted(slot for slots in free.values() for slot in slots))
    return tuple(next(rest) if slot is None else slot for slot in found)


# --- one style ---


@dataclass(frozen=True, eq=False)
class _Table:
    """The manners of one style as arrays, rows by rising speed."""

    speeds: Array
    triggers: Array
    """Without jumps, shape (manner, foot)."""
    rows: Array
    """Duty factor, `_BODY`, and the waves of the bob, shape (manner, n)."""

    def at(self, speed: Array) -> Array:
        """Return triggers and rows between the manners, shape (sample, foot + n)."""
        both = np.concatenate([self.triggers, self.rows], axis=1)
        place = np.interp(speed, self.speeds, np.arange(len(self.speeds), dtype=np.float64))
        left = np.minimum(place.astype(np.intp), len(both) - 2)
        share = (place - left)[:, None]
        return (1.0 - share) * both[left] + share * both[left + 1]


def _table(manners: Sequence[Manner], slots: Sequence[int]) -> _Table:
    triggers = np.array([manner.triggers for manner in manners])[:, list(slots)]
    waves = np.zeros((len(manners), MOST_BEATS, 2))
    for row, manner in zip(waves, manners, strict=True):
        beat = manner.bob_beats - 1
        row[beat] = manner.bob * _turned(np.array(manner.bob_phase))[beat]
    body = [[manner.duty, *(getattr(manner, name) for name in _BODY)] for manner in manners]
    rows = np.concatenate([np.array(body), waves.reshape(len(manners), -1)], axis=1)
    return _Table(np.array([manner.speed for manner in manners]), np.unwrap(triggers, axis=0, period=1.0), rows)


def _turned(phase: Array) -> Array:
    """Return cosine and sine of one, two … beats at phases of a cycle, shape (...) to (..., beat, 2)."""
    angle = 2.0 * np.pi * phase[..., None] * np.arange(1, MOST_BEATS + 1)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


# --- layers ---


def _aligned(table: _Table, first: _Table) -> _Table:
    """Return a table with its triggers by whole cycles nearer to those of the first one at the least speed."""
    return replace(table, triggers=table.triggers + np.round(first.triggers[0] - table.triggers[0]))


def _blended(tables: Sequence[_Table], shares: Sequence[float], speed: Array) -> Pattern:
    values = sum((share * table.at(speed) for table, share in zip(tables, shares, strict=True)), np.zeros(()))
    feet = tables[0].triggers.shape[1]
    triggers, duty, body, waves = np.split(values, [feet, feet + 1, feet + 1 + len(_BODY)], axis=1)
    return Pattern(
        np.repeat(duty, feet, axis=1),
        triggers,
        waves=waves.reshape(-1, MOST_BEATS, 2),
        **{name: body[:, i] for i, name in enumerate(_BODY)},
    )


def _changed(base: Pattern, change: Change, weight: float, slots: Sequence[int]) -> Pattern:
    """Return a pattern with a change laid over it."""
    hurt = slots.index(max(slots))
    duty, triggers = base.duty + weight * change.duty, base.triggers.copy()
    duty[:, hurt] -= weight * change.hurt
    triggers[:, hurt] += weight * change.late
    # The body is highest in the middle of the stance of the foot that hurts.
    rising = weight * change.rise * _turned(triggers[:, hurt] + 0.5 * duty[:, hurt])
    rising[:, 1:] = 0.0
    waves = _factor(change.bob, weight) * base.waves + rising
    scaled = {name: _factor(getattr(change, name), weight) * getattr(base, name) for name in _FACTORS}
    added = {name: getattr(base, name) + weight * getattr(change, name) for name in _ADDED}
    return replace(base, duty=duty, triggers=triggers, waves=waves, **scaled, **added)


def _factor(full: float, weight: float) -> float:
    """Return a factor by weight: as it is at 1, never below 0."""
    return full**weight if full > 0.0 else max(1.0 - weight, 0.0)


def _wrapped(triggers: Array) -> Array:
    wrapped = triggers - np.floor(triggers)
    return np.where(wrapped < 1.0, wrapped, 0.0)
