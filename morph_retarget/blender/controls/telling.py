"""What users are told of a motion on controls."""

from ...core.character.controls import joints_without
from ...core.errors import listed
from ...core.mocap.measure import Spread
from .task import Onto, Work

CLOSE_ENOUGH = 2.0
"""A mean error of bones above this is worth a warning [degrees]."""


def described(work: Work, controls: int, passes: int, error: Spread) -> dict[str, object]:
    """Return what reports say of controls.

    Args:
        work: What was done.
        controls: How many were moved.
        passes: How often the motion was evaluated.
        error: Between directions of deform bones and what was meant [deg].
    """
    return {
        "family": work.controls.family,
        "onto": "ik" if work.onto is Onto.IK else "fk",
        "controls": controls,
        "passes": passes,
        "deform_error_deg": {"mean": round(error.mean, 4), "max": round(error.max, 4)},
    }


def warnings(work: Work, error: Spread) -> tuple[str, ...]:
    """Return what the user should know."""
    found, target, out = work.controls, work.target, list[str]()
    names = work.plan.target.skeleton.names
    lost = joints_without({joint: match.bone for joint, match in work.task.character.joints.items()}, found)
    moved = {names[int(bone)] for bone in work.plan.links.target}
    lost = [joint for joint in lost if work.task.character.joints[joint].bone in moved]
    if lost:
        out.append(f"no control of {target.name!r} was found for {listed(lost)}: name them in the joint list")
    if work.onto is Onto.IK:
        there = {limb.limb.end for limb in found.limbs}
        links = work.plan.links
        ends = [names[int(links.target[limb.end])] for limb in (*links.legs, *links.arms)]
        without = [name for name in ends if name not in there]
        if without:
            out.append(f"{listed(without)} of {target.name!r} have no control that reaches: they are turned instead")
    if error.mean > CLOSE_ENOUGH:
        out.append(
            f"the controls of {target.name!r} bring its bones {error.mean:.1f} degrees from where they were meant: "
            "something besides them moves the bones; check the controls in the joint list"
        )
    return tuple(out)
