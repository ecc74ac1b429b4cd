#!/usr/bin/env python3
"""The developer's entrance: sets up what it needs in `.venv` and runs tests, checks, benchmarks, builds and more.

Needs nothing but Python 3.11 or 3.13 with venv and pip.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import venv
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent
PYTHONS = {"4.5": "3.11", "5.0": "3.11", "5.2": "3.13"}
"""Blender version to the Python of its bpy wheel."""
SYSTEM_LIBRARIES = (
    "libgl1 libegl1 libgl1-mesa-dri libx11-6 libxi6 libxrender1 libxfixes3 libxkbcommon0 libsm6 libxxf86vm1"
)


def main() -> int:
    """Run the command that was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    demo = commands.add_parser("demo", help="retarget a clip onto rigs; write a .blend and a contact sheet of each")
    demo.add_argument("clip", nargs="?", help="your own clip (BVH, FBX, GLB, VRM, .blend) instead of the sample")
    demo.add_argument("rig", nargs="?", help="your own rig instead of the samples")
    test = commands.add_parser("test", help="run the tests")
    test.add_argument("--blender", default="default", choices=["default", *PYTHONS, "all"], help="version to test with")
    test.add_argument("pytest", nargs="*", help="passed on to pytest, after --")
    commands.add_parser("check", help="lint and type-check")
    bench = commands.add_parser("bench", help="measure accuracy and speed, print a table")
    bench.add_argument("names", nargs="*", help="which benchmarks; all when none is named")
    bench.add_argument("--json", help="also write the figures to this file")
    bench.add_argument("--blender", default="default", choices=["default", *PYTHONS], help="version to measure with")
    commands.add_parser("docs", help="write the reference anew from the code, and build the site of docs/")
    commands.add_parser("build", help="validate and build the extension, validate the zip")
    release = commands.add_parser("release", help="build the extension, check it, install and try it")
    release.add_argument("version", nargs="?", help="new version, as 1.2.0; none rehearses with the present one")
    release.add_argument("--blender-program", metavar="COMMAND", help="also install and try it in this Blender")
    arguments = parser.parse_args()
    run = {"demo": _demo, "test": _test, "check": _check, "bench": _bench, "docs": _docs, "build": _build}
    return (run | {"release": _release})[arguments.command](arguments)


def _demo(arguments: argparse.Namespace) -> int:
    given = [str(Path(p).absolute()) for p in (arguments.clip, arguments.rig) if p]
    return _run([_blender(_default()), "-m", "tools.demo", *given])


def _test(arguments: argparse.Namespace) -> int:
    versions = list(PYTHONS) if arguments.blender == "all" else [_version(arguments.blender)]
    # As many processes as there are cores; a file stays with one of them, where what it shares is made once.
    given = ["-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder", *arguments.pytest]
    # Code is compiled once, into one folder, so that nothing is written beside it.
    os.environ["PYTHONPYCACHEPREFIX"] = str(ROOT / ".venv" / "compiled")
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    failed = [v for v in versions if _run([_blender(v), "-m", "pytest", *given], f"Blender {v}")]
    if failed:
        print(f"failed with Blender {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


def _check(_: argparse.Namespace) -> int:
    python = _environment("check", sys.executable)
    steps = (["ruff", "check", "."], ["ruff", "format", "--check", "."], ["pyright", "--pythonpath", python])
    return max([_run([python, "-m", *step], " ".join(step[:2])) for step in steps])


def _bench(arguments: argparse.Namespace) -> int:
    extra = ["--json", str(Path(arguments.json).absolute())] if arguments.json else []
    return _run([_blender(_version(arguments.blender)), "-m", "tests.bench", *arguments.names, *extra])


def _docs(_: argparse.Namespace) -> int:
    if _run([_blender(_default()), "-m", "tools.make_reference"], "reference"):
        return 1
    os.environ["NO_MKDOCS_2_WARNING"] = "1"  # of the theme, about a successor of its program
    status = _run([_environment("docs", sys.executable), "-m", "mkdocs", "build", "--strict"], "site")
    if not status:
        print(f"open {ROOT / 'build' / 'site' / 'index.html'}")
    return status


def _build(_: argparse.Namespace) -> int:
    tool = "import sys, bpy; from bl_pkg.bl_extension_cli import cli_extension_handler as e; sys.exit(e(sys.argv[1:]))"
    python, out = _blender(_default()), ROOT / "dist"
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir()
    if _run([python, "-c", tool, "validate", "."]) or _run(
        [python, "-c", tool, "build", "--source-dir", ".", "--output-dir", "dist"]
    ):
        return 1
    built = next(out.glob("*.zip"))
    print(f"built {built.relative_to(ROOT)}")
    return _run([python, "-c", tool, "validate", str(built)])


def _release(arguments: argparse.Namespace) -> int:
    from tools.release import ReleaseError, documented, notes, rules, trying  # only this command needs them

    python = _blender(_default())
    try:
        with notes.dated(ROOT, arguments.version) as version:
            if _build(arguments):
                raise ReleaseError("it cannot be built: see above")
            built = next((ROOT / "dist").glob("*.zip"))
            rules.check(built)
            print("── in an empty profile", flush=True)
            trying.in_module(python, built)
            if arguments.blender_program:
                trying.in_program(arguments.blender_program, built)
            print("── the command lines of the documentation", flush=True)
            documented.run(python)
    except ReleaseError as error:
        print(f"not released, nothing was changed: {error}", file=sys.stderr)
        return 1
    next_steps = "commit it, tag it and upload the zip" if arguments.version else "give it a version to release it"
    print(f"{built.relative_to(ROOT)} of {version} is fit to be released: {next_steps}")
    return 0


def _default() -> str:
    running = f"{sys.version_info.major}.{sys.version_info.minor}"
    return next((v for v, python in PYTHONS.items() if python == running), "5.2")


def _version(asked: str) -> str:
    return _default() if asked == "default" else asked


def _blender(version: str) -> str:
    """Return the Python of the environment with Blender ``version``, set up if it was not."""
    python = _environment(f"blender-{version}", _interpreter(PYTHONS[version]))
    if subprocess.run([python, "-c", "import bpy"], capture_output=True, check=False).returncode:
        sys.exit(f"Blender {version} does not start: on Debian or Ubuntu, apt-get install {SYSTEM_LIBRARIES}")
    return python


def _interpreter(version: str) -> str:
    """Return a Python interpreter of ``version``."""
    if sys.version_info[:2] == tuple(map(int, version.split("."))):
        return sys.executable
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates = [
        shutil.which(f"python{version}"),
        *sorted(map(str, pyenv.glob(f"{version}*/bin/python")), reverse=True),
    ]
    for candidate in filter(None, candidates):
        if (
            subprocess.run([candidate, "-c", "import venv, ensurepip"], capture_output=True, check=False).returncode
            == 0
        ):
            return candidate
    sys.exit(f"Python {version} with venv is needed for this Blender: install it, or name another with --blender")


def _environment(name: str, interpreter: str) -> str:
    """Return the Python of a virtual environment that holds what `requirements/NAME.txt` pins."""
    wanted = ROOT / "requirements" / f"{name}.txt"
    folder = ROOT / ".venv" / name
    python, stamp = folder / "bin" / "python", folder / "requirements.sha256"
    if os.name == "nt":
        python = folder / "Scripts" / "python.exe"
    digest = hashlib.sha256(wanted.read_bytes()).hexdigest()
    if python.exists() and stamp.exists() and stamp.read_text() == digest:
        return str(python)
    print(f"setting up .venv/{name} …", flush=True)
    shutil.rmtree(folder, ignore_errors=True)
    if interpreter == sys.executable:
        venv.create(folder, with_pip=True)
    else:
        subprocess.run([interpreter, "-m", "venv", str(folder)], check=True)
    pip = [
        str(python),
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
        "--no-deps",
        "-r",
        str(wanted),
    ]
    if subprocess.run(pip, check=False).returncode:
        sys.exit(f"pip could not install {wanted.relative_to(ROOT)}: see above")
    stamp.write_text(digest)
    return str(python)


def _run(command: Sequence[str], title: str = "") -> int:
    if title:
        print(f"── {title}", flush=True)
    return subprocess.run(command, cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
