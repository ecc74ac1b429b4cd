"""Running the command lines that the documentation shows, as somebody does who copies them from it."""

import os
import re
import shlex
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from . import ReleaseError

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = "sample_blends"
PROGRAM = ("python", "-m", "morph_retarget")
WRITTEN = ("-o", "--out", "--report", "--json")
"""What stands after these is written, and need not be there before."""
INPUTS = (".blend", ".bvh", ".fbx", ".glb", ".gltf", ".vrm", ".toml", ".bml")
SECONDS = 300
_SHELL = re.compile(r"```sh\n(.*?)```", re.DOTALL)


def commands() -> Iterator[tuple[Path, str]]:
    """Yield each command line that our own samples suffice for, once, with the page that shows it."""
    seen = set[str]()
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))):
        for block in _SHELL.findall(page.read_text(encoding="utf-8")):
            for line in block.replace("\\\n", " ").splitlines():
                words = shlex.split(line, comments=True)
                known = " ".join(line.split())
                if tuple(words[:3]) == PROGRAM and _can_be_run(words[3:]) and known not in seen:
                    seen.add(known)
                    yield page, known


def _can_be_run(words: list[str]) -> bool:
    """Return whether all that a command line reads is there."""
    read = [word for before, word in zip(["", *words], words, strict=False) if before not in WRITTEN]
    files = [word.partition("#")[0] for word in read if word.partition("#")[0].endswith(INPUTS)]
    return bool(files) and all(any(ROOT.glob(name)) for name in files)


def run(python: str) -> None:
    """Run all of them, each in an empty folder that has the samples.

    Args:
        python: Of an environment that has Blender.

    Raises:
        ReleaseError: One of them does not do what it is there for, or there is none.
    """
    count = 0
    for page, line in commands():
        with tempfile.TemporaryDirectory() as folder:
            _run(python, page, line, Path(folder))
        count += 1
    if not count:
        raise ReleaseError("the documentation shows no command that could be run: look at tools/release/documented.py")
    print(f"{count} command lines of the documentation do what they are there for")


def _run(python: str, page: Path, line: str, folder: Path) -> None:
    (folder / SAMPLES).symlink_to(ROOT / SAMPLES)
    (folder / "out").mkdir()
    command = line.replace(PROGRAM[0], shlex.quote(python), 1)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=SECONDS
    )
    if done.returncode:
        raise ReleaseError(f"{page.relative_to(ROOT)}: {line}: {(done.stderr or done.stdout).strip()[-600:]}")
