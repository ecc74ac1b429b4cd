"""Measuring a played action: how near bodies come to their goals, and how far any sinks into the ground."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..play import Played
from .bind import Binding
from .bodies import Bodies

FIELDS: Mapping[str, str] = {
    "source": "the action",
    "target": "the character",
    "frames": "how many were played",
    "seconds_per_stage": "time for `bind`, `sample`, `evaluate` and `write`",
    "channels": "by name: the `bodies` that a channel selects, and how far they stay from their goals, "
    "`goal_error_m` (`mean`, `max`)",
    "variant": "which of the ways to play it is, from 0",
    "variants": "how many ways there are",
    "ground_penetration_m": "how deep a joint sinks at `max`",
    "events": "`name` and `frame` of each pose marker",
    "problems": "what of the action does not play on this character, and why",
    "warnings": "what else you should know",
}
"""Meaning of what `describe` returns."""


@dataclass(frozen=True)
class Fit:
    """How one channel plays on a character."""

    bodies: tuple[str, ...]
    """What it selects."""
    mean: float
    """Distance of its bodies from their goals [m], weighted by how much these count; 0 without goals for places."""
    largest: float
    """The largest [m], each counted by its influence."""


def fits(binding: Binding, played: Played) -> list[Fit]:
    """Return how each channel of a binding plays."""
    goals, names = played.goals, binding.bodies.names
    away = np.linalg.norm(played.pose.positions[:, goals.bodies] - goals.positions, axis=-1)
    influence = goals.position_influence
    place = {int(body): i for i, body in enumerate(goals.bodies)}
    out: list[Fit] = []
    for i, selected in enumerate(binding.selected):
        own = [place[e.body] for e in binding.entries if e.channel == i and e.position]
        missed = away[:, own] * influence[:, own]
        share = float(influence[:, own].sum())
        mean = float(missed.sum()) / share if share > 0.0 else 0.0
        out.append(Fit(tuple(names[body] for body in selected), mean, float(missed.max(initial=0.0))))
    return out


def penetration(bodies: Bodies, positions: Array) -> float:
    """Return how far any joint sinks below the ground at most, or below its rest where it rests lower [m].

    Args:
        bodies: Of the character.
        positions: Of its bodies [m], character frame, shape (frame, body, 3).
    """
    floor = np.minimum(bodies.positions[:, 2], 0.0)
    return float((floor - positions[..., 2]).max(initial=0.0))


def describe(
    source: str,
    target: str,
    frames: int,
    seconds_per_stage: Mapping[str, float],
    binding: Binding,
    played: Played,
    events: Sequence[tuple[str, float]],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the report of an action on a character as plain data.

    Args:
        source: Name of the action.
        target: Name of the character.
        frames: Frames played.
        seconds_per_stage: Time that each stage took [s].
        binding: How the action plays.
        played: The result.
        events: Names and frames.
        warnings: What the user should know besides the problems of the binding.
    """
    channels = binding.action.channels
    return {
        "source": source,
        "target": target,
        "frames": frames,
        "seconds_per_stage": {stage: round(seconds, 5) for stage, seconds in seconds_per_stage.items()},
        "channels": {
            channel.name: {
                "bodies": list(fit.bodies),
                "goal_error_m": {"mean": round(fit.mean, 5), "max": round(fit.largest, 5)},
            }
            for channel, fit in zip(channels, fits(binding, played), strict=True)
        },
        "variant": binding.variant,
        "variants": len(binding.variants),
        "ground_penetration_m": {"max": round(penetration(binding.bodies, played.pose.positions), 5)},
        "events": [{"name": name, "frame": frame} for name, frame in events],
        "problems": list(binding.problems),
        "warnings": list(warnings),
    }
