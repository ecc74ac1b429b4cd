"""Gait styles: named mappings from speed and number of feet to how feet and body move, and changes laid over them.

A style is authored for some numbers of feet (Hecker 2008 §4.2: one to six; more are generated). A change, as limping,
has no manners of its own: it alters those of whatever styles it is layered on.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from ...errors import MotionError, listed
from . import four_feet, many_feet, two_feet
from .manner import MOST_FEET, Manner

Manners = tuple[Manner, ...]
"""By rising speed, from 0."""


@dataclass(frozen=True)
class Change:
    """What a style alters of others, in full. Of parameters that are not added it is a factor."""

    duty: float = 0.0
    """Added to all duty factors."""
    stride: float = 1.0
    lift: float = 1.0
    bob: float = 1.0
    sway: float = 0.0
    """Added."""
    yaw: float = 1.0
    roll: float = 1.0
    pitch: float = 1.0
    lean: float = 0.0
    """Added [rad]."""
    crouch: float = 0.0
    """Added [leg lengths]."""
    swing: float = 1.0
    toe_off: float = 1.0
    heel_strike: float = 1.0
    hurt: float = 0.0
    """Taken from the duty factor of the foot that hurts: the last one, which is the right front one."""
    late: float = 0.0
    """By how much that foot lands later than it would: the others follow soon [cycles]."""
    rise: float = 0.0
    """How much the body rises off that foot while it stands on it, half of peak to peak [leg lengths]."""


@dataclass(frozen=True)
class Style:
    """How characters go, at any speed."""

    name: str
    title: str
    description: str
    authored: Mapping[int, Manners] = field(default_factory=dict[int, Manners], hash=False)
    """Manners by number of feet."""
    generated: Callable[[int], Manners] | None = None
    """Makes those of numbers of feet that nobody authored, from the least one."""
    least: int = MOST_FEET + 1
    fallback: str = "auto"
    """The style that takes its place for other numbers of feet."""
    change: Change | None = None
    """What it alters of the styles that it is layered on; None for a style that has manners of its own."""

    def suits(self, feet: int) -> bool:
        """Return whether it was made for a number of feet; else its `fallback` is taken."""
        return self.change is not None or feet in self.authored or (self.generated is not None and feet >= self.least)

    def manners(self, feet: int) -> Manners:
        """Return its manners for a number of feet (1 or more), or those of what takes its place."""
        if feet in self.authored:
            return self.authored[feet]
        if self.generated is not None and feet >= self.least:
            return self.generated(feet)
        return STYLES[self.fallback].manners(feet)


_ALL = (
    Style(
        "auto", "Auto", "The natural gait of the number of feet at each speed: walk, run, trot, gallop, tripods, waves",
        {1: two_feet.HOP, 2: two_feet.AUTO, 3: many_feet.THREE, 4: four_feet.AUTO, 5: many_feet.FIVE, 6: many_feet.SIX},
        generated=many_feet.crowd,
    ),
    Style(
        "walk", "Walk", "Some foot is always on the ground, however fast (two or four feet)",
        {2: two_feet.WALK, 4: four_feet.WALK},
    ),
    Style(
        "run", "Run", "With flights between the steps, however slow (two or four feet)",
        {2: two_feet.RUN, 4: four_feet.RUN},
    ),
    Style("skip", "Skip", "Two quick steps and a flight, the same foot ahead each time (two feet)",
          {2: two_feet.SKIP}, fallback="canter"),
    Style("trot", "Trot", "Diagonal pairs in turn (four feet)", {4: four_feet.TROT}, fallback="run"),
    Style("pace", "Pace", "The feet of one side in turn with those of the other, as camels go (four feet)",
          {4: four_feet.PACE}),
    Style("canter", "Canter", "Three beats: one hind foot, a diagonal pair, one fore foot (four feet)",
          {4: four_feet.CANTER}, fallback="run"),
    Style("gallop", "Gallop", "Four beats and a flight (four feet)", {4: four_feet.GALLOP}, fallback="run"),
    Style("bound", "Bound", "Both hind feet, then both fore feet (four feet)", {4: four_feet.BOUND}, fallback="run"),
    Style("tripod", "Tripod", "Two tripods of feet in turn, as hurrying insects go (six feet)",
          {6: many_feet.TRIPOD}, fallback="auto"),
    Style("ripple", "Ripple", "Feet step in overlapping waves, two in the air (six feet)",
          {6: many_feet.RIPPLE}, fallback="wave"),
    Style("wave", "Wave", "A slow wave runs forward along each side; most feet stand (any number)",
          generated=many_feet.slow_wave, least=1),
    Style("limp", "Limp", "Spares the right front foot",
          change=Change(hurt=0.14, late=0.06, rise=0.03, stride=0.9, roll=1.5, swing=0.8)),
    Style("lumber", "Lumber", "Heavy: slow long steps, the body swings over the feet that carry it",
          change=Change(duty=0.04, stride=1.08, lift=0.75, bob=1.5, sway=0.35, yaw=1.4, roll=2.0, lean=0.05,
                        crouch=0.03, swing=1.2, toe_off=0.6, heel_strike=0.5)),
    Style("sneak", "Sneak", "Bent down, with careful high steps",
          change=Change(duty=0.06, stride=0.85, lift=1.7, bob=0.3, sway=0.2, roll=0.6, lean=0.2, crouch=0.14,
                        swing=0.4, toe_off=0.7, heel_strike=0.0)),
    Style("prance", "Prance", "Proud: short springy steps, feet lifted high",
          change=Change(duty=-0.05, stride=0.8, lift=2.2, bob=1.7, yaw=0.7, lean=-0.05, swing=1.2)),
)  # fmt: skip

STYLES: Mapping[str, Style] = {style.name: style for style in _ALL}
"""All styles by name: those with manners of their own, then those that change others."""


def named(layers: Iterable[tuple[str, float]]) -> list[tuple[Style, float]]:
    """Return layers by the names of their styles.

    Raises:
        MotionError: There is no such style.
    """
    layers = list(layers)
    for name, _ in layers:
        if name not in STYLES:
            raise MotionError(f"there is no gait style {name!r}: choose from {listed(STYLES, len(STYLES))}")
    return [(STYLES[name], weight) for name, weight in layers]
