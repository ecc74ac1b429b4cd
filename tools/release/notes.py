"""Version and changelog: one place of truth for each, changed together or not at all."""

import contextlib
import re
from collections.abc import Iterator
from datetime import date
from pathlib import Path

from . import ReleaseError

MANIFEST, CHANGELOG = "blender_manifest.toml", "CHANGELOG.md"
_VERSION = re.compile(r'^version = "(.*)"$', re.MULTILINE)
_COMING = "## [Unreleased]"


@contextlib.contextmanager
def dated(root: Path, version: str | None) -> Iterator[str]:
    """Give the repository a new version for a while, and for good if nothing goes wrong within; yield it.

    Args:
        root: Of the repository.
        version: The new one, higher than the present one; None changes nothing.

    Raises:
        ReleaseError: The version is no such one, or the changelog has nothing to tell.
    """
    manifest, changelog = root / MANIFEST, root / CHANGELOG
    before = {path: path.read_text(encoding="utf-8") for path in (manifest, changelog)}
    if version is None:
        yield of(before[manifest])
        return
    manifest.write_text(raised(before[manifest], version), encoding="utf-8")
    try:
        changelog.write_text(released(before[changelog], version, date.today()), encoding="utf-8")
        yield version
    except BaseException:
        for path, text in before.items():
            path.write_text(text, encoding="utf-8")
        raise


def of(manifest: str) -> str:
    """Return the version that a manifest tells.

    Raises:
        ReleaseError: It tells none.
    """
    found = _VERSION.search(manifest)
    if found is None:
        raise ReleaseError(f'{MANIFEST}: has no version: write version = "1.0.0"')
    return found[1]


def raised(manifest: str, version: str) -> str:
    """Return a manifest with a new version.

    Raises:
        ReleaseError: The version is not higher than the present one.
    """
    old = of(manifest)
    if _numbers(version) < _numbers(old):
        raise ReleaseError(f"{version}: is lower than the present version {old}: choose a higher one")
    return _VERSION.sub(f'version = "{version}"', manifest)


def released(changelog: str, version: str, day: date) -> str:
    """Return a changelog in which what was unreleased belongs to a version of some day.

    Raises:
        ReleaseError: Nothing is unreleased, or the version is there already.
    """
    told(changelog)
    if f"## [{version}]" in changelog:
        raise ReleaseError(f"{CHANGELOG}: tells of {version} already: choose a higher version")
    return changelog.replace(_COMING, f"{_COMING}\n\n## [{version}] - {day.isoformat()}", 1)


def told(changelog: str) -> str:
    """Return what a changelog tells of the next release.

    Raises:
        ReleaseError: It tells nothing.
    """
    _, found, after = changelog.partition(f"{_COMING}\n")
    text = after.split("\n## [", 1)[0].strip()
    if not found or not any(line.startswith("- ") for line in text.splitlines()):
        raise ReleaseError(f"{CHANGELOG}: tells nothing under {_COMING!r}: write what users will see")
    return text


def _numbers(version: str) -> tuple[int, ...]:
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise ReleaseError(f"{version}: is no version: write it as 1.2.0")
    return tuple(map(int, version.split(".")))
