"""Which bones of an armature something poses already, so that they must not jiggle."""

from collections.abc import Collection, Iterable

import bpy
import numpy as np

from . import actions
from .actions import CurveMap
from .channels import Channel
from .rig import Rig, armature_of, pose_of

STILL = 1e-5
"""A curve whose keys differ by no more than this holds a pose and moves nothing: importers key every bone."""


def posed(rig: Rig, found: CurveMap) -> set[int]:
    """Return the bones that curves move, or that constraints and drivers own."""
    return _owned(rig, {path for (path, _), curve in found.items() if _moves(curve)})


def posed_by(rig: Rig, motion: Iterable[Channel]) -> set[int]:
    """Return the bones that a motion will move when it is keyed, or that constraints and drivers own."""
    moving = [channel for channel in motion if np.ptp(channel.values, axis=0).max(initial=0.0) > STILL]
    return _owned(rig, {channel.path(rig.object) for channel in moving})


def _owned(rig: Rig, paths: Iterable[str]) -> set[int]:
    """Return the bones that properties at some data paths belong to, or that constraints and drivers own."""
    moved = {path.rpartition(".")[0] for path in (*paths, *_driven(rig.object))}
    bones = pose_of(rig.object).bones
    return {
        i
        for i, name in enumerate(rig.skeleton.names)
        if bones[name].path_from_id() in moved or any(c.enabled and c.influence > 0.0 for c in bones[name].constraints)
    }


def _driven(ob: bpy.types.Object) -> Collection[str]:
    """Return the data paths of an armature that drivers own."""
    data = [owner.animation_data for owner in (ob, armature_of(ob))]
    return {curve.data_path for one in data if one is not None for curve in one.drivers}


def _moves(curve: bpy.types.FCurve) -> bool:
    if len(curve.modifiers) > 0 or len(curve.sampled_points) > 0:
        return True
    keys = np.empty(len(curve.keyframe_points) * 2, dtype=np.float32)
    curve.keyframe_points.foreach_get("co", keys)
    return bool(np.ptp(keys[1::2]) > STILL) if len(keys) > 2 else False


def curves_of(ob: bpy.types.Object) -> CurveMap:
    """Return the F-curves that act on an armature's own properties, without its NLA strips."""
    action, slot = actions.assigned(ob)
    return actions.curves(action, slot) if action is not None and slot is not None else {}
