"""Batches: workers that do jobs, what happens when they fail, and what a later run makes of it."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

from morph_retarget.blender.batch import pool
from morph_retarget.blender.batch.jobs import Job
from morph_retarget.blender.batch.pool import Began, Pool, Settings, Task
from morph_retarget.blender.batch.progress import Progress
from morph_retarget.blender.batch.results import Answer, Result, Status
from morph_retarget.core.errors import MorphError
from tests.blender import results
from tests.blender.command import Command, contents, refused
from tests.blender.files import Files

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ["index.html", "junit.xml", "report.json"]

# --- workers that misbehave ---

STAND_IN = """
import json, os, signal, sys, time
print("Blender 0.0")
print(json.dumps({"no": "message"}))
print(json.dumps({"morph_retarget": {"ready": os.getpid()}}), flush=True)
for line in sys.stdin:
    request = json.loads(line)
    source, out = request["argv"][0], request["argv"][2].removeprefix("--out=")
    folder = os.path.dirname(out)
    open(os.path.join(folder, f".{os.getpid()}.0.glb"), "w").close()
    if "crash" in source:
        os.kill(os.getpid(), signal.SIGSEGV)
    if "killed" in source:
        os.kill(os.getpid(), signal.SIGKILL)
    if "hang" in source:
        time.sleep(600)
    if "trip" in source:
        raise ValueError("tripped")
    if "full" in source:
        raise MemoryError
    os.unlink(os.path.join(folder, f".{os.getpid()}.0.glb"))
    told = {"error": "no clip"} if "bad" in source else {"reports": [{"worker": os.getpid()}], "files": [out]}
    print(json.dumps({"morph_retarget": told}), flush=True)
"""
"""Does what the name of the clip says."""


def _pool(folder: Path, names: list[str], count: int = 2, **options: object) -> list[Result]:
    folder.mkdir(exist_ok=True)
    tasks = [Task(Job(Path(n), None, Path("rig"), folder / f"{n}.glb", n, {}, (n, "rig"))) for n in names]
    settings = Settings([sys.executable, "-c", STAND_IN], count, **options)
    found = [event for event in Pool(tasks, settings).run() if isinstance(event, Result)]
    assert sorted(result.job.name for result in found) == sorted(names)
    assert list(folder.iterdir()) == []
    return sorted(found, key=lambda result: names.index(result.job.name))


def test_workers_do_many_jobs_each(tmp_path: Path) -> None:
    found = _pool(tmp_path, [f"walk{i}" for i in range(12)])
    assert {result.answer.status for result in found} == {Status.OK}
    assert len({result.answer.reports[0]["worker"] for result in found}) <= 2


def test_workers_are_renewed_now_and_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pool, "RENEWED_AFTER", 3)
    found = _pool(tmp_path, [f"walk{i}" for i in range(7)], 1)
    assert {result.answer.status for result in found} == {Status.OK}
    assert len({result.answer.reports[0]["worker"] for result in found}) == 3


@pytest.mark.parametrize(
    ("what", "status", "told"),
    [
        ("bad", Status.FAILED, "no clip"),
        ("crash", Status.CRASHED, "SIGSEGV"),
        ("killed", Status.CRASHED, "memory"),
        ("full", Status.CRASHED, "--memory"),
        ("trip", Status.CRASHED, "ValueError: tripped"),
        ("hang", Status.TIMEOUT, "--timeout"),
    ],
)
def test_a_bad_job_costs_only_itself(tmp_path: Path, what: str, status: Status, told: str) -> None:
    found = _pool(tmp_path, ["a", what, "b", "c"], 1, timeout=1.0 if what == "hang" else None)
    assert [result.answer.status for result in found] == [Status.OK, status, Status.OK, Status.OK]
    assert told in found[1].answer.error
    assert "\n" not in found[1].answer.error


def test_workers_that_do_not_start_are_an_error(tmp_path: Path) -> None:
    task = Task(Job(Path("a"), None, Path("b"), tmp_path / "c.glb", "c", {}, ("a", "b")))
    for command in ([sys.executable, "-c", "raise SystemExit('no Blender here')"], [str(tmp_path / "none")]):
        with pytest.raises(MorphError, match="no worker starts"):
            list(Pool([task], Settings(command)).run())


def test_workers_end_with_the_one_who_asks(tmp_path: Path) -> None:
    task = Task(Job(Path("hang"), None, Path("b"), tmp_path / "c.glb", "c", {}, ("a", "b")))
    events = Pool([task], Settings([sys.executable, "-c", STAND_IN])).run()
    began = next(event for event in events if isinstance(event, Began))
    assert _runs(began.worker)
    events.close()
    assert not _runs(began.worker)


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{process}/stat")
    return not state.exists() or state.read_text().rpartition(")")[2].split()[0] != "Z"


def test_progress_is_told_in_plain_lines_where_there_is_no_terminal(tmp_path: Path) -> None:
    stream = io.StringIO()
    progress = Progress(3, stream)
    job = Job(tmp_path, None, tmp_path, tmp_path, "walk.glb", {}, ("a", "b"))
    progress.ended(Result(job, Answer(Status.OK)))
    progress.ended(Result(job, Answer(Status.CRASHED, "it\nended")))
    progress.close()
    assert stream.getvalue() == "morph_retarget: crashed: walk.glb: it ended\n"


# --- with Blender ---


@pytest.fixture
def clips(files: Files, tmp_path: Path) -> Path:
    """Return a folder with two clips, one of them in a folder, and a file that is none."""
    folder = tmp_path / "clips"
    (folder / "deep").mkdir(parents=True)
    shutil.copy(files.clip(), folder / "walk.bvh")
    shutil.copy(files.clip("glb"), folder / "deep" / "walk.glb")
    (folder / "deep" / "broken.bvh").write_text("HIERARCHY\n")
    return folder


def _report(out: Path) -> dict[str, dict[str, object]]:
    return {entry["name"]: entry for entry in json.loads((out / "report.json").read_text())["jobs"]}


def _statuses(out: Path) -> dict[str, object]:
    return {name: entry["status"] for name, entry in _report(out).items()}


def _visible(out: Path) -> list[str]:
    return sorted(name for name, data in contents(out).items() if data is not None and not name.startswith("."))


def test_a_folder_of_clips_becomes_a_folder_of_results(cli: Command, files: Files, clips: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    batch = ("batch", clips, "--on", files.sprout, "--out", out, "--fail-on", "joints<5")
    names = ["sprout/deep/broken.glb", "sprout/deep/walk.glb", "sprout/walk.glb"]
    said = cli(*batch, "--jobs", 2)
    assert said.status == 1
    assert said.out.startswith("3 jobs in ")
    assert said.out.count("\n") == 1
    assert any("failed: sprout/deep/broken.glb: " in line for line in said.errors)
    assert _visible(out) == [*REPORTS, *names[1:]]
    assert _statuses(out) == dict(zip(names, ["failed", "ok", "ok"], strict=True))
    assert Xml.parse(out / "junit.xml").getroot().attrib["failures"] == "1"
    assert results.reload(out / names[2]).animation_data.action is not None
    measures = _report(out)[names[2]]["measures"]
    assert len(measures) == 1
    assert measures[0]["foot_slide_m_per_s"]["target"] < 1.0

    # Nothing is replaced unless it is asked for.
    before = contents(out)
    refused(cli, out, *batch, names="--overwrite")
    assert contents(out) == before

    # Going on does what has changed, and nothing else; what was changed by hand stays.
    times = {name: (out / name).stat().st_mtime_ns for name in names[1:]}
    shutil.copy(files.clip(), clips / "deep" / "broken.bvh")
    (out / names[2]).write_text("by hand")
    assert cli(*batch, "--resume").status == 1
    assert _statuses(out) == dict(zip(names, ["ok", "skipped", "failed"], strict=True))
    assert (out / names[1]).stat().st_mtime_ns == times[names[1]]
    assert (out / names[2]).read_text() == "by hand"
    assert "is not what a run wrote" in str(_report(out)[names[2]]["error"])

    # Other gates are another judgement on the same results.
    (out / names[2]).write_bytes(before[names[2]] or b"")
    assert cli(*batch, "--resume", "--fail-on", "joints<500").status == 1
    assert set(_statuses(out).values()) == {"failed"}
    assert cli(*batch, "--resume").status == 0
    assert set(_statuses(out).values()) == {"skipped"}


def test_a_file_of_jobs_takes_all_actions(cli: Command, files: Files, tmp_path: Path) -> None:
    shutil.copy(files.clips, tmp_path / "clips.blend")
    shutil.copy(files.tall_glb, tmp_path / "tall.glb")
    jobs, out = tmp_path / "jobs.toml", tmp_path / "out"
    job = '[[job]]\nsource = "clips.blend#*"\ntarget = "*.glb"\nout = '
    jobs.write_text(f'{job}"{{target}}_{{action}}.bvh"\n{job}"kept_{{action}}.bvh"\n')
    out.mkdir()
    (out / "kept_March.bvh").write_text("mine")
    assert cli("batch", jobs, "--out", out).status == 1
    done, kept = _report(out).values()
    assert done["status"] == "ok", done
    assert sorted(done["files"]) == ["tall_March.bvh", "tall_Stroll.bvh"]
    # A result whose name is known when its action is: nor is that replaced.
    assert kept["status"] == "failed"
    assert (out / "kept_March.bvh").read_text() == "mine"
    assert [name for name in _visible(out) if name.endswith(".bvh")] == ["kept_March.bvh", *done["files"]]


def test_workers_with_too_little_time_leave_nothing(cli: Command, files: Files, clips: Path, tmp_path: Path) -> None:
    shutil.rmtree(clips / "deep")
    assert cli("batch", clips, "--on", files.sprout, "--out", tmp_path / "out", "--timeout", 0.001).status == 1
    assert _statuses(tmp_path / "out") == {"sprout/walk.glb": "timeout"}
    assert _visible(tmp_path / "out") == REPORTS


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory hold on Linux")
def test_too_little_memory_to_begin_with_is_told(
    cli: Command, files: Files, clips: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pool, "_TRIES", 1)
    said = cli("batch", clips, "--on", files.sprout, "--out", tmp_path / "out", "--memory", 1)
    assert said.status == 2
    assert "Blender alone takes" in said.errors[-1]
    assert _visible(tmp_path / "out") == []


def test_a_run_that_was_killed_goes_on(cli: Command, files: Files, tmp_path: Path) -> None:
    clips, out = tmp_path / "clips", tmp_path / "out"
    clips.mkdir()
    for i in range(4):
        shutil.copy(files.clip(), clips / f"walk{i}.bvh")
    batch = ["batch", str(clips), "--on", str(files.sprout), "--out", str(out), "--files", "{source}.glb"]
    started, record = _begun(batch, out)
    started.send_signal(signal.SIGKILL)
    started.communicate()
    entries = list(_entries(record))
    done = {entry["job"] for entry in entries if entry["state"] == "done"}
    times = {name: (out / name).stat().st_mtime_ns for name in done}
    _check_workers_end(entries)

    said = cli(*batch, "--resume")
    assert said.status == 0, said
    names = [f"walk{i}.glb" for i in range(4)]
    assert list(_statuses(out)) == names
    assert {name for name, status in _statuses(out).items() if status == "skipped"} >= done
    assert all((out / name).stat().st_mtime_ns == stamp for name, stamp in times.items())
    assert _visible(out) == sorted([*REPORTS, *names])
    assert [path.name for path in out.iterdir() if path.name.startswith(".")] == [".morph_retarget"]


def test_a_run_that_is_stopped_ends_its_workers_and_tells_what_it_did(
    cli: Command, files: Files, tmp_path: Path
) -> None:
    clips, out = tmp_path / "clips", tmp_path / "out"
    clips.mkdir()
    for i in range(40):
        shutil.copy(files.clip(), clips / f"walk{i:02}.bvh")
    batch = ["batch", str(clips), "--on", str(files.sprout), "--out", str(out), "--files", "{source}.glb"]
    started, record = _begun(batch, out)
    started.send_signal(signal.SIGINT)
    started.send_signal(signal.SIGINT)  # impatience changes nothing
    _, said = started.communicate()
    assert started.returncode == 1
    assert "go on with --resume" in said
    assert "Traceback" not in said
    _check_workers_end(list(_entries(record)))
    statuses = list(_statuses(out).values())
    assert len(statuses) == 40
    assert set(statuses) == {"ok", "stopped"}
    assert int(Xml.parse(out / "junit.xml").getroot().attrib["errors"]) == statuses.count("stopped")
    assert _visible(out) == sorted([*REPORTS, *(name for name, was in _statuses(out).items() if was == "ok")])
    for path in sorted(clips.iterdir())[statuses.count("ok") + 2 :]:
        path.unlink()
    assert cli(*batch, "--resume").status == 0
    assert list(_statuses(out).values()).count("skipped") >= statuses.count("ok")


def _begun(batch: list[str], out: Path) -> tuple["subprocess.Popen[str]", Path]:
    """Return a batch as a process of its own that has done a job, and the record of it."""
    started = subprocess.Popen(
        [sys.executable, "-m", "morph_retarget", *batch],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    record = out / ".morph_retarget" / "ledger.jsonl"
    while started.poll() is None and sum(entry["state"] == "done" for entry in _entries(record)) < 1:
        time.sleep(0.05)
    return started, record


def _check_workers_end(entries: list[dict[str, object]]) -> None:
    for worker in {entry["worker"] for entry in entries if entry["state"] == "begun"}:
        until = time.monotonic() + 20.0
        while _runs(worker) and time.monotonic() < until:
            time.sleep(0.02)
        assert not _runs(worker), "a worker whose batch is gone ends by itself"


def _entries(record: Path) -> Iterator[dict[str, object]]:
    lines = record.read_text().split("\n")[:-1] if record.exists() else []
    yield from map(json.loads, lines)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["none", "--out", "out"], "no such file or folder"),
        (["clips", "--out", "out"], "--on"),
        (["clips", "--on", "none.glb", "--out", "out"], "none.glb"),
        (["clips", "--on", "rig.blend", "--out", "clips/out"], "whose clips are read"),
        (["clips", "--on", "rig.blend", "--out", "rig.blend"], "is no folder"),
        (["clips", "--on", "rig.blend", "--out", "out", "--files", "../{source}.glb"], "leads out"),
        (["clips", "--on", "rig.blend", "--out", "out", "--files", "{source}.glb", "--fail-on", "x>1"], "slide"),
        (["clips", "--on", "rig.blend", "--out", "out", "--chunk", "3/2"], "1/4"),
        (["clips", "--on", "rig.blend", "--out", "out", "--reference", "soon"], "soon"),
        (["clips", "--on", "rig.blend", "--out", "out", "--map", "none.json"], "none.json"),
        (["jobs.toml", "--out", "out", "--fps", "30"], "--fps"),
        (["jobs.toml", "--out", "out", "--on", "rig.blend"], "--on"),
        (["jobs.toml", "--out", "out"], "jobs.toml:2"),
        (["rig.blend", "--out", "out"], "rig.blend"),
    ],
)
def test_what_cannot_be_meant_is_refused_before_anything_starts(
    cli: Command,
    files: Files,
    clips: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    arguments: list[str],
    told: str,
) -> None:
    assert clips.is_dir()
    shutil.copy(files.sprout, tmp_path / "rig.blend")
    (tmp_path / "jobs.toml").write_text('[[job]]\nsource = "none*"\ntarget = "rig.blend"\n')
    before = contents(tmp_path)
    monkeypatch.chdir(tmp_path)
    said = cli("batch", *arguments)
    assert said.status == 2
    assert len(said.errors) == 1
    assert told in said.errors[0]
    assert contents(tmp_path) == before
