"""What an animator tunes about a gait, beyond its style."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..errors import MotionError
from .foot_path import ARC, FootPath

Layers = tuple[tuple[str, float], ...]
"""Names of styles, and how much each counts."""


@dataclass(frozen=True)
class GaitSettings:
    """Parameters of a gait. Factors are 1 where the style is as it was authored."""

    styles: Layers = (("auto", 1.0),)
    """Styles that are layered on all groups of legs (Hecker 2008 §4.2)."""
    of_group: Mapping[int, Layers] = field(default_factory=dict[int, Layers], hash=False)
    """Styles of groups that have their own, by the number of the group: short legs may run where long ones trot."""
    stride: float = 1.0
    """Factor of the length of strides; the frequency follows from the speed."""
    step_height: float = 1.0
    """Factor of how high feet are lifted."""
    width: float = 1.0
    """Factor of how far to the side the feet are put down: 0 puts them on one line."""
    crouch: float = 0.0
    """How much the hips are lowered beyond the style's own [leg lengths]."""
    body: float = 1.0
    """Factor of how much hips and spine move with the steps."""
    arms: float = 1.0
    """How much of the arms is the gait's, 0 … 1; 0 leaves them as they are."""
    foot_roll: float = 1.0
    """Factor of how far the feet roll over heel and ball."""
    tilt: float = 1.0
    """How much feet and body tilt with the slope of the ground, 0 … 1."""
    path: FootPath = ARC
    """The way of a foot in flight."""

    def check(self) -> None:
        """Check that they lead anywhere.

        Raises:
            MotionError: The stride does not.
        """
        if not self.stride > 0.0:
            raise MotionError(f"the stride is {self.stride:g}: give it a factor greater than 0")
