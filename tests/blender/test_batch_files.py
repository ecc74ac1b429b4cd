"""Batches: what is asked for becomes jobs, and what cannot be meant is refused before anything starts."""

import json
import signal
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree as Xml

import pytest

from morph_retarget.blender.batch import files, gates, jobs_file, junit, ledger, plan, summary
from morph_retarget.blender.batch.jobs import Job, Refused, usual_options
from morph_retarget.blender.batch.prints import Prints
from morph_retarget.blender.batch.results import Answer, Result, Status
from morph_retarget.core.errors import MorphError

REPORT = {
    "foot_slide_m_per_s": {"source": 0.02, "target": 0.03},
    "bone_direction_error_deg": {"mean": 2.0, "median": 1.0, "p95": 6.0, "max": 9.0},
    "bone_twist_error_deg": {"mean": 0.0, "median": 0.0, "p95": 0.0, "max": 1.0},
    "ground_penetration_m": {"max": 0.004},
    "pose_jump_deg": {"max": 8.0, "source_max": 7.0},
    "joints_mapped": 20,
    "warnings": ["one"],
}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """Return a folder with clips and rigs that are there, whatever is in them."""
    for name in ("clips/walk.bvh", "clips/fast/run.bvh", "clips/.old/walk.bvh", "clips/notes.txt", "rigs/a.glb"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)
    for name in ("rigs/b.glb", "acts.blend", "map.json"):
        (tmp_path / name).write_text(name)
    return tmp_path


def _jobs(place: Path, text: str) -> list[Job]:
    (place / "jobs.toml").write_text(text)
    return plan.plan(jobs_file.read(place / "jobs.toml"), place / "out")


def _names(jobs: list[Job]) -> list[str]:
    return [job.name for job in jobs]


# --- jobs ---


def test_each_clip_goes_onto_each_rig_and_the_tree_of_folders_stays(place: Path) -> None:
    jobs = _jobs(place, '[[job]]\nsource = "clips/**/*.bvh"\ntarget = "rigs/*.glb"\n')
    assert _names(jobs) == ["a/fast/run.glb", "b/fast/run.glb", "a/walk.glb", "b/walk.glb"]
    assert jobs[0].labels == ("clips/fast/run.bvh", "rigs/a.glb")
    assert all(job.out == place / "out" / job.name for job in jobs)


def test_a_folder_yields_its_clips_without_hidden_ones(place: Path) -> None:
    assert list(files.below(place / "clips")) == ["walk.bvh", "fast/run.bvh"]


def test_defaults_hold_where_a_job_says_nothing_else(place: Path) -> None:
    jobs = _jobs(
        place,
        '[defaults]\ntarget = "rigs/a.glb"\nfps = 30\nhands = true\nmap = "map.json"\n\n'
        '[[job]]\nsource = "clips/walk.bvh"\n\n'
        '[[job]]\nsource = "clips/fast/run.bvh"\nfps = 60.0\nhands = false\nout = "run.fbx"\n',
    )
    assert jobs[0].options == {"fps": "30", "hands": True, "map": str(place / "map.json")}
    assert jobs[1].options == {"fps": "60.0", "map": str(place / "map.json")}
    assert jobs[1].name == "run.fbx"
    assert jobs[0].inputs == (place / "clips/walk.bvh", place / "rigs/a.glb", place / "map.json")


def test_actions_are_named_behind_the_file(place: Path) -> None:
    jobs = _jobs(place, '[[job]]\nsource = "acts.blend#Walk #2"\ntarget = "rigs/a.glb"\n')
    assert jobs[0].action == "Walk #2"
    assert "--action=Walk #2" in jobs[0].argv
    every = _jobs(place, '[[job]]\nsource = "acts.blend#*"\ntarget = "rigs/a.glb"\n')
    assert _names(every) == ["a/acts_{action}.glb"]
    assert "--all-actions" in every[0].argv


def test_a_file_may_have_signs_of_patterns_and_actions_in_its_name(place: Path) -> None:
    (place / "clips" / "take [1] #3.bvh").write_text("")
    (found,) = files.find("clips/take [1] #3.bvh", place)
    assert found.action is None
    assert found.path.name == "take [1] #3.bvh"


def test_a_pattern_leaves_out_the_pair_of_a_file_with_itself(place: Path) -> None:
    jobs = _jobs(place, '[[job]]\nsource = "rigs/*.glb"\ntarget = "rigs/*.glb"\n')
    assert _names(jobs) == ["b/a.glb", "a/b.glb"]


def test_chunks_share_all_jobs_without_doing_one_twice(place: Path) -> None:
    jobs = _jobs(place, '[[job]]\nsource = "clips/**/*.bvh"\ntarget = "rigs/*.glb"\n')
    shares = [plan.chunk(jobs, number, 3) for number in (1, 2, 3)]
    assert sorted(name for share in shares for name in _names(share)) == sorted(_names(jobs))
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


# --- what cannot be meant ---

JOB = '[[job]]\nsource = "clips/walk.bvh"\ntarget = "rigs/a.glb"\n'


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ('[[job]]\nsource = "clips/walk.bvh\n', 2, ["TOML"]),
        ("", None, ["holds no jobs"]),
        ("[job]\nsource = 1\n", 1, ["[[job]]"]),
        ("[common]\nfps = 3\n", 1, ["common", "[defaults]"]),
        (JOB + "speed = 3\n", 4, ["speed", "fps", "root"]),
        (JOB + 'fps = "fast"\n', 4, ["--fps", "fast"]),
        (JOB + "fps = true\n", 4, ["fps", "True"]),
        (JOB + 'hands = "yes"\n', 4, ["hands", "true"]),
        (JOB + 'root = "tail"\n', 4, ["--root", "hips"]),
        (JOB + 'reference = "soon"\n', 4, ["soon", "auto"]),
        (JOB + 'name = "{target}/{source}.glb"\n', 4, ["out"]),
        (JOB + 'map = "none.json"\n', 4, ["none.json"]),
        (f"[defaults]\nfps = 30\nlock = 7\n\n{JOB}", 3, ["--lock", "7"]),
        ('[[job]]\nsource = "clips/walk.bvh"\n', 1, ["no target"]),
        ('[[job]]\nsource = 3\ntarget = "rigs/a.glb"\n', 2, ["source"]),
        ('[[job]]\nsource = "clips/none*.bvh"\ntarget = "rigs/a.glb"\n', 2, ["clips/none*.bvh", "no file"]),
        ('[[job]]\nsource = "clips/none.bvh"\ntarget = "rigs/a.glb"\n', 2, ["clips/none.bvh", "no such file"]),
        ('[[job]]\nsource = "clips"\ntarget = "rigs/a.glb"\n', 2, ["clips", "folder"]),
        ('[[job]]\nsource = "clips/notes.txt"\ntarget = "rigs/a.glb"\n', 2, ["notes.txt", "kind"]),
        (JOB + 'out = "../{source}.glb"\n', 2, ["leads out"]),
        (JOB + 'out = "/{source}.glb"\n', 2, ["root"]),
        (JOB + 'out = "a/../../b.glb"\n', 2, ["leads out"]),
        (JOB + 'out = "{rig}.glb"\n', 2, ["{target}"]),
        (JOB + 'out = "walk.txt"\n', 2, ["kind", ".glb"]),
        (JOB + 'out = "{action}/walk.glb"\n', 2, ["{action}"]),
        (JOB + 'all-actions = true\nout = "all.glb"\n', 2, ["{action}"]),
        ('[[job]]\nsource = "clips/walk.bvh"\ntarget = "rigs/a.glb#Walk"\n', 2, ["armature"]),
    ],
)
def test_a_wrong_line_is_named(place: Path, text: str, line: int | None, words: list[str]) -> None:
    with pytest.raises(MorphError) as caught:
        _jobs(place, text)
    message = str(caught.value)
    assert message.startswith(f"{place / 'jobs.toml'}:{line}: " if line else f"{place / 'jobs.toml'}: ")
    assert all(word in message for word in words), message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (JOB.replace("walk", "none"), 7, ["clips/none.bvh", "no such file"]),
        (JOB.replace("walk", "none*"), 7, ["clips/none*.bvh", "no file"]),
        (JOB.replace("rigs/a", "rigs/none"), 7, ["rigs/none.glb", "no such file"]),
        (JOB.replace("clips/walk", "out/old"), 7, ["out/old.bvh", "where the results go"]),
        (JOB + "speed = 3\n", 9, ["speed", "fps"]),
        (JOB + "fps = true\n", 9, ["fps", "True"]),
        (JOB + 'out = "../{source}.glb"\n', 7, ["leads out"]),
        (JOB + 'out = "{rig}.glb"\n', 7, ["{target}"]),
        (JOB + 'out = "away/{source}.glb"\n', 7, ["leads out"]),
        (JOB + 'out = "/{source}.glb"\n', 7, ["root"]),
        (JOB + 'out = "first.glb"\n', 7, ["first.glb", "would hold clips/walk.bvh on rigs/a.glb and also"]),
        (JOB + 'out = "first.glb/walk.glb"\n', 2, ["first.glb", "a file and a folder"]),
        ('[[job]]\nsource = "clips/walk.bvh"\n', 6, ["no target"]),
    ],
)
def test_what_cannot_be_meant_costs_itself_alone(place: Path, text: str, line: int, words: list[str]) -> None:
    (place / "out").mkdir()
    (place / "out" / "away").symlink_to(place / "rigs")
    (place / "out" / "old.bvh").write_text("")
    first = '[[job]]\nsource = "clips/fast/run.bvh"\ntarget = "rigs/a.glb"\nout = "first.glb"\n'
    last = '[[job]]\nsource = "clips/fast/run.bvh"\ntarget = "rigs/b.glb"\nout = "last.glb"\n'
    (place / "jobs.toml").write_text(f"{first}\n{text}\n{last}")
    items = plan.plan(jobs_file.read(place / "jobs.toml"), place / "out")
    (refused,) = (item for item in items if isinstance(item, Refused))
    assert refused.error.startswith(f"{place / 'jobs.toml'}:{line}: ")
    assert all(word in refused.error for word in words), refused.error
    assert "\n" not in refused.error
    assert refused.name.startswith("jobs.toml: job 1" if line == 2 else "jobs.toml: job 2")
    assert len({item.name for item in items}) == len(items) == 3
    assert items[-1].name == "last.glb"


def test_of_several_patterns_the_one_that_matches_nothing_is_refused(place: Path) -> None:
    text = '[[job]]\nsource = ["none*.bvh", "clips/*.bvh"]\ntarget = ["rigs/*.glb", "rgs/*.glb"]\n'
    (place / "jobs.toml").write_text(text)
    items = plan.plan(jobs_file.read(place / "jobs.toml"), place / "out")
    refused = [item.name for item in items if isinstance(item, Refused)]
    assert refused == ["jobs.toml: job 1: none*.bvh", "jobs.toml: job 1: rgs/*.glb"]
    assert [item.name for item in items if isinstance(item, Job)] == ["a/walk.glb", "b/walk.glb"]


def test_when_nothing_is_left_the_first_fault_is_told(place: Path) -> None:
    with pytest.raises(MorphError, match=r"jobs\.toml:2: .*none\*\.bvh.*\(and 1 more\)$"):
        _jobs(place, JOB.replace("walk", "none*") + JOB.replace("walk", "gone"))


@pytest.mark.parametrize(
    ("row", "told"),
    [("fps = ", "mend 'fps'"), ("source = clips/*", "mend 'source'"), ("fps 3", "mend this line")],
)
def test_a_line_that_is_no_toml_is_named_with_its_key(place: Path, row: str, told: str) -> None:
    with pytest.raises(MorphError, match=rf"jobs\.toml:4: is no TOML .*{told}"):
        _jobs(place, f"{JOB}{row}\n")


def test_every_option_of_a_job_has_a_usual_value() -> None:
    options = usual_options()
    assert {"map", "source-map", "fps", "frames", "root", "no-plant-feet", "name"} <= set(options)
    assert not {"source", "targets", "out", "report"} & set(options)


# --- keys ---


@pytest.mark.parametrize("change", ["clip", "rig", "map", "option", "version", "nothing"])
def test_a_key_tells_whether_anything_has_changed(place: Path, change: str) -> None:
    def key(version: str = "1") -> str:
        return Prints(version).key(_jobs(place, f'{JOB}map = "map.json"\nfps = {fps}\n')[0])

    fps = 24
    before = key()
    changed = {"clip": "clips/walk.bvh", "rig": "rigs/a.glb", "map": "map.json"}.get(change)
    if changed:
        (place / changed).write_text("other")
    fps = 30 if change == "option" else 24
    assert (key("2" if change == "version" else "1") == before) == (change == "nothing")


def test_the_numbers_beside_a_gltf_count(place: Path) -> None:
    (place / "rig.gltf").write_text(json.dumps({"buffers": [{"uri": "rig%20data.bin"}, {"uri": "data:,x"}]}))
    (place / "rig data.bin").write_bytes(b"1")
    jobs = _jobs(place, JOB.replace("rigs/a.glb", "rig.gltf"))
    before = Prints("1").key(jobs[0])
    (place / "rig data.bin").write_bytes(b"2")
    assert Prints("1").key(jobs[0]) != before


# --- the record ---


def test_a_record_that_was_cut_short_is_read_up_to_there(tmp_path: Path) -> None:
    (tmp_path / "a.glb").write_text("made")
    with ledger.opened(tmp_path, "", resume=False) as record:
        record.begun("a", "key", 1)
        record.done("a", "key", Answer(Status.OK, seconds=2.0, files=["a.glb"]))
        record.begun("b", "key", 1)
    path = tmp_path / ledger.FOLDER / "ledger.jsonl"
    path.write_bytes(path.read_bytes()[:-9])
    for _ in range(2):
        with ledger.opened(tmp_path, "", resume=True) as record:
            assert record.entry("a")["state"] == ledger.DONE
            assert record.whole("a")
            assert record.ours("a")
            assert record.entry("b") == {}
            record.begun("c", "key", 1)


def test_a_result_that_was_changed_by_hand_is_no_longer_ours(tmp_path: Path) -> None:
    (tmp_path / "a.glb").write_text("made")
    with ledger.opened(tmp_path, "", resume=False) as record:
        record.done("a", "key", Answer(Status.OK, files=["a.glb"]))
        (tmp_path / "a.glb").write_text("edited")
        assert not record.whole("a")
        assert not record.ours("a")
        (tmp_path / "a.glb").unlink()
        assert record.ours("a")


def test_a_job_that_is_lost_keeps_what_was_recorded_of_its_results(tmp_path: Path) -> None:
    (tmp_path / "a.glb").write_text("made")
    with ledger.opened(tmp_path, "", resume=False) as record:
        record.done("a", "key", Answer(Status.OK, files=["a.glb"]))
        record.begun("a", "other", 1)
        record.lost("a")
        assert record.ours("a")


def test_a_damaged_record_is_refused(tmp_path: Path) -> None:
    with ledger.opened(tmp_path, "", resume=False):
        pass
    (tmp_path / ledger.FOLDER / "ledger.jsonl").write_text('{"job"\n{"job": "a", "state": "lost"}\n')
    with pytest.raises(MorphError, match=r"ledger\.jsonl:1: is damaged"), ledger.opened(tmp_path, "", resume=True):
        pass


def test_two_runs_do_not_write_one_record(tmp_path: Path) -> None:
    pytest.importorskip("fcntl")
    with ledger.opened(tmp_path, "", resume=False):
        with pytest.raises(MorphError, match="another batch"), ledger.opened(tmp_path, "", resume=True):
            pass
        with ledger.opened(tmp_path, ".2-of-2", resume=False):
            pass


# --- gates and reports ---


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("slide>0.03", ""),
        ("slide>0.029", "slide 0.03 > 0.029"),
        ("slide-added>0.005", "slide-added 0.01 > 0.005"),
        ("error>1, error-p95>6,error-max>8.5", "error 2 > 1, error-max 9 > 8.5"),
        ("joints<21,warnings>0", "joints 20 < 21, warnings 1 > 0"),
        ("jump-added>1,penetration>.01,twist>1,jump>8", ""),
    ],
)
def test_gates_compare_measures_with_limits(text: str, wrong: str) -> None:
    assert gates.judged([REPORT], gates.parse(text)) == wrong


def test_every_measure_is_in_the_report() -> None:
    assert all(isinstance(value(REPORT), int | float) for _, value in gates.MEASURES.values())


@pytest.mark.parametrize("text", ["", "slide", "slide>", "speed>1", "slide>1,", "slide=1", "slide>fast"])
def test_a_gate_that_cannot_be_meant_is_refused(text: str) -> None:
    with pytest.raises(MorphError, match="gate"):
        gates.parse(text)


def test_junit_has_a_case_for_each_job_and_is_always_xml(place: Path) -> None:
    (job,) = _jobs(place, JOB)
    results = [Result(job, Answer(status, "bad \x00 <name> \ud800", 1.5)) for status in Status]
    root = Xml.fromstring(junit.document(results, 9.0).encode())
    (suite,) = root
    assert [child.tag for case in suite for child in case] == ["failure", "skipped", "error", "error", "error"]
    assert suite.attrib | {"tests": "6", "failures": "1", "errors": "3", "skipped": "1"} == suite.attrib


class _Tags(HTMLParser):
    """Checks that the tags of a page that need an end have one."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []

    def handle_starttag(self, tag: str, _: object) -> None:
        if tag not in {"html", "meta", "rect", "path", "tr", "td", "th"}:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in {"html", "rect", "path", "tr", "td", "th"}:
            assert self.open.pop() == tag


def test_the_page_tells_what_is_bad_first_and_runs_nothing_that_names_say(place: Path) -> None:
    (job,) = _jobs(place, JOB)
    report = REPORT | {"frames": 34, "warnings": ["<script>alert(1)</script>"]}
    results = [
        Result(
            replace(job, name=f"{status}.glb"), Answer(status, "<img src=x>", 1.5, [report], drawings=["<svg></svg>"])
        )
        for status in Status
    ]
    results.append(Result(Refused("jobs.toml: job 2", "no <such> file"), Answer(Status.FAILED, "no <such> file")))
    page = summary.page(results, 9.0, "1.0")
    tags = _Tags()
    tags.feed(page)
    assert not tags.open
    assert "2 of 7 jobs are done" in page
    assert "<script" not in page
    assert "<img" not in page
    assert page.count("<svg>") == 6
    shown = [page.index(f"<h2>{status.value.capitalize()} (") for status in Status]
    order = sorted(Status, key=lambda status: shown[list(Status).index(status)])
    assert order == [Status.FAILED, Status.CRASHED, Status.TIMEOUT, Status.STOPPED, Status.OK, Status.SKIPPED]
    assert "slide 0.03 m/s" in page


def test_a_line_of_the_record_that_does_not_fit_on_the_disk_is_not_there(tmp_path: Path) -> None:
    limits = pytest.importorskip("resource")
    with ledger.opened(tmp_path, "", resume=False) as record:
        record.begun("a", "key", 1)
        path = tmp_path / ledger.FOLDER / "ledger.jsonl"
        size = path.stat().st_size
        before = limits.getrlimit(limits.RLIMIT_FSIZE)
        old = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        limits.setrlimit(limits.RLIMIT_FSIZE, (size + 5, before[1]))
        try:
            with pytest.raises(MorphError, match="free space"):
                record.begun("b", "key", 1)
        finally:
            limits.setrlimit(limits.RLIMIT_FSIZE, before)
            signal.signal(signal.SIGXFSZ, old)
        assert path.stat().st_size == size
        record.begun("c", "key", 1)
    with ledger.opened(tmp_path, "", resume=True) as record:
        assert (record.entry("b"), record.entry("c")["state"]) == ({}, ledger.BEGUN)
