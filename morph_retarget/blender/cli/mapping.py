"""``map RIG``: tell what a rig is."""

import argparse
import json
from dataclasses import replace

from ...core.arrays import Array
from ...core.character import families, map_file
from ...core.character.analysis import Overrides
from ...core.character.bone_maps import pair_maps, rokoko
from ...core.character.bone_maps.placing import Placed
from ...core.character.character import Character
from ...core.character.frame import WORLD_AXES
from ...core.errors import MappingError, listed
from .. import actions, bone_maps, retarget, rig, sampling
from .messages import naming, say
from .opening import add_rig_options, axes, open_rig

FORMS = ("joints", "keemap", "rokoko")
"""Bone maps that are written."""


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument(
        "rig", metavar="RIG", help="file (.bvh .fbx .glb .gltf .vrm .blend), or armature in the open file"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--map", metavar="FILE", help="bone map, as retarget --map reads it: what it says counts")
    parser.add_argument("--form", choices=FORMS, help="print the joints alone, as a bone map for a tool")
    parser.add_argument("--source", metavar="RIG", help="the other rig of maps that pair two: the one that moves")
    add_rig_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print what the rig is."""
    given = None if arguments.map is None else bone_maps.find(arguments.map)
    source = None if arguments.source is None else _source(arguments)
    ob, label = open_rig(arguments.rig, arguments.armature)
    with naming(label):
        own = rig.read(ob)
        overrides = Overrides(*axes(arguments))
        placed = bone_maps.place(given, own, overrides, source and source[1])
        if placed.left_out:
            say(f"warning: bone map for {ob.name!r}: {placed.told()}")
        found = retarget.character_of(own, replace(overrides, joints=placed.joints), _own_clip(own))
    if arguments.form is not None:
        print(_written(arguments.form, found, placed, ob.name, source), end="")
    elif arguments.json:
        print(json.dumps(map_file.describe(ob.name, found), indent=1, ensure_ascii=False))
    else:
        print(_readable(ob.name, found))
    for warning in (*own.warnings, *found.warnings):
        say(f"warning: {ob.name}: {warning}")
    return 0


def _source(arguments: argparse.Namespace) -> tuple[str, Character]:
    """Return the name of the rig that moves, and what it is."""
    ob, label = open_rig(arguments.source, None)
    with naming(label):
        own = rig.read(ob)
        return ob.name, retarget.character_of(own, None, _own_clip(own))


def _written(form: str, found: Character, placed: Placed, name: str, source: tuple[str, Character] | None) -> str:
    """Return joints as a bone map.

    Raises:
        MappingError: The map pairs two rigs, and the other one was not named.
    """
    joints = {joint: match.bone for joint, match in found.joints.items()}
    if form == "joints":
        return map_file.preset(joints, placed.controls, placed.reaches)
    if form == "rokoko":
        return rokoko.write(joints)
    if source is None:
        raise MappingError("a KeeMap map pairs two rigs: name the other one with --source")
    theirs = {joint: match.bone for joint, match in source[1].joints.items()}
    return pair_maps.write_keemap(pair_maps.paired(theirs, joints), source[0], name)


def _own_clip(own: rig.Rig) -> sampling.Clip | None:
    """Return the motion that a rig came with, for rigs whose rest is no pose; None without one."""
    action, slot = actions.assigned(own.object)
    if action is None or slot is None or actions.frame_range(actions.curves(action, slot).values()) is None:
        return None
    return retarget.run(sampling.sample(own, action, slot, rig.scene_of()))


def _readable(name: str, found: Character) -> str:
    frame, names = found.frame, found.skeleton.names
    kind = "humanoid" if found.humanoid else "creature"
    known = ", ".join(fit.family.name for fit in families.fitting(names))
    lines = [
        f"{name}: {len(found.skeleton)} bones, {kind}, {frame.height:.3g} m high",
        f"up {_axis_name(frame.up)}, forward {_axis_name(frame.forward)}",
        *([f"named as {known}"] if known else []),
        "",
    ]
    width = max((len(j) for j in found.joints), default=0)
    bones = max((len(m.bone) for m in found.joints.values()), default=0)
    lines += [f"  {j:{width}}  {m.bone:{bones}}  {m.confidence:4.0%}  {m.by}" for j, m in found.joints.items()]
    for leg in found.legs:
        side = {1: "left", -1: "right"}.get(leg.side, "middle")
        lines.append(f"  leg, {side}, row {leg.row + 1}: " + " > ".join(names[b] for b in leg.bones))
    lines += ["", "capabilities"]
    lines += [f"  {bone}: {', '.join(c.value for c in tags)}" for bone, tags in found.capabilities.items()]
    if found.unmapped:
        lines += ["", f"neither joint nor capability: {listed(found.unmapped, 40)}"]
    return "\n".join(lines)


def _axis_name(vector: Array) -> str:
    return max(WORLD_AXES, key=lambda name: float(WORLD_AXES[name] @ vector))
