"""The process that does jobs: requests come as JSON lines on stdin, answers go as JSON lines to stdout.

It ends when stdin does, even in the middle of a job: then whoever asked is gone.
"""

import json
import os
import queue
import sys
import threading
from pathlib import Path
from typing import Any, NoReturn, TextIO

import bpy

from ...core.errors import FileError, MorphError
from ...core.validation import markup
from .. import rig
from ..cli import retargeting
from ..cli.messages import NAME
from ..retarget import Outcome
from . import jobs, pictures

OUT_OF_MEMORY = 77
"""Exit status."""
_MB = 1024 * 1024


def run(memory: int | None) -> NoReturn:
    """Do jobs until stdin ends.

    Args:
        memory: Most memory that the process may use [MB]; None for all there is.

    Raises:
        FileError: It cannot even begin with so little memory.
    """
    answers = _own_stdout()
    _limit(memory)
    requests: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(requests,), daemon=True).start()
    _say(answers, {"ready": os.getpid()})
    while True:
        try:
            _say(answers, _answer(json.loads(requests.get())))
        except MemoryError:
            os._exit(OUT_OF_MEMORY)


def _answer(request: dict[str, Any]) -> dict[str, Any]:
    """Do a job; errors that are no `MorphError` are mistakes of ours, and end the process with their trace."""
    drawings: list[str] = []

    def look(ob: bpy.types.Object, outcome: Outcome) -> None:
        drawings.append(markup.svg(pictures.strip_of(ob, outcome), rig.scene_of().frame_start))

    try:
        done = retargeting.perform(jobs.read_arguments(request["argv"]), request["fresh"], look)
    except MorphError as error:
        return {"error": " ".join(str(error).split())}
    reports = [report | {"warnings": _texts(report["warnings"])} for report in done.reports]
    return {"reports": reports, "files": [str(path) for path in done.files], "drawings": drawings}


def _texts(warnings: Any) -> list[str]:
    return [str(text) for text in warnings]


def _own_stdout() -> TextIO:
    """Return stdout for answers alone; what anything else prints there goes to stderr from now on."""
    sys.stdout.flush()
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return answers


def _say(answers: TextIO, message: dict[str, Any]) -> None:
    answers.write(json.dumps({"morph_retarget": message}) + "\n")
    answers.flush()


def _listen(requests: "queue.SimpleQueue[str]") -> None:
    for line in sys.stdin:
        requests.put(line)
    os._exit(0)


def _limit(memory: int | None) -> None:
    """Let the system refuse memory beyond a limit, where it can.

    Raises:
        FileError: So much is in use already.
    """
    if memory is None:
        return
    try:
        import resource
    except ImportError:  # not on Windows
        return
    statistics, used = Path("/proc/self/statm"), 0
    if statistics.exists():  # on Linux
        used = int(statistics.read_text().split()[5]) * resource.getpagesize() // _MB
    if used >= memory:
        raise FileError(f"--memory {memory}: Blender alone takes {used} MB: allow a few hundred more than that")
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (memory * _MB if most < 0 else min(memory * _MB, most), most))


def command() -> list[str]:
    """Return the command that starts a worker, as this process was started."""
    if bpy.app.module:
        return [sys.executable, "-m", __name__.partition(".blender.")[0]]
    own = sys.argv[: sys.argv.index("--command")] if "--command" in sys.argv else [bpy.app.binary_path, "--background"]
    return [bpy.app.binary_path, *own[1:], "--command", NAME]


def environment() -> dict[str, str]:
    """Return the environment variables of a worker, which finds the package where this process did."""
    own = str(Path(__file__).resolve().parents[__name__.count(".")])
    path = [own, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    return dict(os.environ) | ({"PYTHONPATH": os.pathsep.join(path)} if bpy.app.module else {})
