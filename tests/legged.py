"""Bodies with any number of legs as plain data, for what walks: long ones, odd ones, and ones that hardly have legs."""

from collections.abc import Sequence

from tools.figure import Bone

ROW = 0.8
"""From one row of legs to the next, in leg lengths."""
KNEE, ANKLE, TOE = (0.22, -0.12, 0.56), (0.26, 0.04, 0.08), (0.26, -0.14, 0.0)
"""Joints of a leg: out from its hip, back and up from the ground, in hip heights."""


def crawler(feet: int, size: float = 1.0, sizes: Sequence[float] = ()) -> list[Bone]:
    """Return a long body with rows of two legs; one that has an odd number lacks the hindmost leg on the right.

    Args:
        feet: How many.
        size: Height of its hips [m].
        sizes: Height of the legs of each pair, from the rear to the front, as a share of ``size``; all 1 when empty.
    """
    rows = (feet + 1) // 2
    shares = list(sizes) or [1.0] * rows
    places = [(0.5 * (rows - 1) - i) * ROW * size for i in range(rows)]
    high = 1.05 * size
    out = [Bone("root", None, (0.0, places[0] + 0.2 * size, high), (0.0, places[0], high))]
    for i, y in enumerate(places):
        out.append(Bone(f"spine{i}", out[-1].name, (0.0, y, high), (0.0, y - 0.6 * ROW * size, high)))
    end = places[-1] - ROW * size
    out.append(Bone("head", out[-1].name, (0.0, end, high), (0.0, end - 0.4 * size, 1.1 * high)))
    for i, (y, share) in enumerate(zip(places, shares, strict=True)):
        for side, sign in (("L", 1.0), ("R", -1.0)):
            if sign > 0.0 or i > 0 or feet % 2 == 0:
                out += _leg(f"{i}.{side}", f"spine{i}", y, sign, share * size)
    return out


def _leg(name: str, parent: str, y: float, side: float, size: float) -> list[Bone]:
    hip = (side * 0.15 * size, y, size)
    joints = [hip, *((hip[0] + side * x * size, y + ahead * size, z * size) for x, ahead, z in (KNEE, ANKLE, TOE))]
    out: list[Bone] = []
    for part, head, tail in zip(("thigh", "shin", "foot"), joints[:-1], joints[1:], strict=True):
        out.append(Bone(f"{part}{name}", parent, head, tail))
        parent = out[-1].name
    return out


def stilts(size: float = 1.0) -> list[Bone]:
    """Return a body on two legs of one bone each, which have neither knees nor feet of their own."""
    out = [
        Bone("root", None, (0.0, 0.0, 0.0), (0.0, -0.2 * size, 0.0)),
        Bone("hips", "root", (0.0, 0.0, size), (0.0, 0.0, 1.2 * size)),
        Bone("spine", "hips", (0.0, 0.0, 1.2 * size), (0.0, 0.0, 1.6 * size)),
        Bone("head", "spine", (0.0, 0.0, 1.6 * size), (0.0, 0.0, 1.9 * size)),
    ]
    sides = (("L", 1.0), ("R", -1.0))
    return out + [Bone(f"leg.{n}", "hips", (s * 0.1 * size, 0.0, size), (s * 0.1 * size, 0.0, 0.0)) for n, s in sides]
