"""Random lists of commands, sound and unsound, for the motion controller."""

import numpy as np

from morph_retarget.core.clips.commands.command import Command, Value, Verb

MODELS = ("walk", "run", "idle", "wave", "dance", "sit", "jump", "fly", "")
VALUES: tuple[tuple[str, Value], ...] = (
    ("speed", 0.0),
    ("speed", 1.4),
    ("speed", 1e9),
    ("speed", "fast"),
    ("speed", float("nan")),
    ("turn", 0.3),
    ("turn", -12.0),
    ("direction", 2.0),
    ("style", "happy"),
    ("style", "sad"),
    ("side", "left"),
    ("repeat", 2.0),
    ("repeat", 0.0),
    ("tempo", 3.0),
    ("tempo", 0.0),
    ("amplitude", 0.5),
    ("height", 0.45),
    ("height", (1.0, 2.0)),
    ("colour", True),
)


def random_commands(seed: int, most: int = 14, seconds: float = 8.0) -> list[Command]:
    """Return commands in no order, many of them close together.

    Args:
        seed: Other ones make other lists.
        most: How many there are at most.
        seconds: Within which they are given.
    """
    rng = np.random.default_rng(seed)
    out: list[Command] = []
    for _ in range(int(rng.integers(1, most + 1))):
        time = float(rng.uniform(-1.0, seconds))
        time = round(time) if rng.random() < 0.3 else time
        verb = Verb.START if rng.random() < 0.6 else (Verb.STOP if rng.random() < 0.6 else Verb.RESET)
        chosen = [VALUES[i] for i in rng.integers(0, len(VALUES), rng.integers(0, 3))]
        out.append(Command(float(time), verb, MODELS[rng.integers(len(MODELS))], dict(chosen), f"row {len(out)}"))
    return out
