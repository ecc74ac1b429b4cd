"""Presets that come with the extension: the bones of common families of rigs, and which of them a rig belongs to.

Each is a joint map in ``presets``, in the form that `map_file` reads, with keys of its own: ``about`` says what rigs
have these bones, ``needs`` and ``lacks`` name further bones by which the family differs from others with the same
names, and ``prefix`` is what stands before all names and may be another in each rig.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ..errors import MappingError
from . import map_file
from .bone_names import BoneNames
from .joints import SIDES

FOLDER = Path(__file__).parent / "presets"
BODY = (
    "hips",
    "head",
    *(s + j for s in SIDES for j in ("UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot")),
)
"""Joints that every family has: a rig belongs to one only when it has the bones of all of them …"""
TRUNK = ("spine", "chest", "upperChest", "neck")
"""… and of those of them that the family has."""


@dataclass(frozen=True)
class Family:
    """Rigs whose bones are called alike."""

    name: str
    about: str
    """Which rigs these are, for people."""
    joints: Mapping[str, str]
    """Joint to bone."""
    prefix: str | None = None
    """What stands before all names and may differ from rig to rig; None where names are whole."""
    needs: tuple[str, ...] = ()
    """Further bones that all rigs of the family have …"""
    lacks: tuple[str, ...] = ()
    """… and that none has."""

    @property
    def path(self) -> Path:
        """Its file: a joint map as any other."""
        return FOLDER / f"{self.name}.json"


@dataclass(frozen=True)
class Fit:
    """A family that a rig belongs to."""

    family: Family
    joints: Mapping[str, str] = field(default_factory=dict[str, str])
    """Joint to the rig's own bone, of those joints of the family that the rig has."""

    @property
    def exact(self) -> int:
        """How many bones have the family's names to the letter."""
        return sum(self.family.joints[joint] == bone for joint, bone in self.joints.items())


@cache
def shipped() -> tuple[Family, ...]:
    """Return all families, in order of their names."""
    return tuple(_read(path) for path in sorted(FOLDER.glob("*.json")))


def named(name: str) -> Family:
    """Return the family of a name, whatever its case.

    Raises:
        MappingError: There is none.
    """
    found = next((family for family in shipped() if family.name.casefold() == name.casefold()), None)
    if found is None:
        raise MappingError(
            f"there is no preset {name!r}: choose one of {', '.join(family.name for family in shipped())}"
        )
    return found


def fitting(names: Sequence[str]) -> list[Fit]:
    """Return the families that a rig's bones fit, the one of which it has most bones first.

    Args:
        names: Of all bones.
    """
    own = BoneNames(names)
    found = [fit for family in shipped() if (fit := _fit(family, own)) is not None]
    return sorted(found, key=lambda fit: (-len(fit.joints) - len(fit.family.needs), -fit.exact))


def placed(family: Family, names: Sequence[str]) -> dict[str, str]:
    """Return the joints of a family whose bones a rig has, joint to bone, whether it belongs to the family or not.

    Args:
        family: The family.
        names: Of all bones of the rig.
    """
    own = BoneNames(names)
    tries = [_under(family, own, prefix) for prefix in _prefixes(family, own)]
    return max(tries, key=len) if tries else {}


def _fit(family: Family, own: BoneNames) -> Fit | None:
    for prefix in _prefixes(family, own):
        must = [family.joints[joint] for joint in (*BODY, *TRUNK) if joint in family.joints] + [*family.needs]
        whole = all(own.find(_swapped(family, bone, prefix)) for bone in must)
        if whole and not any(own.find(_swapped(family, bone, prefix)) for bone in family.lacks):
            return Fit(family, _under(family, own, prefix))
    return None


def _under(family: Family, own: BoneNames, prefix: str) -> dict[str, str]:
    """Return the joints of a family in a rig in which ``prefix`` stands before names."""
    found = {joint: own.find(_swapped(family, bone, prefix)) for joint, bone in family.joints.items()}
    return {joint: bone for joint, bone in found.items() if bone is not None}


def _prefixes(family: Family, own: BoneNames) -> list[str]:
    if family.prefix is None:
        return [""]
    return own.prefixes(family.joints["hips"].removeprefix(family.prefix))


def _swapped(family: Family, bone: str, prefix: str) -> str:
    return bone if family.prefix is None else prefix + bone.removeprefix(family.prefix)


def _read(path: Path) -> Family:
    text = path.read_text(encoding="utf-8")
    data: dict[str, Any] = json.loads(text)
    return Family(
        path.stem,
        data["about"],
        map_file.parse(text, path.name),
        data.get("prefix"),
        tuple(data.get("needs", ())),
        tuple(data.get("lacks", ())),
    )
