"""Makes the pictures of the documentation, from the samples.

``python -m tools.make_pictures [NAME…]`` draws all, or those that are named, with the Python of an environment that has
Blender. Those of panels need a window: `tools.screenshots` takes them.
"""

import os
import sys
from collections.abc import Callable, Mapping, Sequence

from PIL import Image

from . import animation, demo, house, pictures, workings


def _walk_and_wave() -> None:
    """Draw a clip and what two rigs made of it, as the demo does."""
    if demo.main([]):
        sys.exit("the demo has failed: see above")
    with Image.open(demo.OUT / "walk_and_wave.png") as drawn:
        drawn.quantize(160).save(pictures.IMAGES / "walk_and_wave.png", optimize=True)


PICTURES: Mapping[str, Callable[[], None]] = {
    "motion.gif": animation.draw,
    "walk_and_wave.png": _walk_and_wave,
    "generalized.png": pictures.draw_actions,
    "locomotion.png": pictures.draw_locomotion,
    "footfalls.png": pictures.draw_locomotion,
    "directed.png": pictures.draw_directed,
    "validation.png": pictures.draw_validation,
    "solver.png": workings.draw_missed,
    "swivel.png": workings.draw_swivel,
    "house.svg": house.write,
}
"""What draws each."""


def main(chosen: Sequence[str] = ()) -> None:
    """Draw all pictures, or those that are chosen."""
    for draw in dict.fromkeys(PICTURES[name] for name in chosen or PICTURES):
        draw()


if __name__ == "__main__":
    main(sys.argv[1:])
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 as a module may block its end by a thread of its own
