"""Timing of BML: when the sync points of behaviours are, from times, from each other, and from how long they take.

The points of a behaviour follow each other; between those that are told, the others lie as they do when it is done by
itself. A time that is told by another behaviour waits until that is known; circles are told.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from .bml_file import Constraint, Element, Reference, reference

POINTS = ("start", "ready", "stroke_start", "stroke", "stroke_end", "relax", "end")
"""The sync points of behaviours in the order of their times."""
HELD = POINTS.index("stroke_end")
"""The first point after what a behaviour holds."""
_NAMES = {"strokeStart": "stroke_start", "strokeEnd": "stroke_end", "attackPeak": "stroke", "peak": "stroke"}
Lasting = tuple[float, ...]
"""When each of `POINTS` is after the start if a behaviour is done by itself [s]."""
USUAL: Lasting = (0.0, 0.3, 0.4, 0.7, 1.0, 1.2, 1.5)
USUALLY: Mapping[str, Lasting] = {
    "gaze": (0.0, 0.4, 0.4, 0.4, 2.0, 2.0, 2.4),
    "gazeShift": (0.0, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4),
    "head": (0.0, 0.2, 0.2, 0.5, 0.8, 0.8, 1.0),
    "pointing": (0.0, 0.6, 0.6, 0.8, 1.6, 1.6, 2.2),
    "locomotion": (0.0, 0.5, 0.5, 1.0, 1.5, 1.5, 2.0),
    "wait": (0.0,) * 6 + (1.0,),
}


@dataclass(frozen=True)
class Timed:
    """A behaviour with the times of its sync points."""

    element: Element
    points: Lasting
    """Times of `POINTS` [s]."""
    told: frozenset[str]
    """Points whose times the file tells."""

    def at(self, point: str) -> float:
        """Return the time of a point [s]."""
        return self.points[POINTS.index(point)]

    @property
    def end(self) -> float:
        """When it is over [s]."""
        return self.points[-1]

    def later(self, seconds: float) -> "Timed":
        """Return it at another time."""
        return replace(self, points=tuple(time + seconds for time in self.points))


def resolved(
    behaviours: Sequence[Element], constraints: Iterable[Constraint], lasting: Mapping[str, Lasting]
) -> tuple[list[Timed], list[str]]:
    """Return behaviours with their times in the block, and warnings.

    Args:
        behaviours: Of one block.
        constraints: Of the same.
        lasting: How long the motions take that gestures name by their lexemes, in small letters.
    """
    warnings: list[str] = []
    asked = [_asked(one, warnings) for one in behaviours]
    by_id = {one.id: i for i, one in enumerate(behaviours) if one.id}
    limits: list[tuple[int, str, Reference]] = []
    for constraint in constraints:
        _add(constraint, by_id, asked, limits, warnings)
    found: dict[int, Timed] = {}
    waiting = list(range(len(behaviours)))
    while waiting:
        ready = [i for i in waiting if all(_known(ref, by_id, found, i) for ref in asked[i].values())]
        if not ready:
            stuck = behaviours[waiting[0]]
            lost = next(ref for ref in asked[waiting[0]].values() if not _known(ref, by_id, found, waiting[0]))
            what = "waits for itself" if lost.behaviour in by_id else f"has no behaviour {lost.behaviour!r} to wait for"
            warnings.append(f"{stuck.origin}: <{stuck.name}> {what}: that time is left out")
            asked[waiting[0]] = {
                point: ref for point, ref in asked[waiting[0]].items() if _known(ref, by_id, found, waiting[0])
            }
            continue
        for i in ready:
            found[i] = _timed(behaviours[i], asked[i], by_id, found, lasting, warnings)
            waiting.remove(i)
    _keep(limits, by_id, found)
    return [found[i] for i in range(len(behaviours))], warnings


def _asked(element: Element, warnings: list[str]) -> dict[str, Reference]:
    """Return what a behaviour says of the times of its points."""
    out: dict[str, Reference] = {}
    for name, text in element.attributes.items():
        point = _NAMES.get(name, name)
        if point not in POINTS or not text.strip():
            continue
        found = reference(text)
        if found is None:
            warnings.append(
                f"{element.origin}: {name} is {text!r}: give seconds, or a sync point as in 'gesture1:stroke'"
            )
        else:
            out[point] = replace(found, point=_NAMES.get(found.point, found.point))
    return out


def _add(
    constraint: Constraint,
    by_id: Mapping[str, int],
    asked: list[dict[str, Reference]],
    limits: list[tuple[int, str, Reference]],
    warnings: list[str],
) -> None:
    """Let a constraint tell times of behaviours that have none there yet."""
    for other in constraint.others:
        point = _NAMES.get(other.point, other.point)
        if other.behaviour not in by_id or point not in POINTS:
            warnings.append(f"{constraint.origin}: there is no {other.behaviour}:{other.point} to time")
            continue
        first = replace(constraint.first, offset=constraint.first.offset - other.offset)
        if constraint.kind == "synchronize":
            asked[by_id[other.behaviour]].setdefault(point, first)
        elif constraint.kind == "after":
            limits.append((by_id[other.behaviour], point, first))
        else:
            warnings.append(f"{constraint.origin}: <before> is not understood: use <after> or <synchronize>")


def _known(ref: Reference, by_id: Mapping[str, int], found: Mapping[int, Timed], own: int) -> bool:
    """Return whether a time can be told now; one of the behaviour itself always can."""
    return not ref.behaviour or by_id.get(ref.behaviour) in found or by_id.get(ref.behaviour) == own


def _timed(
    element: Element,
    asked: Mapping[str, Reference],
    by_id: Mapping[str, int],
    found: Mapping[int, Timed],
    lasting: Mapping[str, Lasting],
    warnings: list[str],
) -> Timed:
    """Return a behaviour at its times."""
    usual = lasting.get(element.get("lexeme").lower()) or USUALLY.get(element.name, USUAL)
    duration = reference(element.get("duration") or "0")
    if duration is not None and duration.offset > 0.0 and not duration.point:
        usual = (*(time * duration.offset / usual[-1] for time in usual[:-1]), duration.offset)
    times: dict[int, float] = {}
    relative: dict[int, Reference] = {}
    for point, ref in asked.items():
        if not ref.behaviour and not ref.point:
            times[POINTS.index(point)] = ref.offset
        elif not ref.behaviour or by_id.get(ref.behaviour) not in found:
            relative[POINTS.index(point)] = ref
        elif ref.point in POINTS:
            times[POINTS.index(point)] = found[by_id[ref.behaviour]].at(ref.point) + ref.offset
        else:
            warnings.append(
                f"{element.origin}: there is no sync point {ref.point!r}: choose one of {', '.join(POINTS)}"
            )
    for place, ref in sorted(relative.items()):  # told by points of its own
        if ref.point in POINTS:
            times[place] = _filled(times, usual)[POINTS.index(ref.point)] + ref.offset
    points = _filled(times, usual)
    if any(later < sooner - 1e-9 for sooner, later in pairwise(points)):
        warnings.append(f"{element.origin}: the sync points of <{element.name}> are not in order: later ones wait")
        points = [max(points[: i + 1]) for i in range(len(points))]
    return Timed(element, tuple(points), frozenset(POINTS[place] for place in times))


def _filled(times: Mapping[int, float], usual: Lasting) -> list[float]:
    """Return the times of all points where some are told: others lie between them as usual, or as far off as usual."""
    if not times:
        return list(usual)
    known = sorted(times)
    out: list[float] = []
    for i, own in enumerate(usual):
        before = [k for k in known if k <= i]
        after = [k for k in known if k >= i]
        if not before:
            out.append(times[after[0]] - (usual[after[0]] - own))
        elif not after:
            out.append(times[before[-1]] + own - usual[before[-1]])
        else:
            low, high = before[-1], after[0]
            out.append(
                times[low]
                + _since(
                    own - usual[low], usual[high] - usual[low], times[high] - times[low], low < HELD <= high, i >= HELD
                )
            )
    return out


def _since(own: float, usual: float, lasts: float, is_held: bool, is_after: bool) -> float:
    """Return how long after a point another one is, within a part that lasts other than usual [s].

    What is held lasts longer by itself: the ways there and back keep their times. All else is stretched evenly.

    Args:
        own: How long after it is usually.
        usual: How long the part usually lasts.
        lasts: How long it does here.
        is_held: Whether the part has something that is held.
        is_after: Whether the point is after that.
    """
    if is_held and lasts > usual:
        return own + (lasts - usual if is_after else 0.0)
    return own * lasts / usual if usual > 0.0 else 0.0


def _keep(limits: Iterable[tuple[int, str, Reference]], by_id: Mapping[str, int], found: dict[int, Timed]) -> None:
    """Let behaviours wait that must come after others, in the order in which that is demanded."""
    for own, point, ref in limits:
        other = by_id.get(ref.behaviour)
        base = 0.0 if other is None else found[other].at(ref.point) if ref.point in POINTS else found[other].end
        late = base + ref.offset - found[own].at(point)
        if late > 0.0:
            found[own] = found[own].later(late)
