"""Releases: version and changelog change together or not at all, and the zip is what reviewers let pass."""

import tomllib
from datetime import date
from pathlib import Path
from zipfile import ZipFile

import pytest

from tools.release import ReleaseError, documented, notes, rules

ROOT = Path(__file__).resolve().parents[2]
MANIFEST = 'id = "morph_retarget"\nversion = "0.9.0"\nblender_version_min = "4.5.0"\n'
CHANGELOG = "# Changelog\n\n## [Unreleased]\n\n### Added\n\n- Wings.\n\n## [0.9.0] - 2026-01-01\n\n- Legs.\n"


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Return a folder with a version and a changelog."""
    (tmp_path / notes.MANIFEST).write_text(MANIFEST, encoding="utf-8")
    (tmp_path / notes.CHANGELOG).write_text(CHANGELOG, encoding="utf-8")
    return tmp_path


def _texts(root: Path) -> tuple[str, str]:
    return (root / notes.MANIFEST).read_text(encoding="utf-8"), (root / notes.CHANGELOG).read_text(encoding="utf-8")


def test_a_release_raises_the_version_and_dates_what_was_unreleased(repository: Path) -> None:
    with notes.dated(repository, "1.0.0") as version:
        assert version == "1.0.0"
    manifest, changelog = _texts(repository)
    assert notes.of(manifest) == "1.0.0"
    assert 'blender_version_min = "4.5.0"' in manifest
    today = date.today().isoformat()
    assert f"## [Unreleased]\n\n## [1.0.0] - {today}\n\n### Added\n\n- Wings.\n\n## [0.9.0]" in changelog


def test_a_release_that_fails_changes_nothing(repository: Path) -> None:
    with pytest.raises(ReleaseError), notes.dated(repository, "1.0.0"):
        raise ReleaseError("the zip is broken")
    assert _texts(repository) == (MANIFEST, CHANGELOG)


def test_a_rehearsal_changes_nothing(repository: Path) -> None:
    with notes.dated(repository, None) as version:
        assert version == "0.9.0"
    assert _texts(repository) == (MANIFEST, CHANGELOG)


@pytest.mark.parametrize("version", ["0.8.9", "1.0", "one", "0.9.0"])
def test_versions_that_cannot_be_are_refused(version: str, repository: Path) -> None:
    with pytest.raises(ReleaseError, match=version), notes.dated(repository, version):
        pass
    assert _texts(repository) == (MANIFEST, CHANGELOG)


def test_nothing_is_released_that_the_changelog_does_not_tell_of(repository: Path) -> None:
    (repository / notes.CHANGELOG).write_text("# Changelog\n\n## [Unreleased]\n\n## [0.9.0]\n\n- Legs.\n")
    with pytest.raises(ReleaseError, match="tells nothing"), notes.dated(repository, "1.0.0"):
        pass


def test_our_own_manifest_and_code_pass_the_rules() -> None:
    manifest = tomllib.loads((ROOT / notes.MANIFEST).read_text(encoding="utf-8"))
    assert not list(rules.manifest_problems(manifest))
    files = [ROOT / "__init__.py", *sorted((ROOT / rules.PACKAGE).rglob("*.py"))]
    found = [
        told
        for path in files
        for told in rules.code_problems(path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8"))
    ]
    assert not found


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("import socket", "network"),
        ("from urllib import request", "network"),
        ("from morph_retarget.core import quat", "relatively"),
        ("import subprocess", "workers"),
        ("import pickle", "reviewed"),
        ("import sys\nsys.path.append('.')", "sys.path"),
        ("eval('1')", "executed"),
        ("bl_info = {}", "manifest"),
        ("place = __file__", "extension_path_user"),
    ],
)
def test_what_reviewers_object_to_is_told(code: str, told: str) -> None:
    (problem,) = rules.code_problems("morph_retarget/new.py", code)
    assert problem.startswith("morph_retarget/new.py:")
    assert told in problem


def test_a_zip_holds_no_caches_and_has_a_licence(tmp_path: Path) -> None:
    built = tmp_path / "built.zip"
    manifest = (ROOT / notes.MANIFEST).read_text(encoding="utf-8")
    with ZipFile(built, "w") as zipped:
        for name in ("__init__.py", "morph_retarget/__pycache__/a.pyc", ".cache/x", "blender_manifest.toml"):
            zipped.writestr(name, manifest if name.endswith("toml") else "")
    with pytest.raises(ReleaseError) as error:
        rules.check(built)
    told = str(error.value).splitlines()
    assert [line.split(":")[0] for line in told] == ["LICENSE", "morph_retarget/__pycache__/a.pyc", ".cache/x"]


def test_the_documentation_s_command_lines_are_run_where_our_samples_suffice() -> None:
    lines = [line for _, line in documented.commands()]
    shown = {line.split()[3] for line in lines}
    assert {"map", "retarget", "batch", "play", "validate"} <= shown
    assert len(lines) == len(set(lines))
    assert not any("character.fbx" in line for line in lines), "what only users have is left out"


def test_a_command_line_that_does_not_work_is_told_with_its_page(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "rig.glb").write_bytes(b"no rig")
    (tmp_path / "README.md").write_text("```sh\npython -m morph_retarget map rig.glb  # what is it?\n```\n")
    monkeypatch.setattr(documented, "ROOT", tmp_path)
    with pytest.raises(ReleaseError, match=r"README.md: python -m morph_retarget map rig.glb"):
        documented.run("false")
    (tmp_path / "README.md").write_text("nothing")
    with pytest.raises(ReleaseError, match="shows no command"):
        documented.run("true")
