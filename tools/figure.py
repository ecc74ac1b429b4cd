"""Bodies as plain data: bones with names and places, built from proportions. Samples and tests are made of it.

A figure stands at the origin of Blender's world, looks along -Y, and is as high as it says.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Bone:
    """One bone at rest."""

    name: str
    parent: str | None
    head: Point
    tail: Point


@dataclass(frozen=True)
class Proportions:
    """Lengths as shares of the body's height."""

    hips: float = 0.53
    knee: float = 0.28
    ankle: float = 0.047
    neck: float = 0.82
    head: float = 0.87
    hip_width: float = 0.052
    shoulder_width: float = 0.105
    upper_arm: float = 0.165
    lower_arm: float = 0.15
    hand: float = 0.05
    foot: float = 0.075


CHIBI = Proportions(
    hips=0.30,
    knee=0.165,
    ankle=0.045,
    neck=0.50,
    head=0.55,
    hip_width=0.085,
    shoulder_width=0.13,
    upper_arm=0.115,
    lower_arm=0.11,
    hand=0.06,
    foot=0.09,
)
"""A figure with a big head and short legs."""


@dataclass(frozen=True)
class Build:
    """Which bones a humanoid has."""

    spine: int = 3
    neck: int = 1
    clavicles: bool = True
    toes: bool = True
    fingers: int = 0
    """Digits a hand, thumb first, 0 to 5."""
    twists: int = 0
    """Twist bones along each upper and lower limb."""
    root: bool = False
    """A bone on the ground above the hips."""
    arms_down: float = 0.0
    """Angle of the arms below the horizontal [deg]: 0 for a T-pose."""


def vrm(joint: str) -> str:
    """Name bones as the joints are called."""
    return joint


def blender(joint: str) -> str:
    """Name bones in Blender's manner: ``UpperArm.L``."""
    for side in ("left", "right"):
        if joint.startswith(side):
            return f"{joint.removeprefix(side)}.{side[0].upper()}"
    return joint[0].upper() + joint[1:]


def spaced(joint: str) -> str:
    """Name bones in words: ``Bip01 L UpperArm``."""
    for side in ("left", "right"):
        if joint.startswith(side):
            return f"Bip01 {side[0].upper()} {joint.removeprefix(side)}"
    return f"Bip01 {joint[0].upper()}{joint[1:]}"


def humanoid(
    height: float = 1.75,
    proportions: Proportions | None = None,
    build: Build | None = None,
    names: Callable[[str], str] = vrm,
) -> list[Bone]:
    """Return the bones of a humanoid, parents first.

    Args:
        height: Ground to the top of the head [m].
        proportions: Of an adult when None.
        build: Which bones it has.
        names: Canonical joint to bone name; spare bones are called ``spineN``, ``neckN`` and ``…TwistN``.
    """
    p, b = proportions or Proportions(), build or Build()
    out: list[Bone] = []

    def add(joint: str, parent: str | None, head: Sequence[float], tail: Sequence[float]) -> str:
        scaled = [tuple(float(height * c) for c in point) for point in (head, tail)]
        out.append(Bone(names(joint), None if parent is None else names(parent), scaled[0], scaled[1]))
        return joint

    root = add("root", None, (0, 0, 0), (0, -0.1, 0)) if b.root else None
    rise = (p.neck - 0.04 - p.hips) / max(b.spine, 1)
    add("hips", root, (0, 0, p.hips), (0, 0, p.hips + 0.3 * rise))
    chest = "hips"
    for i, joint in enumerate(_spine_names(b.spine)):
        low = p.hips + (0.3 + i * (1 - 0.3 / max(b.spine, 1))) * rise
        chest = add(joint, chest, (0, 0.01, low), (0, 0.01, low + (1 - 0.3 / max(b.spine, 1)) * rise))
    above = chest
    for i in range(b.neck):
        step = (p.head - p.neck) / b.neck
        joint = "neck" if i == 0 else f"neck{i + 1}"
        above = add(joint, above, (0, 0.01, p.neck + i * step), (0, 0.005, p.neck + (i + 1) * step))
    add("head", above, (0, 0, p.head), (0, 0, 1.0))
    for side, sign in (("left", 1.0), ("right", -1.0)):
        _add_leg(add, p, b, side, sign)
        _add_arm(add, p, b, side, sign, chest)
    return out


def _spine_names(count: int) -> list[str]:
    if count <= 3:
        return [["spine"], ["spine", "chest"], ["spine", "chest", "upperChest"]][count - 1] if count else []
    return ["spine", *(f"spine{i}" for i in range(2, count - 1)), "chest", "upperChest"]


_Add = Callable[[str, str | None, Sequence[float], Sequence[float]], str]


def _limb(add: _Add, joint: str, parent: str, head: np.ndarray, tail: np.ndarray, twists: int) -> str:
    add(joint, parent, head, tail)
    for i in range(1, twists + 1):
        start = head + (tail - head) * i / (twists + 1)
        add(f"{joint}Twist{i}", joint, start, start + 0.2 * (tail - head))
    return joint


def _add_leg(add: _Add, p: Proportions, b: Build, side: str, sign: float) -> None:
    x = sign * p.hip_width
    hip, knee, ankle = np.array([x, 0, p.hips - 0.01]), np.array([x, -0.008, p.knee]), np.array([x, 0.012, p.ankle])
    ball = np.array([x, 0.012 - p.foot, 0.012])
    _limb(add, f"{side}UpperLeg", "hips", hip, knee, b.twists)
    _limb(add, f"{side}LowerLeg", f"{side}UpperLeg", knee, ankle, b.twists)
    add(f"{side}Foot", f"{side}LowerLeg", ankle, ball)
    if b.toes:
        add(f"{side}Toes", f"{side}Foot", ball, ball + np.array([0, -0.035, 0]))


def _add_arm(add: _Add, p: Proportions, b: Build, side: str, sign: float, chest: str) -> None:
    angle = np.radians(b.arms_down)
    along = np.array([sign * np.cos(angle), 0, -np.sin(angle)])
    shoulder = np.array([sign * p.shoulder_width, 0.01, p.neck - 0.01])
    elbow = shoulder + p.upper_arm * along + np.array([0, 0.004, 0])
    wrist = elbow + p.lower_arm * along + np.array([0, -0.004, 0])
    parent = chest
    if b.clavicles:
        parent = add(f"{side}Shoulder", chest, (sign * 0.02, 0, p.neck - 0.015), shoulder)
    _limb(add, f"{side}UpperArm", parent, shoulder, elbow, b.twists)
    _limb(add, f"{side}LowerArm", f"{side}UpperArm", elbow, wrist, b.twists)
    add(f"{side}Hand", f"{side}LowerArm", wrist, wrist + p.hand * along)
    for digit in range(b.fingers):
        _add_finger(add, p, side, digit, wrist, along)


_DIGITS = ("Thumb", "Index", "Middle", "Ring", "Little")


def _add_finger(add: _Add, p: Proportions, side: str, digit: int, wrist: np.ndarray, along: np.ndarray) -> None:
    thumb = digit == 0
    spread = np.array([0.0, -0.025 + 0.012 * digit, 0.0])
    start = wrist + (0.25 if thumb else 0.9) * p.hand * along + (np.array([0, -0.012, -0.004]) if thumb else spread)
    way = (along + np.array([0, -0.9, -0.3])) / 1.3 if thumb else along
    joints = ("Metacarpal", "Proximal", "Distal") if thumb else ("Proximal", "Intermediate", "Distal")
    lengths = (0.02, 0.018, 0.014) if thumb else (0.022, 0.014, 0.011)
    parent = f"{side}Hand"
    for joint, length in zip(joints, lengths, strict=True):
        name = f"{side}{_DIGITS[digit]}{joint}"
        add(name, parent, start, start + length * way)
        parent, start = name, start + length * way


def moved(bones: Iterable[Bone], matrix: np.ndarray) -> list[Bone]:
    """Return bones taken through a matrix, shape (4, 4)."""

    def through(point: Point) -> Point:
        x, y, z = (float(v) for v in matrix[:3, :3] @ np.array(point) + matrix[:3, 3])
        return x, y, z

    return [replace(bone, head=through(bone.head), tail=through(bone.tail)) for bone in bones]
