"""Locomotion for the command line: characters that go over the ground, with an action or without."""

import argparse
from dataclasses import dataclass
from math import radians

import bpy

from ...core.errors import MotionError, listed
from ...core.locomotion.patterns.styles import STYLES
from ...core.morph.bind import GeneralizedAction
from .. import rig
from ..locomotion.properties import FASTEST, Source
from ..morph import definitions
from ..properties import of_rig
from . import numbers
from .action_file import ActionFile

NO_ACTION = "-"
"""What is asked for in place of an action by who only wants to see a character go."""
NAME = "Locomotion"


@dataclass(frozen=True)
class NoAction(ActionFile):
    """In place of a file with an action: one without channels, made anew in each file that is opened."""

    def bring(self) -> bpy.types.Action:
        """Return the action in the open file."""
        action = bpy.data.actions.get(self.name)
        if action is None or not definitions.is_generalized(action) or len(definitions.read(action).channels):
            action = bpy.data.actions.new(self.name)
            action.use_fake_user = True
            definitions.make(action)
        return action


def no_action() -> NoAction:
    """Return what plays nothing but locomotion."""
    render = rig.scene_of().render
    return NoAction(None, NAME, GeneralizedAction(NAME, ()), render.fps / render.fps_base)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of locomotion."""
    parser.add_argument(
        "--gait",
        action="append",
        default=[],
        type=_layer,
        metavar="STYLE[:WEIGHT]",
        help="let the characters go over the ground in a style; given several times, styles are mixed: "
        + listed(STYLES, 99),
    )
    parser.add_argument("--speed", type=_speed, metavar="V", help="way over the ground in a second [m] (default: 1.2)")
    parser.add_argument("--turn-rate", type=_rate, metavar="W", help="turn to the left in a second [degrees]")
    parser.add_argument("--path", metavar="OBJECT", help="curve to go along, of the character's or the action's file")
    parser.add_argument("--ground", metavar="OBJECT", help="mesh to go on, of the character's or the action's file")


def _layer(text: str) -> tuple[str, float]:
    style, sign, weight = text.partition(":")
    if style not in STYLES:
        raise argparse.ArgumentTypeError(f"there is no gait {style!r}: choose one of {listed(STYLES, 99)}")
    if not sign:
        return style, 1.0
    return style, numbers.within(weight, 0.001, 1000.0)


def _speed(text: str) -> float:
    return numbers.within(text, -FASTEST, FASTEST)


def _rate(text: str) -> float:
    return radians(numbers.within(text, -3600.0, 3600.0))


def wanted(arguments: argparse.Namespace) -> bool:
    """Return whether characters shall go over the ground, besides those whose files say so."""
    given = (arguments.speed, arguments.turn_rate, arguments.path, arguments.ground)
    return arguments.action == NO_ACTION or bool(arguments.gait) or any(value is not None for value in given)


def apply(arguments: argparse.Namespace, source: ActionFile, ob: bpy.types.Object) -> None:
    """Let a character go as it was asked for; what was not asked for stays as its file says.

    Raises:
        MotionError: The path or the ground is not there, or cannot be one.
    """
    own = of_rig(ob).gait
    if not wanted(arguments):
        return
    own.enabled = True
    if arguments.gait:
        (own.style, first), *others = arguments.gait
        own.layers.clear()
        for style, weight in others:
            own.add(style).weight = weight / first
    if arguments.speed is not None:
        own.speed = arguments.speed
    if arguments.turn_rate is not None:
        own.turn_rate = arguments.turn_rate
    if arguments.path is not None:
        own.path, own.source = _object(source, "--path", arguments.path, "CURVE"), Source.PATH.value
    elif arguments.speed is not None or arguments.turn_rate is not None:
        own.source = own.source if own.source == Source.PATH else Source.SPEED.value
    if arguments.ground is not None:
        own.ground = _object(source, "--ground", arguments.ground, "MESH")


def _object(source: ActionFile, option: str, name: str, kind: str) -> bpy.types.Object:
    """Return an object of a kind by its name."""
    found = source.bring_object(name)
    if found is None or found.type != kind:
        fitting = listed([ob.name for ob in bpy.data.objects if ob.type == kind]) or "none: there is none"
        why = "there is no such object" if found is None else f"it is no {kind.lower()}"
        raise MotionError(f"{option} {name!r}: {why}: choose one of {fitting}")
    return found
