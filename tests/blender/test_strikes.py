"""Strikes of feet in real clips: found where they were read by eye."""

from pathlib import Path

from tests.bench import annotations
from tests.blender.imported import Imported


def test_strikes_are_found_within_two_frames_of_where_they_were_read(data: Path, imported: Imported) -> None:
    found = list(annotations.judged(data, imported.open))
    figures = annotations.figures_of(found)
    lines = "\n".join(own.line for own in found)
    assert figures["strikes right"] >= 95.0, lines
    assert figures["strikes too many"] <= 6.0, lines
    assert figures["kinds right"] >= 95.0, lines
