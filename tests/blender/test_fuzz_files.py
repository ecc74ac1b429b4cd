"""Files for Blender and the command line: whatever they hold, they are read or refused with an error of ours."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path

import bpy
import hypothesis
import pytest
from hypothesis import strategies as st

from morph_retarget.blender import bone_maps, templates
from morph_retarget.blender.batch import gates, jobs_file, ledger, plan
from morph_retarget.blender.batch.prints import Prints, beside
from morph_retarget.blender.cli import program
from morph_retarget.blender.directing import scripts
from morph_retarget.blender.io import bvh_check, gltf, load
from morph_retarget.blender.io.load import Request
from morph_retarget.core.errors import MorphError
from tests import fuzzing
from tests.blender.files import Files
from tests.fuzzing import as_text, contents, corpus, fuzzed, refusal, spoilt, values


def _jobs(path: Path) -> None:
    folder = path.parent / "out"
    for item in plan.plan(jobs_file.read(path), folder):
        assert "\n" not in item.name or "\\n" in path.read_text()
        if isinstance(item, plan.Job):
            assert item.out.resolve().is_relative_to(folder.resolve())
            Prints("1").key(item)


def _ledger(path: Path) -> None:
    folder = path.parent / ledger.FOLDER
    folder.mkdir(exist_ok=True)
    (folder / "ledger.jsonl").write_bytes(path.read_bytes())
    with ledger.opened(path.parent, "", resume=True) as record:
        for name in ("a.glb", "b.glb", ""):
            record.ours(name)
            record.whole(name)


def _gltf(path: Path) -> None:
    assert gltf.frame_rate(path) is None or path.stat().st_size
    gltf.compression(path)


READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "bvh": (".bvh", bvh_check.check),
    "jobs": (".toml", _jobs),
    "script": (".toml", lambda path: scripts.load(path, 24.0)),
    "bml": (".bml", lambda path: scripts.load(path, 24.0)),
    "map": (".json", bone_maps.load),
    "ledger": (".jsonl", _ledger),
    "gates": (".txt", lambda path: gates.parse(as_text(path.read_bytes()))),
    "gltf": (".gltf", _gltf),
}
"""By the folders of the corpus: how files are called, and what reads them."""


@pytest.fixture(scope="module")
def place() -> Path:
    """Return a folder with a few things that requests may name."""
    folder = fuzzing.scratch()
    (folder / "clips").mkdir(exist_ok=True)
    for name in ("walk.bvh", "clips/a.bvh", "clips/b.glb", "rig.glb", "acts.blend"):
        (folder / name).write_text("HIERARCHY")
    return folder


def _read(kind: str, place: Path, content: bytes) -> None:
    ending, reader = READERS[kind]
    path = place / f"file{ending}"
    path.write_bytes(content)
    assert refusal(lambda: reader(path)) != ""


@pytest.mark.parametrize("kind", READERS)
def test_what_is_kept_in_the_corpus_is_read_or_refused(kind: str, place: Path) -> None:
    for content in contents(kind):
        _read(kind, place, content)


@pytest.mark.parametrize("kind", READERS)
def test_spoilt_files_are_read_or_refused(kind: str, place: Path) -> None:
    whole = [content for content in contents(kind) if len(content) < 4000]

    @fuzzed(25)
    @hypothesis.given(spoilt(whole))
    def law(content: bytes) -> None:
        _read(kind, place, content)

    law()


@fuzzed(25)
@hypothesis.given(values(("buffers", "uri", "animations", "samplers", "accessors", "input", "min", "max", "count")))
def test_gltf_of_any_form_is_looked_at_and_left_to_blender(data: object) -> None:
    path = fuzzing.scratch() / "any.gltf"
    path.write_text(json.dumps(data))
    _gltf(path)
    list(beside(path))


@fuzzed(25)
@hypothesis.given(
    st.lists(st.sampled_from(["{", "}", "{action}", "{x}", "{0}", "{action:>99999999}", "{action.x}", "a"]))
)
def test_names_with_fields_are_filled_in_or_refused(parts: list[str]) -> None:
    try:
        found = templates.filled("".join(parts), "name", action="{source}", source="b")
    except MorphError:
        return
    assert len(found) <= 8 * len(parts)


@pytest.mark.parametrize("kind", ["bvh", "glb"])
def test_spoilt_clips_are_imported_or_refused(kind: str, files: Files, place: Path) -> None:
    whole = files.clip(kind).read_bytes()
    path = place / f"clip.{kind}"

    @fuzzed(8)
    @hypothesis.given(spoilt([whole, whole[: len(whole) // 2]]))
    def law(content: bytes) -> None:
        path.write_bytes(content)
        said = refusal(lambda: load.load(Request(path)))
        assert said is None or (str(path) in said and "\n" not in said), said

    law()


# --- the command line ---


def _words() -> list[str]:
    lines = corpus("command")[0].read_text().splitlines()
    told = [word for row in lines for word in shlex.split(row)]
    options = [
        name
        for action in program.parser()._subparsers._group_actions
        for sub in action.choices.values()
        for name in sub._option_string_actions
    ]
    return sorted(
        {*told, *options, "-", "--", "", "nan", "-1", "1e999", "0", "🙂", "a=b", "#", "*", "..", "/", "{action}"}
    )


@pytest.fixture
def _here(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(place)


@pytest.mark.usefixtures("_here")
def test_requests_of_any_form_are_refused_in_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    words = st.sampled_from(_words()) | st.text(max_size=3)
    rows = [shlex.split(row) for row in corpus("command")[0].read_text().splitlines()]
    spoiled = st.tuples(st.sampled_from(rows), st.lists(st.tuples(st.integers(0, 30), words), max_size=4))

    def changed(row: list[str], changes: list[tuple[int, str]]) -> list[str]:
        out = list(row)
        for at, word in changes:
            out[at % len(out)] = word
        return out

    commands = ("map", "retarget", "play", "batch", "validate")
    free = st.builds(lambda first, rest: [first, *rest], st.sampled_from(commands), st.lists(words, max_size=6))

    @fuzzed(40)
    @hypothesis.given(spoiled.map(lambda own: changed(*own)) | free)
    def law(argv: list[str]) -> None:
        hypothesis.assume(not argv or argv[0] != "worker")
        bpy.ops.wm.read_homefile(use_empty=True)
        status = program.main(argv)
        out, errors = capfd.readouterr()
        helped = out.startswith("usage:")
        assert status == (0 if helped else 2), (argv, out, errors)
        assert helped or len(errors.splitlines()) == 1, (argv, errors)

    law()
    assert not (fuzzing.scratch() / "out").exists()
