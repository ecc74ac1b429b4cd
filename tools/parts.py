"""Parts that creatures are put together from: lines of bones, limbs and faces, all of them left halves.

Every limb is bent the way it bends in life, so that a solver can tell where its joints go.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from .figure import Point
from .flesh import Lump, Paint, Part, opposite

ROUND = (1.0, 1.0, 1.0)
OPEN = "open"
"""The shape in which a mouth stands open."""
CLOSED = "closed"
"""The shape in which hands are fists."""
SPIDER_MIDDLE = -0.02
"""Where the legs of a spider come together, along Y [m]."""

# --- lines of bones ---


def line(
    names: Sequence[str],
    points: Sequence[Sequence[float]],
    radii: Sequence[float],
    parent: str,
    squash: Point = ROUND,
    paint: Paint = Paint.SKIN,
    last: int = 0,
    sides: int = 8,
) -> list[Part]:
    """Return bones from point to point with flesh around them.

    Args:
        names: Of the bones.
        points: One more than bones.
        radii: At the points [m].
        parent: What the first bone hangs on.
        squash: Of the flesh.
        paint: Of the flesh.
        last: So many bones at the end are not squashed.
        sides: Of the flesh.
    """
    places = [point(p) for p in points]
    out: list[Part] = []
    for i, name in enumerate(names):
        flat = squash if i < len(names) - last else ROUND
        lump = Lump(places[i], places[i + 1], (float(radii[i]), float(radii[i + 1])), paint, flat, sides, flush=i > 0)
        out.append(Part(name, out[-1].name if out else parent, places[i], places[i + 1], (lump,)))
    return out


def point(place: Sequence[float]) -> Point:
    """Return a place as plain numbers."""
    x, y, z = (float(v) for v in place)
    return x, y, z


def counted(stem: str, count: int) -> list[str]:
    """Return names as Blender numbers them, from ``Tail.001`` on."""
    return [f"{stem}.{i:03}" for i in range(1, count + 1)]


def both(left: Iterable[Part]) -> list[Part]:
    """Return left bones and their mirror images."""
    parts = list(left)
    return [*parts, *map(opposite, parts)]


def root(length: float) -> Part:
    """Return a bone on the ground that carries the whole body."""
    return Part("Root", None, (0.0, 0.0, 0.0), (0.0, -length, 0.0))


def bent(start: np.ndarray, end: np.ndarray, lengths: tuple[float, float], toward: Point) -> np.ndarray:
    """Return the joint between two segments from ``start`` to ``end``, bent toward a direction."""
    way = end - start
    distance = float(np.linalg.norm(way))
    along = way / distance
    aside = np.array(toward) - (np.array(toward) @ along) * along
    first = 0.5 * (distance + (lengths[0] ** 2 - lengths[1] ** 2) / distance)
    return start + first * along + np.sqrt(lengths[0] ** 2 - first**2) * aside / np.linalg.norm(aside)


# --- limbs ---


def leg(hip: Point, ankle: Point, lengths: tuple[float, float], girth: float, foot: float) -> list[Part]:
    """Return a human leg, its knee in front, its foot of length ``foot`` [m] flat on the ground."""
    knee = bent(np.array(hip), np.array(ankle), lengths, (0.0, -1.0, 0.0))
    names, radii = ("UpperLeg.L", "LowerLeg.L"), (girth, 0.72 * girth, 0.5 * girth)
    ball = (ankle[0], ankle[1] - foot, 0.2 * ankle[2])
    tip = (ankle[0], ball[1] - 0.4 * foot, ball[2])
    # A tube touches the ground where its middle lies as high as it is thick.
    thick, wide, flat = 0.6 * girth, 0.66 * girth, (1.0, 1.0, 0.55)
    back, front = (ankle[0], ankle[1] + 0.1 * foot, flat[2] * thick), (ankle[0], ball[1], flat[2] * wide)
    low = (ankle[0], ball[1], flat[2] * thick), (ankle[0], tip[1] + thick, flat[2] * thick)
    heel = Lump(back, front, (thick, wide), squash=flat)
    toes = Lump(*low, (thick, thick), Paint.PALE, flat)
    return [
        *line(names, (hip, knee, ankle), radii, "Hips"),
        Part("Foot.L", "LowerLeg.L", ankle, ball, (heel,)),
        Part("Toes.L", "Foot.L", ball, tip, (toes,)),
    ]


def arm(
    shoulder: Point,
    lengths: tuple[float, float, float],
    down: float,
    girth: float,
    parent: str,
    row: str = "",
    clavicle: Point | None = None,
) -> list[Part]:
    """Return an arm with a hand of three fingers, its elbow behind.

    Args:
        shoulder: Where it begins.
        lengths: Of upper arm, lower arm and palm [m].
        down: Angle below the horizontal [deg].
        girth: Radius at the shoulder [m].
        parent: What it hangs on.
        row: What tells its names from those of other arms.
        clavicle: Where its clavicle begins; without one there is none.
    """
    angle = np.radians(down)
    along = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    wrist = np.array(shoulder) + 0.985 * (lengths[0] + lengths[1]) * along
    elbow = bent(np.array(shoulder), wrist, lengths[:2], (0.0, 1.0, 0.0))
    out: list[Part] = []
    if clavicle is not None:
        out = line([f"Shoulder{row}.L"], (clavicle, shoulder), (0.9 * girth, girth), parent)
        parent = out[0].name
    out += line(
        (f"UpperArm{row}.L", f"LowerArm{row}.L"),
        (shoulder, elbow, wrist),
        (girth, 0.8 * girth, 0.6 * girth),
        parent,
    )
    hand = line([f"Hand{row}.L"], (wrist, wrist + lengths[2] * along), (0.62 * girth, 0.75 * girth), out[-1].name)
    palm = np.array([-np.sin(angle), 0.0, -np.cos(angle)])
    for digit, (start, way) in _digits(lengths[2], along, palm).items():
        hand += _finger(
            digit + "{}" + row + ".L", wrist + start, way, palm, 0.6 * lengths[2], 0.3 * girth, hand[0].name
        )
    return [*out, *hand]


def _digits(size: float, along: np.ndarray, palm: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return where the fingers of a left hand begin, from the wrist, and which way they point."""
    front = np.array([0.0, -1.0, 0.0])
    return {
        "Thumb": (size * (0.35 * along + 0.25 * front), 0.55 * along + 0.75 * front + 0.3 * palm),
        "Index": (size * (along + 0.28 * front), along + 0.15 * front + 0.1 * palm),
        "Middle": (size * (along - 0.25 * front), along - 0.15 * front + 0.1 * palm),
    }


def _finger(
    name: str, start: np.ndarray, way: np.ndarray, palm: np.ndarray, length: float, girth: float, parent: str
) -> list[Part]:
    """Return a finger of two bones that curls toward the palm in the shape of a fist."""
    way = way / np.linalg.norm(way)
    axis = np.cross(way, palm)
    bend = point(1.1 * axis / np.linalg.norm(axis))
    last = way + 0.3 * palm
    joint = start + length * way
    points = (start, joint, joint + 0.8 * length * last / np.linalg.norm(last))
    parts = line([name.format(i) for i in (1, 2)], points, (1.1 * girth, girth, 0.8 * girth), parent, sides=6)
    return [replace(part, turns={CLOSED: bend}) for part in parts]


def sole(name: str, parent: str, ankle: Point, length: float, radius: float) -> Part:
    """Return a paw, flat on the ground."""
    x, y, z = ankle
    height = 0.75 * radius
    lump = Lump((x, y, height), (x, y - length, height), (radius, radius), Paint.PALE, (1.0, 1.0, 0.75))
    return Part(name, parent, ankle, (x, y - length, 0.3 * z), (lump,))


def insect_leg(row: int, parent: str, start: float, end: float) -> list[Part]:
    """Return a leg from its row on the body out to the ground, its knee high; ``start`` and ``end`` lie along Y."""
    ys = start + np.array([0.0, 0.12, 0.55, 0.9, 1.12]) * (end - start)
    xs, zs = (0.06, 0.1, 0.185, 0.225, 0.275), (0.13, 0.125, 0.175, 0.018, 0.012)
    return line(
        [f"{joint}{row}.L" for joint in ("Coxa", "Femur", "Tibia", "Tarsus")],
        list(zip(xs, ys, zs, strict=True)),
        (0.03, 0.028, 0.025, 0.016, 0.011),
        parent,
        paint=Paint.DARK,
        sides=8,
    )


def spider_leg(row: int, parent: str, aside: float, reach: float) -> list[Part]:
    """Return a leg from its row on the body out to the ground, its knee high above both.

    Args:
        row: From the front, 1 … 4.
        parent: What it hangs on.
        aside: Which way it leads: 0 ahead, 90 to the left [deg].
        reach: Of its tip, from the middle of the body [m].
    """
    angle, away = np.radians(aside), np.array([0.06, 0.1, 0.52 * reach, 0.83 * reach, 0.96 * reach, reach])
    zs = (0.115, 0.125, 0.275, 0.185, 0.012, 0.008)
    points = [(r * np.sin(angle), SPIDER_MIDDLE - r * np.cos(angle), z) for r, z in zip(away, zs, strict=True)]
    leg = line(
        [f"{joint}{row}.L" for joint in ("Coxa", "Femur", "Tibia", "Shank", "Tarsus")],
        points,
        (0.027, 0.026, 0.022, 0.017, 0.01, 0.008),
        parent,
        sides=8,
    )
    return [*leg[:2], *(painted(part, Paint.DARK) for part in leg[2:])]


def claw() -> Part:
    """Return a bird's foot, which lies on four toes."""
    x, y, z = 0.06, 0.015, 0.012
    tips = ((x, y - 0.085), (x + 0.04, y - 0.065), (x - 0.035, y - 0.065), (x, y + 0.045))
    toes = tuple(Lump((x, y, z), (a, b, 0.007), (0.012, 0.007), Paint.PALE, sides=6) for a, b in tips)
    return Part("Foot.L", "Hock.L", (x, y, 0.022), (x, y - 0.085, 0.01), toes)


def wing() -> list[Part]:
    """Return a wing of four bones with feathers behind them."""
    points = [
        (0.06, -0.08, 0.43),
        (0.16, -0.03, 0.455),
        (0.27, -0.085, 0.465),
        (0.37, -0.05, 0.455),
        (0.47, 0.02, 0.435),
    ]
    arm = line([f"Wing{i}.L" for i in range(1, 5)], points, (0.035, 0.026, 0.02, 0.014, 0.008), "Chest")
    out: list[Part] = []
    for part, reach in zip(arm, (0.14, 0.17, 0.18, 0.13), strict=True):
        feathers: list[Lump] = []
        for share in (0.25, 0.75):
            start = np.array(part.head) + share * (np.array(part.tail) - np.array(part.head))
            way = np.array([0.3 * reach, reach, -0.02])
            for begin, end, width, paint in ((0.0, 0.9, 0.036, Paint.SKIN), (0.85, 1.15, 0.029, Paint.DARK)):
                ends = point(start + begin * way), point(start + end * way)
                feathers.append(Lump(*ends, (width, 0.75 * width), paint, (1.0, 1.0, 0.22), 6))
        out.append(replace(part, flesh=(*part.flesh, *feathers)))
    return out


# --- faces ---


def jaw(
    hinge: Point,
    chin: Point,
    radii: tuple[float, float],
    squash: Point = ROUND,
    opening: float = 0.45,
    paint: Paint = Paint.PALE,
) -> Part:
    """Return a lower jaw with the floor of the mouth on it; it opens by a turn about its hinge [rad]."""
    rise = 0.45 * radii[1] * squash[2]
    tongue = tuple((p[0], p[1] + 0.4 * radii[1], p[2] + rise) for p in (hinge, chin))
    flesh = (
        Lump(hinge, chin, radii, paint, squash),
        Lump(tongue[0], tongue[1], (0.75 * radii[0], 0.75 * radii[1]), Paint.MOUTH, (squash[0], 1.0, 0.8 * squash[2])),
    )
    return Part("Jaw", "Head", hinge, chin, flesh, {OPEN: (opening, 0.0, 0.0)})


def cavity(place: Point, radius: float, reach: float = 0.0) -> Lump:
    """Return the roof of a mouth, ``reach`` [m] long."""
    end = (place[0], place[1] - reach, place[2])
    return Lump(place, end, (radius, radius), Paint.MOUTH, (1.0, 1.0, 0.6))


def mandible() -> list[Part]:
    """Return the left half of a jaw that bites sideways."""
    line = Part("Mandible.L", "Head", (0.042, -0.205, 0.13), (0.014, -0.32, 0.12), (
        Lump((0.042, -0.215, 0.13), (0.052, -0.265, 0.125), (0.018, 0.015), Paint.PALE, sides=7),
        Lump((0.052, -0.265, 0.125), (0.014, -0.315, 0.12), (0.015, 0.006), Paint.PALE, sides=7),
    ), {OPEN: (0.0, 0.0, 0.5)})  # fmt: skip
    return [line]


def fang() -> list[Part]:
    """Return the left half of a spider's mouth: a stout piece that hangs down before the head, with a fang."""
    chelicera = Part("Fang.L", "Head", (0.026, -0.165, 0.125), (0.03, -0.195, 0.045), (
        Lump((0.026, -0.17, 0.115), (0.03, -0.19, 0.08), (0.03, 0.026), Paint.PALE, sides=8),
        Lump((0.03, -0.195, 0.075), (0.018, -0.19, 0.035), (0.013, 0.004), Paint.DARK, sides=7),
    ), {OPEN: (-0.35, 0.45, 0.0)})  # fmt: skip
    return [chelicera]


def eye(place: Point, radius: float, parent: str = "Head") -> list[Part]:
    """Return a left eye that looks ahead and a little aside."""
    x, y, z = place
    way = np.array([0.3, -1.0, 0.05]) / np.linalg.norm([0.3, -1.0, 0.05])
    pupil = np.array(place) + 0.66 * radius * way
    flesh = (
        Lump(place, point(np.array(place) + 0.01 * radius * way), (radius, radius), Paint.WHITE),
        Lump(point(pupil), point(pupil + 0.01 * radius * way), (0.55 * radius, 0.5 * radius), Paint.DARK),
    )
    return [Part("Eye.L", parent, place, (x, y - 1.5 * radius, z), flesh)]


def nose(y: float, z: float) -> tuple[Lump, ...]:
    """Return a human nose."""
    return (Lump((0, y + 0.02, z + 0.03), (0, y - 0.005, z - 0.005), (0.012, 0.02)),)


def dressed(parts: Sequence[Part], count: int | None = None) -> list[Part]:
    """Return bones with the flesh of the first ``count`` under cloth."""
    return [painted(part, Paint.CLOTH) for part in parts[:count]] + list(parts[len(parts[:count]) :])


def painted(part: Part, paint: Paint) -> Part:
    """Return a bone with its flesh in another paint."""
    return replace(part, flesh=tuple(replace(lump, paint=paint) for lump in part.flesh))


def striped(parts: Sequence[Part]) -> list[Part]:
    """Return bones with every second one's flesh pale."""
    return [painted(part, Paint.PALE) if i % 2 else part for i, part in enumerate(parts)]
