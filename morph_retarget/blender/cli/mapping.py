"""``map RIG``: tell what a rig is."""

import argparse
import json

from ...core.arrays import Array
from ...core.character import map_file
from ...core.character.analysis import Overrides
from ...core.character.character import Character
from ...core.character.frame import WORLD_AXES
from ...core.errors import listed
from .. import actions, retarget, rig, sampling
from .messages import naming, say
from .opening import add_rig_options, axes, open_rig


def add_to(parser: argparse.ArgumentParser) -> None:
    """Describe the command to ``parser``."""
    parser.add_argument(
        "rig", metavar="RIG", help="file (.bvh .fbx .glb .gltf .vrm .blend), or armature in the open file"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_rig_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print what the rig is."""
    ob, label = open_rig(arguments.rig, arguments.armature)
    with naming(label):
        own = rig.read(ob)
        found = retarget.character_of(own, Overrides(*axes(arguments)), _own_clip(own))
    if arguments.json:
        print(json.dumps(map_file.describe(ob.name, found), indent=1, ensure_ascii=False))
    else:
        print(_readable(ob.name, found))
    for warning in (*own.warnings, *found.warnings):
        say(f"warning: {ob.name}: {warning}")
    return 0


def _own_clip(own: rig.Rig) -> sampling.Clip | None:
    """Return the motion that a rig came with, for rigs whose rest is no pose; None without one."""
    action, slot = actions.assigned(own.object)
    if action is None or slot is None or actions.frame_range(actions.curves(action, slot).values()) is None:
        return None
    return retarget.run(sampling.sample(own, action, slot, rig.scene_of()))


def _readable(name: str, found: Character) -> str:
    frame, names = found.frame, found.skeleton.names
    kind = "humanoid" if found.humanoid else "creature"
    lines = [
        f"{name}: {len(found.skeleton)} bones, {kind}, {frame.height:.3g} m high",
        f"up {_axis_name(frame.up)}, forward {_axis_name(frame.forward)}",
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
