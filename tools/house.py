"""The drawing of the house: who calls whom, as an SVG; ``python -m tools.house`` writes `docs/images/house.svg`."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

PATH = Path(__file__).resolve().parent.parent / "docs" / "images" / "house.svg"
WIDTH, ROW, GAP = 860, 58, 14
"""Of the drawing, height of a box and room between rows [px]."""
_STYLES = {"edge": "#dfe7ee", "blender": "#f3dcc0", "core": "#d3e6d2"}
"""Fill of the boxes, by where they are."""
Box = tuple[str, str]
"""Name and what is there."""
ROWS: Sequence[tuple[str, str, Sequence[Box]]] = (
    (
        "edge",
        "what users touch, in morph_retarget/blender",
        (
            ("ui/ operators/", "tab, buttons, bpy.ops"),
            ("cli/ batch/", "the command line, workers"),
            ("live.py handlers.py", "while frames change"),
        ),
    ),
    (
        "blender",
        "what does it, in morph_retarget/blender; nothing below these knows bpy",
        (
            ("retarget.py", "a clip onto a rig"),
            ("morph/", "actions, live, baked"),
            ("locomotion/", "where they go"),
            ("directing/", "commands, libraries"),
            ("validation/", "cells and pages"),
        ),
    ),
    (
        "blender",
        "",
        (
            ("rig.py sampling.py", "armatures and clips, read"),
            ("actions.py channels.py keying.py", "keys, written in bulk"),
            ("io/", "files, whole or not at all"),
        ),
    ),
    (
        "core",
        "mathematics, in morph_retarget/core: NumPy alone, all frames of a clip in one batch",
        (
            ("pipeline.py", "transfer, feet, root"),
            ("play.py", "goals, pose, jiggles"),
            ("directing/", "commands to motion"),
            ("verdicts/ validation/", "what is good, the grid"),
        ),
    ),
    (
        "core",
        "",
        (
            ("mocap/", "alignment, contacts"),
            ("morph/", "contexts, modes, binding"),
            ("locomotion/", "courses, gaits, steps"),
            ("clips/", "operators, models, behaviours"),
        ),
    ),
    (
        "core",
        "",
        (
            ("character/", "what a rig is: joints, limbs, sides"),
            ("solve/", "goals to poses: particle IK, limits, jiggles"),
            ("skeleton tree quat", "bodies and turns"),
        ),
    ),
)
"""From above to below; what stands higher calls what stands lower."""


def drawing() -> str:
    """Return the SVG."""
    parts: list[str] = []
    y = 8
    for kind, title, boxes in ROWS:
        if title:
            parts.append(f'<text x="12" y="{y + 16}" class="title">{escape(title)}</text>')
            y += 24
        width = (WIDTH - 24 - GAP * (len(boxes) - 1)) / len(boxes)
        for i, (name, told) in enumerate(boxes):
            x = 12 + i * (width + GAP)
            middle = x + width / 2
            parts.append(
                f'<rect x="{x:.0f}" y="{y}" width="{width:.0f}" height="{ROW}" rx="6" fill="{_STYLES[kind]}"/>'
                f'<text x="{middle:.0f}" y="{y + 25}" class="name">{escape(name)}</text>'
                f'<text x="{middle:.0f}" y="{y + 44}" class="told">{escape(told)}</text>'
            )
        y += ROW + GAP
    style = (
        "text{font-family:sans-serif;fill:#222}.name{font:600 13px monospace;text-anchor:middle}"
        ".told{font-size:12px;text-anchor:middle}.title{font-size:13px;font-style:italic;fill:#444}"
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y}" width="{WIDTH}" height="{y}">'
        f'<style>{style}</style><rect width="{WIDTH}" height="{y}" rx="8" fill="#fafafa"/>'
        + "\n".join(parts)
        + "</svg>\n"
    )


def write() -> None:
    """Write the drawing."""
    PATH.write_text(drawing(), encoding="utf-8")


if __name__ == "__main__":
    write()
