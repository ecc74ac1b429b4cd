"""The two motions of a transfer, link by link: the source's, and the target's on its way through the steps."""

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Flags
from ..skeleton import Pose
from . import feet, kinematics
from .feet import Steps
from .links import NONE
from .plan import Plan


@dataclass(frozen=True, eq=False)
class SourceMotion:
    """What the source does over a clip, in its character frame."""

    turns: Array
    """Turn of each link from the source's rest, shape (frame, link, 4)."""
    points: Array
    """Place of each link [m], shape (frame, link, 3)."""
    steps: Steps
    """When its feet stand."""
    seconds_per_frame: float
    """Of the clip [s]."""

    @classmethod
    def read(
        cls,
        plan: Plan,
        pose: Pose,
        seconds_per_frame: float,
        standing: Flags | None,
        ankles: Array | None = None,
    ) -> "SourceMotion":
        """Return the motion of a plan's source.

        Args:
            plan: Of the pair.
            pose: The source over the clip, armature space.
            seconds_per_frame: Of the clip [s].
            standing: The user's own plants, shape (frame, foot); found from the motion when None.
            ankles: Where the feet are instead of where the pose has them, shape (frame, foot, 3), as in `pipeline`.
        """
        links, theirs = plan.links, plan.source.local_to_character
        points = kinematics.source_points(links, pose.positions, theirs)
        if ankles is not None:
            for leg, own in zip(links.legs, np.moveaxis(ankles, 1, 0), strict=True):
                away = np.where(np.isfinite(own), own - points[:, leg.end], 0.0)
                for part in (leg.end, *(() if leg.ball == NONE else (leg.ball,))):
                    points[:, part] += away
        contacts = plan.settings.contacts
        return cls(
            turns=kinematics.source_turns(links, plan.source.skeleton, pose, theirs),
            points=points,
            steps=feet.find_steps(links.legs, points, seconds_per_frame, plan.source_leg, contacts, standing),
            seconds_per_frame=seconds_per_frame,
        )


@dataclass(frozen=True, eq=False)
class Motion:
    """What the target does, in its character frame."""

    turns: Array
    """Turn of each link from rest, shape (frame, link, 4)."""
    points: Array
    """Place of each link [m], shape (frame, link, 3)."""
    unreached: float = 0.0
    """Largest distance of a foot or hand from its place [m]."""

    def shifted(self, by: Array) -> "Motion":
        """Return the whole body moved, ``by`` of shape (frame, 3)."""
        return replace(self, points=self.points + by[:, None])

    def lifted(self, by: Array) -> "Motion":
        """Return the whole body raised, ``by`` of shape (frame,)."""
        return self.shifted(by[:, None] * np.array([0.0, 0.0, 1.0]))
