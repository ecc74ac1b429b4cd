"""Readers of files and texts: whatever they are given, they read it or refuse it with an error of ours."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path

import hypothesis
import pytest
from hypothesis import strategies as st

from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.bone_maps.placing import place
from morph_retarget.core.character.bone_maps.reading import read
from morph_retarget.core.character.character import Character
from morph_retarget.core.clips.commands import bml, line, script
from morph_retarget.core.clips.motions import annotation_data, library_file
from morph_retarget.core.directing.starter import starter
from morph_retarget.core.morph import channel_file
from morph_retarget.core.validation import grid
from tests import fuzzing
from tests.fuzzing import as_text, contents, fuzzed, refusal, spoilt, values
from tests.skeletons import skeleton_of
from tools.figure import humanoid

READERS: dict[str, Callable[[str], object]] = {
    "map": lambda text: place(read(text, "file"), _figure()),
    "channels": lambda text: channel_file.parse(text, "file"),
    "script": lambda text: script.read(text, "file"),
    "bml": lambda text: bml.read(text, "file"),
    "annotations": lambda text: annotation_data.from_data(_plain(text), "file"),
}
"""By the folders of the corpus."""
WORDS = {
    "map": (
        "joints",
        "hips",
        "bone",
        "leftHand",
        "format",
        "bones",
        "SourceBoneName",
        "DestinationBoneName",
        "mappings",
        "source",
        "target",
        "rokoko_custom_names",
        "hip",
        "custom_bone_a",
    ),
    "channels": ("format", "channels", "name", "context", "capability", "position", "weight", "hand"),
    "annotations": ("kind", "strikes", "strokes", "parts", "speed", "phase", "parameters", "side", "walk"),
}
"""That readers of plain data look for."""


@cache
def _figure() -> Character:
    return analyze(skeleton_of(humanoid()))


def _plain(text: str) -> object:
    """Return the data of a text; that of annotations is always read by others, which say what is wrong."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return text


def _read(kind: str, text: str) -> None:
    said = refusal(lambda: READERS[kind](text))
    assert said is None or "\n" not in said or "\n" in text, said


@pytest.mark.parametrize("kind", READERS)
def test_what_is_kept_in_the_corpus_is_read_or_refused(kind: str) -> None:
    for content in contents(kind):
        _read(kind, as_text(content))


@pytest.mark.parametrize("kind", READERS)
def test_spoilt_texts_are_read_or_refused(kind: str) -> None:
    @fuzzed(25)
    @hypothesis.given(spoilt([content for content in contents(kind) if len(content) < 4000]))
    def law(content: bytes) -> None:
        _read(kind, as_text(content))

    law()


@pytest.mark.parametrize("kind", WORDS)
def test_plain_data_of_any_form_are_read_or_refused(kind: str) -> None:
    @fuzzed(25)
    @hypothesis.given(values(WORDS[kind]))
    def law(data: object) -> None:
        _read(kind, json.dumps(data))

    law()


@fuzzed(40)
@hypothesis.given(st.text(alphabet="startopwlk =\"'.,()[]-0123456789\\é\x00", max_size=30))
def test_lines_of_commands_are_read_or_refused(text: str) -> None:
    refusal(lambda: line.parse(text))


@cache
def _library() -> bytes:
    return library_file.encoded(starter(_figure(), ["wave"]))


@fuzzed(40)
@hypothesis.given(st.data())
def test_spoilt_libraries_are_read_or_refused(data: st.DataObject) -> None:
    content = data.draw(spoilt([_library(), *contents("library")]))
    said = refusal(lambda: library_file.decoded(content, "file"))
    assert said is None or said.startswith("file: ")


@fuzzed(25)
@hypothesis.given(st.data())
def test_reports_of_any_form_are_compared_or_refused(data: st.DataObject) -> None:
    words = ("cells", "action", "character", "status", "passed")
    text = data.draw(spoilt(contents("report")) | values(words).map(lambda own: json.dumps(own).encode()))
    path = Path(fuzzing.scratch(), "report.json")
    path.write_bytes(text)
    said = refusal(lambda: grid.earlier(path))
    assert said is None or str(path) in said
