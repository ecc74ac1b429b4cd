"""The body of a library as data: its skeleton, and all that was found out about it.

What was found is kept and not found anew, so that a library keeps the order of its joints, feet and parts whatever
later versions find.
"""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from ...arrays import Array
from ...character.character import Character
from ...character.frame import CharacterFrame, Placement
from ...character.joints import JointMatch
from ...character.morphology import Capability, Limb, LimbKind
from ...skeleton import Skeleton
from ..character_model import CharacterModel

_PLAIN = ("head", "humanoid", "floor", "rest_is_pose", "plausibility")
"""What a character holds as plain values."""
_ARRAYS = ("parents", "rest_positions", "rest_rotations", "rest_tails")
"""What every skeleton has, and what some have."""
_SPARE = ("deform", "inherits")


def to_data(model: CharacterModel) -> tuple[dict[str, Any], dict[str, Array]]:
    """Return a body as plain data and arrays."""
    own, frame, placement = model.character, model.character.frame, model.character.placement
    plain: dict[str, Any] = {
        "root": model.root,
        "names": list(model.names),
        "joints": {joint: asdict(match) for joint, match in own.joints.items()},
        "capabilities": {bone: [one.value for one in found] for bone, found in own.capabilities.items()},
        "limbs": [asdict(limb) | {"kind": limb.kind.value} for limb in own.limbs],
        "spine": own.spine,
        "neck": own.neck,
        "tails": own.tails,
        "warnings": own.warnings,
        **{name: getattr(own, name) for name in _PLAIN},
        "frame": {one.name: np.asarray(getattr(frame, one.name)).tolist() for one in fields(frame)},
        "placement": {one.name: np.asarray(getattr(placement, one.name)).tolist() for one in fields(placement)},
    }
    there = (*_ARRAYS, *(name for name in _SPARE if getattr(own.skeleton, name) is not None))
    return plain, {name: getattr(own.skeleton, name) for name in there}


def from_data(plain: Mapping[str, Any], arrays: Mapping[str, Array]) -> CharacterModel:
    """Return a body from what `to_data` gave.

    Raises:
        KeyError: Something is missing.
        ValueError: The data contradict each other, or are of the wrong kind.
        TypeError: The same.
    """
    skeleton = _skeleton(plain["names"], arrays)
    count, frame, placement = len(skeleton), plain["frame"], plain["placement"]
    head = plain["head"]
    character = Character(
        skeleton=skeleton,
        placement=Placement(
            _floats(placement["rotation"], 3, 3), float(placement["scale"]), _floats(placement["translation"], 3)
        ),
        frame=CharacterFrame(
            _floats(frame["up"], 3), _floats(frame["forward"], 3), _floats(frame["origin"], 3), float(frame["height"])
        ),
        joints={joint: _match(match, skeleton) for joint, match in plain["joints"].items()},
        capabilities={bone: tuple(map(Capability, found)) for bone, found in plain["capabilities"].items()},
        limbs=tuple(_limb(limb, count) for limb in plain["limbs"]),
        spine=_bones(plain["spine"], count),
        neck=_bones(plain["neck"], count),
        tails=tuple(_bones(tail, count) for tail in plain["tails"]),
        head=None if head is None else _bones([head], count)[0],
        humanoid=bool(plain["humanoid"]),
        floor=float(plain["floor"]),
        rest_is_pose=bool(plain["rest_is_pose"]),
        plausibility=float(plain["plausibility"]),
        warnings=tuple(plain["warnings"]),
    )
    return CharacterModel(character, _bones([plain["root"]], count)[0])


def _skeleton(names: list[str], arrays: Mapping[str, Array]) -> Skeleton:
    count = len(names)
    parents = arrays["parents"].astype(np.intp)
    if parents.shape != (count,) or not ((parents >= -1) & (parents < np.arange(count))).all():
        raise ValueError("parents do not stand before their children")
    shapes = {"rest_positions": 3, "rest_rotations": 4, "rest_tails": 3}
    rest = {name: _floats(arrays[name], count, size) for name, size in shapes.items()}
    spare = {name: arrays[name].astype(np.bool_) for name in _SPARE if name in arrays}
    if any(flags.shape != (count,) for flags in spare.values()):
        raise ValueError("the skeleton's flags are not as many as its bones")
    return Skeleton(
        tuple(map(str, names)),
        parents,
        rest["rest_positions"],
        rest["rest_rotations"],
        rest["rest_tails"],
        spare.get("deform"),
        spare.get("inherits"),
    )


def _match(match: Mapping[str, Any], skeleton: Skeleton) -> JointMatch:
    if match["bone"] not in skeleton.index:
        raise ValueError(f"there is no bone {match['bone']!r}")
    return JointMatch(**match)


def _limb(limb: Mapping[str, Any], count: int) -> Limb:
    bones, digits = _bones(limb["bones"], count), _bones(limb["digits"], count)
    if not bones:
        raise ValueError("a limb has no bones")
    return Limb(LimbKind(limb["kind"]), int(limb["side"]), int(limb["row"]), bones, digits)


def _bones(values: list[Any], count: int) -> tuple[int, ...]:
    out = tuple(int(value) for value in values)
    if not all(0 <= bone < count for bone in out):
        raise ValueError(f"there are bones beyond the {count} of the skeleton")
    return out


def _floats(values: Any, *shape: int) -> Array:
    out = np.array(values, dtype=np.float64)
    if out.shape != shape or not np.isfinite(out).all():
        raise ValueError(f"an array of shape {out.shape} should hold {shape} finite numbers")
    return out
