"""Joint maps as data: what `map --json` prints, what presets hold, and what users write by hand.

Three forms are read: the output of ``map --json``, ``{"joints": {"hips": "Bone"}}``, and plain ``{"hips": "Bone"}``.
An empty bone says that the rig has no such joint. Nothing in a map is ever executed.
"""

import json
from collections.abc import Mapping
from typing import Any, cast

from ..errors import MappingError
from .character import Character
from .control_given import ENDS, FIELDS, Reaching, switch_of
from .joints import PARENTS

FORMAT = 1
"""Version of the form that presets are written in."""


def parse(text: str, origin: str) -> dict[str, str]:
    """Return the joints of a map, joint to bone.

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MappingError: It is no JSON, or no joint map.
    """
    out: dict[str, str] = {}
    for joint, entry in _entries(text, origin):
        if isinstance(entry, dict) and "bone" not in entry and any(name in entry for name in ("control", *FIELDS)):
            continue  # it says nothing of the bone
        bone: Any = cast("dict[str, Any]", entry).get("bone") if isinstance(entry, dict) else entry
        if bone is not None and not isinstance(bone, str):
            raise MappingError(f"{origin}: joint {joint} is mapped to {bone!r}: give the name of a bone")
        out[joint] = bone or ""
    return out


def parse_controls(text: str, origin: str) -> dict[str, str]:
    """Return the controls that a map names, joint to bone: ``{"hips": {"bone": "DEF-spine", "control": "torso"}}``.

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MappingError: It is no JSON, or no joint map.
    """
    out: dict[str, str] = {}
    for joint, entry in _entries(text, origin):
        control: Any = cast("dict[str, Any]", entry).get("control") if isinstance(entry, dict) else None
        if control is not None and not isinstance(control, str):
            raise MappingError(f"{origin}: joint {joint} has the control {control!r}: give the name of a bone")
        if control:
            out[joint] = control
    return out


def parse_reaches(text: str, origin: str) -> dict[str, Reaching]:
    """Return what a map says of how hands and feet are brought to places, by joint.

    ``{"leftHand": {"reach": "hand_ik.L", "pole": "elbow.L", "switch": "Properties['ik_left_arm'] = 1"}}``

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MappingError: It is no JSON, or no joint map; or that is said of another joint, or not in words.
    """
    out: dict[str, Reaching] = {}
    for joint, entry in _entries(text, origin):
        table: dict[str, Any] = cast("dict[str, Any]", entry) if isinstance(entry, dict) else {}
        said = {name: table[name] for name in FIELDS if name in table}
        for name, value in said.items():
            if joint not in ENDS:
                raise MappingError(f"{origin}: joint {joint} has a {name}, which only {', '.join(ENDS)} can have")
            if not isinstance(value, str):
                raise MappingError(f"{origin}: joint {joint} has the {name} {value!r}: give it as text")
        found = Reaching(*(str(said.get(name, "")) for name in FIELDS))
        if found.switch:
            switch_of(found.switch, joint)
        if found != Reaching():
            out[joint] = found
    return out


def plain(text: str, origin: str) -> object:
    """Return the plain data that a map is made of.

    Args:
        text: JSON.
        origin: Where it came from, for messages.

    Raises:
        MappingError: It is no JSON.
    """
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        raise MappingError(
            f"{origin}: line {error.lineno} is no JSON ({error.msg}): mend it or save the map again"
        ) from error
    except (ValueError, RecursionError) as error:  # numbers of very many digits, and brackets in brackets
        raise MappingError(f"{origin}: is no joint map: save the map again") from error


def _entries(text: str, origin: str) -> list[tuple[str, Any]]:
    """Return what a map says, joint by joint.

    Raises:
        MappingError: See `parse`.
    """
    data = plain(text, origin)
    table: Any = cast("dict[str, Any]", data).get("joints", data) if isinstance(data, dict) else None
    if not isinstance(table, dict):
        raise MappingError(f'{origin}: is no joint map: it should look like {{"joints": {{"hips": "Bone"}}}}')
    found = list(cast("dict[str, Any]", table).items())
    for joint, _ in found:
        if joint not in PARENTS:
            raise MappingError(
                f"{origin}: unknown joint {joint!r}: use VRM 1.0 names such as {', '.join(list(PARENTS)[:6])}"
            )
    return found


def preset(
    joints: Mapping[str, str],
    controls: Mapping[str, str] | None = None,
    reaches: Mapping[str, Reaching] | None = None,
) -> str:
    """Return joints and the controls that the user has named, by joint, as the text of a preset."""
    table: dict[str, object] = {}
    for joint, bone in joints.items():
        reach = (reaches or {}).get(joint, Reaching())
        said = zip(
            ("control", *FIELDS), ((controls or {}).get(joint), reach.control, reach.pole, reach.switch), strict=True
        )
        own = {name: value for name, value in said if value}
        table[joint] = {"bone": bone, **own} if own else bone
    return json.dumps({"format": FORMAT, "joints": table}, indent=2, ensure_ascii=False) + "\n"


def describe(name: str, character: Character) -> dict[str, Any]:
    """Return what a rig is as plain data: the output of ``map --json``."""
    frame = character.frame
    return {
        "rig": name,
        "bones": len(character.skeleton),
        "frame": {
            "up": _rounded(frame.up.tolist()),
            "forward": _rounded(frame.forward.tolist()),
            "height": round(frame.height, 4),
        },
        "joints": {
            joint: {"bone": m.bone, "confidence": m.confidence, "by": m.by} for joint, m in character.joints.items()
        },
        "capabilities": {bone: [c.value for c in found] for bone, found in character.capabilities.items()},
        "unmapped": character.unmapped,
    }


def _rounded(values: list[float]) -> list[float]:
    # Adding zero turns -0.0 into 0.0.
    return [round(v, 4) + 0.0 for v in values]
