"""How characters play for the command line: switches of the solver and of jiggles, and locomotion."""

import argparse
from collections.abc import Mapping

import bpy

from ..morph import jiggles
from ..properties import of_rig
from . import locomotion
from .action_file import ActionFile

_SWITCHES: Mapping[str, tuple[str, str]] = {
    "bend_spine": (
        "bend the spine so that heads, hands and feet come to their goals (default: as the character's file says, "
        "else no)",
        "bends_spine",
    ),
    "allow_stretch": (
        "let limbs get longer and shorter to come to goals out of reach (default: as the character's file says, "
        "else no)",
        "allows_stretch",
    ),
    "avoid_collisions": (
        "swivel arms and legs out of the trunk, the head and each other (default: as the character's file says, "
        "else no)",
        "avoids_collisions",
    ),
    "above_ground": (
        "turn hands, tails and wings up where they would go below the ground (default: as the character's file says, "
        "else yes)",
        "keeps_above_ground",
    ),
    "joint_limits": (
        "turn no bone further than its own limits for inverse kinematics allow (default: as the character's file "
        "says, else yes)",
        "use_joint_limits",
    ),
    "jiggles": (
        "let tails, ears, hair and the like follow (default: as the character's file says, else yes)",
        "",
    ),
}
"""What each option does, and the setting of the character that it is; jiggles have settings of their own."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options."""
    for name, (told, _) in _SWITCHES.items():
        option = f"--{name.replace('_', '-')}"
        parser.add_argument(option, action=argparse.BooleanOptionalAction, default=None, help=told)
    locomotion.add_options(parser)


def apply(arguments: argparse.Namespace, source: ActionFile, ob: bpy.types.Object) -> None:
    """Let a character play as it was asked for; what was not asked for stays as its file says.

    Raises:
        MotionError: See `locomotion.apply`.
    """
    jiggles.welcome(ob)
    own = of_rig(ob)
    for name, (_, setting) in _SWITCHES.items():
        wanted = getattr(arguments, name)
        if wanted is not None and setting:
            setattr(own, setting, wanted)
    if arguments.jiggles is not None:
        own.jiggles.enabled = arguments.jiggles
    locomotion.apply(arguments, source, ob)
