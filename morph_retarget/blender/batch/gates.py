"""Gates: limits on what was measured, which a job must keep to count as done."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...core.errors import MotionError, listed

_Report = Mapping[str, Any]
MEASURES: dict[str, tuple[str, Callable[[_Report], float]]] = {
    "slide": ("mean speed of standing feet [m/s]", lambda r: r["foot_slide_m_per_s"]["target"]),
    "slide-added": (
        "the same beyond the source's own [m/s]",
        lambda r: r["foot_slide_m_per_s"]["target"] - r["foot_slide_m_per_s"]["source"],
    ),
    "error": (
        "mean angle between bones of source and target [degrees]",
        lambda r: r["bone_direction_error_deg"]["mean"],
    ),
    "error-p95": ("angle that 95 % of the bones keep [degrees]", lambda r: r["bone_direction_error_deg"]["p95"]),
    "error-max": ("largest of these angles [degrees]", lambda r: r["bone_direction_error_deg"]["max"]),
    "twist": ("largest twist that was added [degrees]", lambda r: r["bone_twist_error_deg"]["max"]),
    "penetration": ("how deep a sole sinks at most [m]", lambda r: r["ground_penetration_m"]["max"]),
    "jump": ("largest turn of a joint in one frame [degrees]", lambda r: r["pose_jump_deg"]["max"]),
    "jump-added": (
        "the same beyond the source's own [degrees]",
        lambda r: r["pose_jump_deg"]["max"] - r["pose_jump_deg"]["source_max"],
    ),
    "joints": ("joints that were given the motion", lambda r: r["joints_mapped"]),
    "warnings": ("number of warnings", lambda r: len(r["warnings"])),
}
"""What gates can ask for: meaning, and where it stands in the report of a pair."""


@dataclass(frozen=True)
class Gate:
    """A job fails where a measure lies beyond a limit."""

    measure: str
    above: bool
    """Whether values above the limit fail; else those below."""
    limit: float

    def broken(self, report: _Report) -> str | None:
        """Return what is wrong with a result; None when it passes."""
        value = MEASURES[self.measure][1](report)
        if value > self.limit if self.above else value < self.limit:
            return f"{self.measure} {value:.4g} {'>' if self.above else '<'} {self.limit:g}"
        return None


def parse(text: str) -> list[Gate]:
    """Return the gates in a text such as ``slide>0.01,error>5``.

    Raises:
        MotionError: One names no measure, or is no comparison with a number.
    """
    out: list[Gate] = []
    for part in text.split(","):
        match = re.fullmatch(r"\s*([a-z0-9-]+)\s*([<>])\s*([0-9]*\.?[0-9]+)\s*", part)
        if match is None:
            raise MotionError(f"gate {part.strip()!r}: write a measure, > or <, and a number, as slide>0.01")
        if match[1] not in MEASURES:
            raise MotionError(f"gate {part.strip()!r}: there is no measure {match[1]!r}: use {listed(MEASURES, 20)}")
        out.append(Gate(match[1], match[2] == ">", float(match[3])))
    return out


def judged(reports: Sequence[_Report], gates: Sequence[Gate]) -> str:
    """Return what is wrong with the results of a job; empty when all gates are passed."""
    told = [gate.broken(report) for report in reports for gate in gates]
    return ", ".join(dict.fromkeys(text for text in told if text is not None))
