"""Makes `docs/reference/`: pages about options, settings, operators, reports and modules, from the code.

``python -m tools.make_reference`` writes them with the Python of an environment that has Blender. A test compares them
with the code.
"""

import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from morph_retarget.blender import registration

from .reference import commands, modules, operators, options, reports, samples, settings

FOLDER = Path(__file__).resolve().parent.parent / "docs" / "reference"
PAGES: Mapping[str, Callable[[], str]] = {
    "options.md": options.options,
    "settings.md": settings.settings,
    "channels.md": settings.channels,
    "operators.md": operators.operators,
    "commands.md": commands.commands,
    "reports.md": reports.reports,
    "python.md": modules.modules,
    "samples.md": samples.samples,
}
"""What makes each page; most of them need the extension to be registered."""


def main() -> None:
    """Write all pages."""
    registration.register("morph_retarget")
    try:
        FOLDER.mkdir(exist_ok=True)
        for name, make in PAGES.items():
            (FOLDER / name).write_text(make(), encoding="utf-8")
    finally:
        registration.unregister()


def stale() -> list[str]:
    """Return the names of pages that are not as the code says; the extension has to be registered."""
    return [name for name, make in PAGES.items() if _written(FOLDER / name) != make()]


def _written(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


if __name__ == "__main__":
    main()
    sys.stdout.flush()
    os._exit(0)  # Blender 4.5 as a module may block its end by a thread of its own
