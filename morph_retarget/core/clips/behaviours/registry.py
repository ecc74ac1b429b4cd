"""All behaviours by name: what commands may address beside motion models."""

from collections.abc import Mapping

from ..commands.parameters import Parameter
from .behaviour import AIMED, Behaviour
from .faces import FACE
from .gaze import GAZE
from .handling import GRASP, POINT, REACH, TOUCH
from .nodding import NOD, SHAKE, TILT
from .saccades import SACCADE

GO = Behaviour(
    "go",
    "Go to a place, around what stands in the way",
    {
        **AIMED,
        "speed": Parameter(1.3, "How fast", "m/s", 0.05, 12.0),
        "facing": Parameter(
            0.0, "Where it looks in the end, to the left of where it looks at first", "deg", -360.0, 360.0
        ),
        "clearance": Parameter(
            0.0, "How far it keeps from what stands about, 0 for by its own breadth", "m", 0.0, 10.0
        ),
        "manner": Parameter("walk", "How it goes: the name of a motion"),
    },
)
BEHAVIOURS: Mapping[str, Behaviour] = {
    own.name: own for own in (GAZE, NOD, SHAKE, TILT, SACCADE, REACH, TOUCH, POINT, GRASP, GO, FACE)
}


def is_behaviour(name: str) -> bool:
    """Return whether commands to ``name`` are for a behaviour, and not for a motion model."""
    return name in BEHAVIOURS
