"""Channel definitions between Blender's properties and the core's plain data."""

import json
from collections.abc import Mapping
from dataclasses import asdict, fields

import bpy

from ...core.character.morphology import Capability
from ...core.errors import MotionError
from ...core.morph.bind import GeneralizedAction
from ...core.morph.branch import Answer, Branch
from ...core.morph.channels import Channel, MirrorRule, SideConstraint, TargetKind
from ...core.morph.context import Context, Depth, Extent, Height, LimbModifier, Side, Space
from ...core.morph.movement import Movement, PositionMode, RotationMode, ScaleMode
from .. import migrations
from .properties import MORPHRETARGET_PG_channel, MORPHRETARGET_PG_context, of_action

_FLAGS = ("ground_relative", "sagittal_relative", "secondary_relative", "directional_only", "look_at")


def is_generalized(action: bpy.types.Action | None) -> bool:
    """Return whether an action has channels, or was made to have some and plays on characters that only walk."""
    return action is not None and (len(of_action(action).channels) > 0 or of_action(action).version > 0)


def read(action: bpy.types.Action) -> GeneralizedAction:
    """Return what an action defines.

    Raises:
        MotionError: A newer version made it, or a setting has a value that this version does not know.
    """
    _check(action)
    own = of_action(action)
    return GeneralizedAction(action.name, tuple(channel(item) for item in own.channels), _branch(action))


def read_known(action: bpy.types.Action) -> tuple[GeneralizedAction, Mapping[int, str]]:
    """Return what an action defines, and why some of its channels, by number, cannot play; these pose nothing.

    Raises:
        MotionError: A newer version made it, or a predicate has a value that this version does not know.
    """
    _check(action)
    found: list[Channel] = []
    unknown: dict[int, str] = {}
    for i, item in enumerate(of_action(action).channels):
        try:
            found.append(channel(item))
        except MotionError as error:
            unknown[i] = str(error)
            nothing = Context(Capability.ROOT)
            found.append(Channel(item.name, nothing, poses_position=False, poses_rotation=False))
    return GeneralizedAction(action.name, tuple(found), _branch(action)), unknown


def _check(action: bpy.types.Action) -> None:
    if of_action(action).version > migrations.VERSION:
        raise MotionError(
            f"action {action.name!r} was made by a newer version of Morph Retarget: update the extension to play it"
        )


def _branch(action: bpy.types.Action) -> Branch:
    own = of_action(action)
    try:
        return Branch(
            upright_spine=Answer(own.upright_spine),
            has_graspers=Answer(own.has_graspers),
            has_feet=Answer(own.has_feet),
            has_mouth=Answer(own.has_mouth),
            has_tail=Answer(own.has_tail),
            has_wings=Answer(own.has_wings),
            leg_count=None if own.leg_count < 0 else own.leg_count,
        )
    except ValueError as error:
        raise MotionError(
            f"action {action.name!r} has a predicate that this version does not know ({error}): choose it again"
        ) from error


def channel(item: MORPHRETARGET_PG_channel) -> Channel:
    """Return a channel.

    Raises:
        MotionError: A setting has a value that this version does not know.
    """
    try:
        return Channel(
            name=item.name,
            context=context(item.context),
            movement=movement(item),
            target=TargetKind(item.target),
            secondary=context(item.secondary) if item.target == TargetKind.CONTEXT else None,
            poses_position=item.poses_position,
            poses_rotation=item.poses_rotation,
            position_weight=item.position_weight,
            rotation_weight=item.rotation_weight,
            priority=item.priority,
            blend_group=item.blend_group,
            varies=item.varies,
            variant_group=item.variant_group,
            side=SideConstraint(item.variant_side),
            mirror=MirrorRule(item.mirror),
        )
    except ValueError as error:
        raise MotionError(
            f"channel {item.name!r} has a setting that this version does not know ({error}): choose it again"
        ) from error


def context(item: MORPHRETARGET_PG_context) -> Context:
    """Return a context."""
    return Context(
        capability=Capability(item.capability),
        depth=Depth(item.depth),
        side=Side(item.side),
        height=Height(item.height),
        depth_space=Space(item.depth_space),
        side_space=Space(item.side_space),
        height_space=Space(item.height_space),
        extent=Extent(item.extent),
        modifier=LimbModifier(item.modifier),
    )


def movement(item: MORPHRETARGET_PG_channel) -> Movement:
    """Return the movement modes of a channel; those that lean on a target are off while it has none."""
    aimed = item.target != TargetKind.NONE
    return Movement(
        position=PositionMode(item.position),
        rotation=RotationMode(item.rotation),
        scale=ScaleMode(item.scale),
        ground_relative=item.ground_relative,
        sagittal_relative=item.sagittal_relative,
        secondary_relative=item.secondary_relative and aimed,
        directional_only=item.directional_only,
        look_at=item.look_at and aimed,
    )


def make(action: bpy.types.Action) -> None:
    """Make an action a generalized one that has no channels yet."""
    of_action(action).version = migrations.VERSION


def add(action: bpy.types.Action, wanted: Channel) -> MORPHRETARGET_PG_channel:
    """Give an action a channel and return its definition."""
    make(action)
    item = of_action(action).channels.add()
    item.keyed_in = to_text(wanted.movement, wanted.target)
    for name in ("position", "rotation", "scale"):
        setattr(item, name, getattr(wanted.movement, name).value)
    for name in _FLAGS:
        setattr(item, name, getattr(wanted.movement, name))
    _write_context(item.context, wanted.context)
    if wanted.secondary is not None:
        _write_context(item.secondary, wanted.secondary)
    item.target = wanted.target.value
    item.variant_side, item.mirror = wanted.side.value, wanted.mirror.value
    for name in ("poses_position", "poses_rotation", "position_weight", "rotation_weight", "priority"):
        setattr(item, name, getattr(wanted, name))
    for name in ("blend_group", "varies", "variant_group"):
        setattr(item, name, getattr(wanted, name))
    item.name = wanted.name
    return item


def _write_context(item: MORPHRETARGET_PG_context, wanted: Context) -> None:
    for own in fields(wanted):
        setattr(item, own.name, getattr(wanted, own.name).value)


def to_text(modes: Movement, target: TargetKind) -> str:
    """Return what a channel's values are relative to as text, for remembering what keys were made in."""
    return json.dumps(asdict(modes) | {"target": target})


def from_text(text: str) -> tuple[Movement, TargetKind]:
    """Return what `to_text` wrote; the usual modes for an empty text."""
    found = json.loads(text) if text else {}
    target = TargetKind(found.pop("target", TargetKind.NONE))
    kinds = {"position": PositionMode, "rotation": RotationMode, "scale": ScaleMode}
    modes = {name: kinds[name](value) if name in kinds else value for name, value in found.items()}
    return Movement(**modes), target
