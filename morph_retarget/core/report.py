"""What a retarget reports about each pair, as plain data."""

from collections.abc import Mapping, Sequence
from typing import Any

from .mocap.measure import Measures
from .mocap.plan import Plan

FIELDS: Mapping[str, str] = {
    "source": "the clip",
    "target": "the rig",
    "frames": "how many were transferred",
    "seconds_per_stage": "time for `sample`, `analyze`, `transfer` and `write`",
    "joints_mapped": "bones that were given the motion",
    "bone_direction_error_deg": "angle between bones of source and target: `mean`, `median`, `p95`, `max`",
    "bone_twist_error_deg": "twist that planting has added, likewise",
    "foot_slide_m_per_s": "mean speed of standing feet along the ground: `source` (at the target's size), `target`",
    "ground_penetration_m": "how deep a sole sinks at `max`",
    "pose_jump_deg": "largest turn of a joint in one frame: `max`, and the source's own `source_max`",
    "jiggles": "bones that were let follow with `--jiggles`",
    "warnings": "what you should know",
}
"""Meaning of what `describe` returns."""
CONTROLS_FIELDS: Mapping[str, str] = {
    "family": "of the rig, as it was found",
    "onto": "`fk` or `ik`",
    "controls": "how many were keyed",
    "passes": "how often Blender evaluated the whole clip",
    "deform_error_deg": "angle of the deform bones against what was meant: `mean`, `max`",
}
"""Meaning of what stands under ``controls`` where motion went onto controls."""


def describe(
    source: str,
    target: str,
    frames: int,
    seconds_per_stage: Mapping[str, float],
    plan: Plan,
    measures: Measures,
    jiggles: Sequence[str],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the report of one pair; all lengths in the target's metres.

    Args:
        source: Name of the clip.
        target: Name of the rig.
        frames: Frames transferred.
        seconds_per_stage: Time that each stage took [s].
        plan: Of the pair.
        measures: Of the result.
        jiggles: Bones that follow the motion.
        warnings: What the user should know.
    """
    return {
        "source": source,
        "target": target,
        "frames": frames,
        "seconds_per_stage": {stage: round(seconds, 5) for stage, seconds in seconds_per_stage.items()},
        "joints_mapped": len(plan.links),
        "bone_direction_error_deg": _spread(measures.direction),
        "bone_twist_error_deg": _spread(measures.twist),
        "foot_slide_m_per_s": {"source": round(measures.slide_source, 5), "target": round(measures.slide_target, 5)},
        "ground_penetration_m": {"max": round(measures.penetration, 5)},
        "pose_jump_deg": {"max": round(measures.jump_target, 3), "source_max": round(measures.jump_source, 3)},
        "jiggles": list(jiggles),
        "warnings": list(warnings),
    }


def _spread(values: Any) -> dict[str, float]:
    return {name: round(getattr(values, name), 4) for name in ("mean", "median", "p95", "max")}
