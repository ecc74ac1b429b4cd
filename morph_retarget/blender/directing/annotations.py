"""What actions keep of their annotations: of what they are an example, and what is known of them (Grünvogel 2003 §5.4).

Times are frames of the action. When feet touch down is told by pose markers, which an animator drags: "strike left",
"strike right", or "strike" and the bone of a foot where there are more than two.
"""

from typing import Any

import bpy
from bpy.props import BoolProperty, CollectionProperty, EnumProperty, FloatProperty, PointerProperty, StringProperty

from ...core.clips.motions.annotations import Annotations, Phase, Strike, Strokes
from ...core.directing import starter
from ...core.errors import MotionError, listed
from ..declaring import proposed
from ..precision import plain

STRIKE = "strike"
"""The first word of a marker that tells of one."""
STROKES = ("ready", "stroke_start", "stroke", "stroke_end", "relax")
"""The times of a gesture, in order."""
SIDES = ("left", "right")
NEITHER = "none"

_PHASES: Any = [
    (Phase.WHOLE.value, "Whole", "All of the motion"),
    (Phase.START.value, "Start", "From standing into the loop"),
    (Phase.LOOP.value, "Loop", "What is repeated"),
    (Phase.STOP.value, "Stop", "From the loop back to standing"),
]
_SIDES: Any = [
    (NEITHER, "None", "It is done with the whole body"),
    (SIDES[0], "Left", "It is done with the left side"),
    (SIDES[1], "Right", "It is done with the right side"),
]
_SETTING: Any = {"options": set()}


def _kinds(_: object, __: bpy.types.Context, text: str) -> list[str]:
    """Return the kinds of motions that are proposed while one is typed."""
    return proposed(starter.kinds_of_starter(), text)


def _time(name: str, description: str) -> Any:
    return FloatProperty(name=name, description=description, step=100, precision=1, **_SETTING)


class MORPHRETARGET_PG_place(bpy.types.PropertyGroup):
    """Where a motion is among others of its kind, in one respect; `name` is the respect."""

    value: FloatProperty(name="Value", description="Such as how high a jump is, or where a reach goes", **_SETTING)


class MORPHRETARGET_PG_annotations(bpy.types.PropertyGroup):
    """What is known of an action as a base motion."""

    kind: StringProperty(
        name="Kind",
        description="What it is an example of, such as walk or wave: commands name it so. Empty for an action that "
        "is no base motion",
        search=_kinds,
        **_SETTING,
    )
    style: StringProperty(
        name="Style", description="How it is done, such as happy; empty for the usual way", **_SETTING
    )
    phase: EnumProperty(name="Phase", description="Which part of the motion it is", items=_PHASES, **_SETTING)
    cycle: BoolProperty(
        name="Cycle", description="It can be repeated without a seam: its last frame shows its first again", **_SETTING
    )
    side: EnumProperty(name="Side", description="Which side of the body it is done with", items=_SIDES, **_SETTING)
    speed: FloatProperty(
        name="Speed", description="Mean way over the ground in a second", min=0.0, unit="VELOCITY", **_SETTING
    )
    turn_rate: FloatProperty(
        name="Turn Rate", description="Angle by which it turns to its left in a second", subtype="ANGLE", **_SETTING
    )
    direction: FloatProperty(
        name="Direction",
        description="Where it goes as it sees it: ahead at 0, to its left at 90°, backward at 180°",
        subtype="ANGLE",
        **_SETTING,
    )
    is_gesture: BoolProperty(name="Gesture", description="It has a stroke, of which the times are known", **_SETTING)
    ready: _time("Ready", "Frame at which the limbs leave where they rest")
    stroke_start: _time("Stroke Start", "Frame at which the gesture proper begins")
    stroke: _time("Stroke", "Frame of its peak")
    stroke_end: _time("Stroke End", "Frame at which the gesture proper ends")
    relax: _time("Relax", "Frame at which the limbs are back where they rest")
    parts: StringProperty(
        name="Parts",
        description="Parts of the body that matter, with commas between them, such as left arm, head; "
        "empty for all of it",
        **_SETTING,
    )
    places: CollectionProperty(
        type=MORPHRETARGET_PG_place,
        name="Parameters",
        description="Where it is among other motions of its kind: speed, height and so on",
    )

    @property
    def is_annotated(self) -> bool:
        """Whether the action is a base motion."""
        return bool(self.kind.strip())

    def clear(self) -> None:
        """Forget all that is known."""
        self.places.clear()
        for prop in self.bl_rna.properties:
            if prop.identifier not in {"rna_type", "name", "places"}:
                self.property_unset(prop.identifier)


def of_action(action: bpy.types.Action) -> MORPHRETARGET_PG_annotations:
    """Return what is known of an action as a base motion."""
    return action.morph_retarget.annotations  # type: ignore[attr-defined]


class Annotated:
    """What an action has for its annotations; part of the group on actions."""

    annotations: PointerProperty(
        type=MORPHRETARGET_PG_annotations,
        name="Annotations",
        description="What is known of this action as a base motion for directing",
    )


# --- as the core takes them ---


def read(action: bpy.types.Action, feet: list[str], first: float, rate: float) -> Annotations:
    """Return what is known of an action.

    Args:
        action: Its kind is given.
        feet: Names of the bones that are feet, in order.
        first: Frame of the action at which the clip begins.
        rate: Frames of clips for each frame of the action.

    Raises:
        MotionError: Something makes no sense.
    """
    own = of_action(action)

    def frame(at: float) -> float:
        return (plain(at) - first) * rate

    try:
        return Annotations(
            kind=own.kind.strip(),
            style=own.style.strip(),
            cycle=own.cycle,
            strikes=tuple(Strike(foot, frame(at)) for foot, at in strikes_of(action, feet)),
            speed=plain(own.speed),
            turn_rate=plain(own.turn_rate),
            direction=plain(own.direction),
            phase=own.phase,
            strokes=Strokes(*(frame(getattr(own, name)) for name in STROKES)) if own.is_gesture else None,
            side="" if own.side == NEITHER else own.side,
            parts=tuple(part.strip() for part in own.parts.split(",") if part.strip()),
            parameters={place.name: plain(place.value) for place in own.places},
        )
    except MotionError as error:
        raise MotionError(f"action {action.name!r}: {error}") from error


def write(action: bpy.types.Action, told: Annotations, feet: list[str], first: float, rate: float) -> None:
    """Let an action keep what is known of it, in place of what it has kept; see `read`."""
    own = of_action(action)
    own.clear()
    own.kind, own.style, own.phase, own.cycle = told.kind, told.style, str(told.phase), told.cycle
    own.side = told.side or NEITHER
    own.speed, own.turn_rate, own.direction = told.speed, told.turn_rate, told.direction
    own.parts = ", ".join(told.parts)
    if told.strokes is not None:
        own.is_gesture = True
        for name in STROKES:
            setattr(own, name, first + getattr(told.strokes, name) / rate)
    for name, value in told.parameters.items():
        place = own.places.add()
        place.name, place.value = name, value
    clear_strikes(action)
    for strike in told.strikes:
        marker = action.pose_markers.new(strike_name(feet, strike.foot))
        marker.frame = round(first + strike.frame / rate)


# --- strikes ---


def strike_name(feet: list[str], foot: int) -> str:
    """Return the name of the marker of a foot that touches down."""
    return f"{STRIKE} {SIDES[foot] if len(feet) == len(SIDES) else feet[foot]}"


def strikes_of(action: bpy.types.Action, feet: list[str]) -> list[tuple[int, float]]:
    """Return which feet touch down and at which frames of an action, in order of time.

    Raises:
        MotionError: A marker names no foot.
    """
    out = [(_foot(marker.name, feet), float(marker.frame)) for marker in action.pose_markers if is_strike(marker.name)]
    return sorted(out, key=lambda pair: (pair[1], pair[0]))


def is_strike(name: str) -> bool:
    """Return whether the name of a marker tells of a foot that touches down."""
    return name.lower().split(maxsplit=1)[:1] == [STRIKE]


def clear_strikes(action: bpy.types.Action) -> None:
    """Remove all markers that tell of feet."""
    for marker in [marker for marker in action.pose_markers if is_strike(marker.name)]:
        action.pose_markers.remove(marker)


def _foot(name: str, feet: list[str]) -> int:
    _, _, which = name.strip().partition(" ")
    which = which.strip()
    if which in feet:
        return feet.index(which)
    if len(feet) == len(SIDES) and which.lower() in SIDES:
        return SIDES.index(which.lower())
    choices = [strike_name(feet, foot) for foot in range(len(feet))]
    raise MotionError(
        f"marker {name!r} names no foot: call it one of {listed(choices) or 'nothing, there are no feet'}"
    )


CLASSES = (MORPHRETARGET_PG_place, MORPHRETARGET_PG_annotations)
