"""Contexts, movement modes and targets in plain words, for whoever looks at a channel."""

from ..character.morphology import Capability
from .channels import Channel, TargetKind
from .context import Context, Depth, Extent, Height, LimbModifier, Side, Space
from .movement import PositionMode, RotationMode, ScaleMode

_NOUNS = {
    Capability.ROOT: ("root", "roots"),
    Capability.SPINE: ("spine segment", "spine segments"),
    Capability.NECK: ("neck segment", "neck segments"),
    Capability.HEAD: ("head", "heads"),
    Capability.MOUTH: ("mouth", "mouths"),
    Capability.EYE: ("eye", "eyes"),
    Capability.EAR: ("ear", "ears"),
    Capability.GRASPER: ("grasper", "graspers"),
    Capability.FOOT: ("foot", "feet"),
    Capability.LIMB: ("limb segment", "limb segments"),
    Capability.TAIL: ("tail segment", "tail segments"),
    Capability.WING: ("wing segment", "wing segments"),
    Capability.FIN: ("fin segment", "fin segments"),
    Capability.FINGER: ("finger segment", "finger segments"),
}
_DEPTHS = {Depth.FRONT: "front", Depth.CENTER: "middle", Depth.BACK: "rear"}
_HEIGHTS = {Height.TOP: "upper", Height.CENTER: "mid-height", Height.BOTTOM: "lower"}
_SIDES = {Side.LEFT: "on the left", Side.CENTER: "in the middle", Side.RIGHT: "on the right"}
_EXTENTS = {
    Extent.FRONT_MOST: "foremost",
    Extent.BACK_MOST: "rearmost",
    Extent.LEFT_MOST: "leftmost",
    Extent.RIGHT_MOST: "rightmost",
    Extent.TOP_MOST: "topmost",
    Extent.BOTTOM_MOST: "lowest",
}
_SCALES = {
    ScaleMode.NONE: "in meters",
    ScaleMode.CREATURE_SIZE: "scaled by the character's size",
    ScaleMode.LIMB_LENGTH: "scaled by limb length",
}
_SETTINGS_OF_POSITIONS = ("position", "scale", "ground_relative", "sagittal_relative", "secondary_relative")


def context_in_words(context: Context) -> str:
    """Return what a context selects: "the front graspers on the left"."""
    one, many = _NOUNS[context.capability]
    where = [_DEPTHS.get(context.depth, ""), _HEIGHTS.get(context.height, "")]
    side = _SIDES.get(context.side, "")

    def phrase(*words: str) -> str:
        return " ".join(word for word in ("the", *words) if word)

    found = phrase(*where, many, side)
    if context.extent is not Extent.NONE:
        narrowed = any((*where, side))
        farthest = _EXTENTS[context.extent]
        found = f"{phrase(farthest)} of {found}" if narrowed else phrase(farthest, one)
    if context.modifier is LimbModifier.SPINE_SEGMENT:
        found = f"{phrase(_NOUNS[Capability.SPINE][1])} that carry {found}"
    spaces = (
        (context.depth, context.depth_space, "front to back"),
        (context.height, context.height_space, "top to bottom"),
        (context.side, context.side_space, "left to right"),
    )
    among = [way for zone, space, way in spaces if zone.value != "any" and space is Space.SETSPACE]
    return f"{found}, counted {' and '.join(among)} among the {many}" if among else found


def movement_in_words(channel: Channel) -> str:
    """Return what matters about a channel: "Position from rest, scaled by limb length; z 1 is the ground"."""
    parts = [*_positions(channel), *_rotations(channel)]
    text = "; ".join(parts) or "neither position nor rotation"
    return text[0].upper() + text[1:]


def _positions(channel: Channel) -> list[str]:
    mode = channel.movement
    if not channel.poses_position:
        return []
    scale = _SCALES[mode.scale]
    if mode.secondary_relative and mode.directional_only:
        first = [f"position from rest, turned toward the target, {scale}"]
    elif mode.secondary_relative:
        first = [f"position toward the target, x 0 at rest and 1 at the target, y and z {scale}"]
    elif mode.position is PositionMode.ABSOLUTE:
        limb = mode.scale is ScaleMode.LIMB_LENGTH
        first = [f"position from {'where the limb begins' if limb else 'the ground under the root'}, {scale}"]
    else:
        first = [f"position from rest, {scale}"]
    if mode.sagittal_relative and not mode.secondary_relative:
        first.append("x 1 is the plane of symmetry")
    if mode.ground_relative:
        first.append("z 1 is the ground")
    return first


def _rotations(channel: Channel) -> list[str]:
    if not channel.poses_rotation:
        return []
    absolute = channel.movement.rotation is RotationMode.ABSOLUTE
    found = "rotation as the character stands" if absolute else "rotation from rest"
    return [f"{found}, added to looking at the target" if channel.movement.look_at else found]


def target_in_words(channel: Channel) -> str:
    """Return what a channel moves relative to: "nothing", "the nearest of the mouths", "its own target object"."""
    if channel.target is TargetKind.EXTERNAL:
        return "an object or bone, chosen for each character"
    if channel.target is TargetKind.CONTEXT and channel.secondary is not None:
        return f"for each body the nearest of {context_in_words(channel.secondary)}"
    return "nothing"


def caveats(channel: Channel) -> tuple[str, ...]:
    """Return what an animator should know about the modes that a channel has."""
    mode, out = channel.movement, list[str]()
    absolute_place = mode.position is PositionMode.ABSOLUTE and not mode.secondary_relative
    if channel.poses_position and absolute_place:
        out.append("An absolute position is the same place on all; the rest pose of one is not that of the others")
    if channel.poses_rotation and mode.rotation is RotationMode.ABSOLUTE:
        out.append("An absolute rotation is the same on all; the rest pose of one is not that of the others")
    if channel.poses_rotation and mode.look_at:
        out.append("No rotation means looking at the target, not the rest pose; a target behind is not looked at")
    return tuple(out)


def without_effect(channel: Channel) -> frozenset[str]:
    """Return the settings of a channel's movement, by name, that change nothing as the others are."""
    mode, out = channel.movement, set[str]()
    if channel.target is TargetKind.NONE:
        out |= {"secondary_relative", "directional_only", "look_at"}
    elif not mode.secondary_relative:
        out.add("directional_only")
    else:
        out |= {"position", "sagittal_relative"}
    if not channel.poses_position:
        out |= {*_SETTINGS_OF_POSITIONS, "directional_only"}
    if not channel.poses_rotation:
        out |= {"rotation", "look_at"}
    return frozenset(out)
