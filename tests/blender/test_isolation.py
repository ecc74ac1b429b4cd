"""What is never done, whatever files say: no network, no code of theirs, nothing written where nobody asked for it."""

import ast
import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path

import bpy
import pytest

from morph_retarget.blender.cli import program
from morph_retarget.blender.cli.outputs import Outputs
from tests.blender import scenes
from tests.blender.files import Files

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "morph_retarget"
NETWORK = {
    "aiohttp", "asyncio", "ftplib", "http", "imaplib", "multiprocessing", "nntplib", "poplib", "requests", "smtplib",
    "socket", "socketserver", "ssl", "telnetlib", "urllib", "urllib3", "webbrowser", "xmlrpc",
}  # fmt: skip
ALLOWED = {"urllib.parse"}
EXECUTES = {"eval", "exec", "compile", "__import__"}
"""Builtins that make code of text."""


@cache
def _modules() -> list[tuple[Path, list[ast.AST]]]:
    """Return all modules with their imports, calls and arguments given by name."""
    kinds = ast.Import | ast.ImportFrom | ast.Call | ast.keyword
    trees = ((path, ast.parse(path.read_text(encoding="utf-8"))) for path in sorted(PACKAGE.rglob("*.py")))
    return [(path, [node for node in ast.walk(tree) if isinstance(node, kinds)]) for path, tree in trees]


def _imported(nodes: list[ast.AST]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module or ""


def test_nothing_that_speaks_to_a_network_is_imported() -> None:
    for path, nodes in _modules():
        for name in _imported(nodes):
            assert name in ALLOWED or name.partition(".")[0] not in NETWORK, f"{path} imports {name}"


def test_no_text_is_made_into_code() -> None:
    for path, nodes in _modules():
        for node in nodes:
            if isinstance(node, ast.Call):
                called = node.func.id if isinstance(node.func, ast.Name) else ""
                assert called not in EXECUTES, f"{path}:{node.lineno} calls {called}"
                named = node.func.attr if isinstance(node.func, ast.Attribute) else ""
                assert named not in {"system", "popen", "url_open", "python_file_run"}, path
            if isinstance(node, ast.keyword) and node.arg in {"shell", "allow_pickle", "use_scripts"}:
                assert isinstance(node.value, ast.Constant), path
                assert node.value.value is False, f"{path}:{node.value.lineno} sets {node.arg}"
        assert not {name.partition(".")[0] for name in _imported(nodes)} & {"pickle", "marshal", "shelve"}, path


# --- tried ---

GUARD = """
import os, sys
CALLS = {f"socket.{name}" for name in ("connect", "getaddrinfo", "gethostbyname", "sendto", "sendmsg", "getnameinfo")}
def guard(event, arguments):
    # Blender's own copy of urllib3 makes a socket to learn of IPv6, and binds it to this machine.
    if event.partition(".")[0] in ("ftplib", "urllib", "http", "smtplib", "webbrowser") or event in CALLS:
        os.write(2, f"NETWORK {event} {arguments!r}".encode())
        os._exit(99)
    if event in ("os.system", "os.exec", "os.posix_spawn", "subprocess.Popen"):
        os.write(2, f"PROCESS {event} {arguments!r}".encode())
        os._exit(98)
sys.addaudithook(guard)
import socket
try:
    socket.create_connection(("127.0.0.1", 9))
except BaseException:
    pass
"""


def _run(guard: str, *commands: Sequence[object]) -> "subprocess.CompletedProcess[str]":
    """Run command lines in a process in which forbidden things end it; Blender 4.5 as a module may never end."""
    ending = "status = max(map(program.main, json.loads(sys.argv[1])))\nsys.stdout.flush()\nos._exit(status)"
    code = f"{guard}\nimport json, os, sys\nfrom morph_retarget.blender.cli import program\n{ending}"
    return subprocess.run(
        [sys.executable, "-c", code, json.dumps([[str(word) for word in command] for command in commands])],
        cwd=ROOT, env=dict(os.environ), capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip


def test_the_guard_of_these_tests_works() -> None:
    assert _run(GUARD, ["map"]).returncode == 99


def _hostile(path: Path, marker: Path) -> Path:
    """Return a rig whose file holds a text that runs when it is loaded, and drivers that write a file."""
    ob = scenes.figure("Rig")
    code = f"__import__('pathlib').Path({str(marker)!r}).touch()"
    text = bpy.data.texts.new("start.py")
    text.write(code)
    text.use_module = True
    for target, prop in ((ob, "location"), (ob.pose.bones[0], "location")):
        curve = target.driver_add(prop, 0)
        curve.driver.expression = f"({code}, 0.0)[1]"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    return path


def test_a_retarget_needs_no_network_and_runs_nothing_that_a_file_holds(files: Files, tmp_path: Path) -> None:
    marker = tmp_path / "ran"
    scenes.empty()
    rig = _hostile(tmp_path / "rig.blend", marker)
    marker.unlink(missing_ok=True)  # drivers may run here, where the file was made
    out = tmp_path / "out.blend"
    guard = GUARD.partition("import socket")[0]
    given = "retarget", files.clip(), rig, "-o", out, "--report", tmp_path / "report.json"
    done = _run(guard, given, ["map", rig, "--json"])
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("}\n")
    assert not marker.exists()
    assert out.exists()


# --- names that lead away ---


@pytest.mark.parametrize("name", ["../../away", "..", "/etc/away", "a\\..\\b", "C:away", "CON|x", "~/.x", "a/b"])
def test_names_of_actions_and_rigs_lead_nowhere(tmp_path: Path, name: str) -> None:
    out = Outputs(str(tmp_path / "{target}_{action}_{source}.glb"), name, [name]).path(name, name)
    assert out.parent == tmp_path
    assert out.resolve().parent == tmp_path.resolve()


def test_a_batch_writes_into_its_folder_alone(files: Files, tmp_path: Path) -> None:
    """Actions whose names climb, jobs that do, and links that lie where results go."""
    scenes.empty()
    ob = scenes.walker("Actor", action="../../climbed")
    ob.animation_data.action.use_fake_user = True
    clips = scenes.save(tmp_path / "clips.blend")
    out, precious = tmp_path / "out", tmp_path / "precious.bvh"
    out.mkdir()
    precious.write_text("mine")
    (out / "link.bvh").symlink_to(precious)
    jobs = {
        "all": {"source": f"{clips}#*", "out": "{action}.bvh"},
        "link": {"source": str(clips), "out": "link.bvh"},
        "up": {"source": str(clips), "out": "../up.bvh"},
        "root": {"source": str(clips), "out": f"{tmp_path}/root.bvh"},
    }
    rows = ["[defaults]", f"target = {json.dumps(str(files.tall))}"]
    for job in jobs.values():
        rows += ["[[job]]", *(f"{key} = {json.dumps(value)}" for key, value in job.items())]
    (tmp_path / "jobs.toml").write_text("\n".join(rows))
    assert program.main(["batch", str(tmp_path / "jobs.toml"), "--out", str(out), "--overwrite"]) == 1
    assert precious.read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["clips.blend", "jobs.toml", "out", "precious.bvh"]
    assert [path.name for path in out.glob("*climbed*")] == [".._.._climbed.bvh"]
