"""`validate`: grids of generalized actions and gaits on characters in files, all outputs or none."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.cli import data as extension
from morph_retarget.blender.io.load import Request, load
from morph_retarget.blender.morph import cast, definitions
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.validation import cells
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.branch import Answer
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context
from morph_retarget.core.morph.movement import Movement, ScaleMode
from morph_retarget.core.validation.cell import Status
from morph_retarget.core.verdicts.judging import VERDICTS, Limits
from tests.blender import acting, scenes
from tests.blender.acting import FEET, REACH
from tests.blender.command import Command, Refused, contents

SINKING = Channel("Root", Context(Capability.ROOT), Movement(scale=ScaleMode.CREATURE_SIZE))
FILES = {"report.json", "index.html", "grid.png"}


@dataclass(frozen=True)
class Stage:
    """Files to judge."""

    actions: Path
    """Holds "Dip" for hands; "Kick" for feet, of which characters with two play the branch "Hop"; "Pick", which has
    an external target; "Sink", which takes the root below the ground; 25 frames a second."""
    pair: Path
    """A .blend with the armatures "Ann" and "Bob"."""
    hound: Path
    snake: Path


@pytest.fixture(scope="session")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Stage:
    folder = tmp_path_factory.mktemp("validation")
    with extension.known():
        scenes.empty(25)
        ann = scenes.figure("Ann")
        acting.dip(ann)
        for name, legs in (("Kick", -1), ("Hop", 2)):
            made = acting.action(name, [FEET])
            of_action(made).movement, of_action(made).leg_count = "Kick", legs
            of_action(made).has_feet = Answer.TRUE.value
            acting.play(made, ann, keyed={"Feet": {1: (0, 0, 0), 9: (0, -0.1, 0.1), 17: (0, 0, 0)}})
        reach = acting.action("Pick", [REACH])
        acting.play(reach, ann, keyed={"Reach": {1: (0, 0, 0), 11: (0.5, 0, 0), 21: (0, 0, 0)}})
        sink = acting.action("Sink", [SINKING])
        acting.play(sink, ann, keyed={"Root": {1: (0, 0, 0), 11: (0, 0, -0.5), 21: (0, 0, 0)}})
        scenes.save(folder / "actions.blend")
        scenes.empty(25)
        scenes.figure("Ann")
        scenes.figure("Bob", height=1.2)
        scenes.save(folder / "pair.blend")
        for kind in ("hound", "snake"):
            scenes.empty(25)
            acting.creature(kind)
            scenes.save(folder / f"{kind}.blend")
        cast.forget(rig=True)
    return Stage(*(folder / f"{name}.blend" for name in ("actions", "pair", "hound", "snake")))


@pytest.fixture
def known() -> Iterator[None]:
    with extension.known():
        yield
        cast.forget(rig=True)


def _report(out: Path) -> dict[str, object]:
    return json.loads((out / "report.json").read_text(encoding="utf-8"))


def _statuses(report: dict[str, object]) -> dict[tuple[str, str], str]:
    return {(cell["action"], cell["character"]): cell["status"] for cell in report["cells"]}


def test_help_has_an_example(cli: Command) -> None:
    said = cli("validate", "--help")
    assert (said.status, said.errors) == (0, [])
    assert "validate actions.blend --on" in said.out.partition("examples:")[2]
    assert all(f"--max-{name}" in said.out for name in VERDICTS)


# --- results ---


def test_all_actions_of_a_file_are_judged_on_all_armatures_of_others(
    cli: Command, stage: Stage, tmp_path: Path
) -> None:
    out = tmp_path / "grid"
    said = cli("validate", stage.actions, "--on", stage.pair, stage.hound, stage.snake, "--out", out)
    report = _report(out)
    assert set(contents(out)) == FILES
    found = _statuses(report)
    assert {action for action, _ in found} == {"Dip", "Kick", "Hop", "Pick", "Sink"}
    assert {character for _, character in found} == {"pair#Ann", "pair#Bob", "hound", "snake"}
    assert found["Kick", "snake"] == "does not apply", "it has no feet"
    assert found["Hop", "hound"] == "does not apply"
    assert found["Kick", "hound"] == "passed"
    assert (found["Hop", "pair#Ann"], found["Kick", "pair#Ann"]) == ("passed", "does not apply")
    assert found["Pick", "pair#Bob"] == "passed"
    assert found["Sink", "pair#Ann"] == "failed"
    assert said.status == 1
    assert said.out.splitlines()[-1].startswith(f"{len(found)} cells: ")
    assert any(line.startswith("failed: Sink, pair#Ann: ") and "ground" in line for line in said.out.splitlines())
    image = bpy.data.images.load(str(out / "grid.png"))
    assert image.size[0] > 4 * 100
    assert "index" not in (out / "index.html").read_text(encoding="utf-8").partition("<svg")[0]


def test_the_report_has_the_documented_keys(cli: Command, stage: Stage, tmp_path: Path) -> None:
    out = tmp_path / "grid"
    assert cli("validate", f"{stage.actions}#Dip", "--on", f"{stage.pair}#Bob", "--out", out).status == 0
    report = _report(out)
    assert list(report) == [
        "version", "settings", "pass_rate", "passed", "failed", "does_not_apply", "failed_by_verdict", "cells",
    ]  # fmt: skip
    (cell,) = report["cells"]
    assert list(cell) == [
        "action", "character", "status", "verdicts", "problems", "error", "frames", "variant", "variants", "seconds",
    ]  # fmt: skip
    assert tuple(cell["verdicts"]) == VERDICTS
    assert list(cell["verdicts"]["pop"]) == ["value", "limit", "unit", "passed", "where", "frame"]
    assert cell["character"] == "pair#Bob"
    assert report["pass_rate"] == 1.0
    assert report["settings"]["limits"]["pop"] == Limits().pop
    assert str(report["version"]).startswith("Morph Retarget ")


def test_the_same_run_gives_the_same_verdicts(cli: Command, stage: Stage, tmp_path: Path) -> None:
    told: list[object] = []
    for name in ("one", "two"):
        cli("validate", stage.actions, "--on", stage.hound, stage.pair, "--out", tmp_path / name)
        found = _report(tmp_path / name)["cells"]
        told.append([{key: value for key, value in cell.items() if key != "seconds"} for cell in found])
    assert told[0] == told[1]


def test_a_gait_is_judged_without_any_action(cli: Command, stage: Stage, tmp_path: Path) -> None:
    out = tmp_path / "grid"
    said = cli(
        "validate", "-", "--gait", "walk", "--speed", "0.8", "--frames", "1:25", "--on", stage.hound, stage.snake,
        "--out", out,
    )  # fmt: skip
    report = _report(out)
    assert set(_statuses(report)) == {("Locomotion", "hound"), ("Locomotion", "snake")}
    (hound,) = [cell for cell in report["cells"] if cell["character"] == "hound"]
    assert all(hound["verdicts"][name]["passed"] for name in ("goals", "ground", "slide", "pop")), said.out
    assert hound["verdicts"]["slide"]["value"] < 0.05
    assert hound["frames"] == 25


def test_an_action_beside_a_gait_stands_where_it_is(cli: Command, stage: Stage, tmp_path: Path) -> None:
    out = tmp_path / "grid"
    cli("validate", "-", f"{stage.actions}#Kick", "--frames", "1:17", "--on", stage.hound, "--out", out)
    found = {cell["action"]: cell for cell in _report(out)["cells"]}
    assert set(found) == {"Locomotion", "Kick"}
    assert found["Kick"]["status"] == "passed"


# --- choices ---


def test_limits_are_options(cli: Command, stage: Stage, tmp_path: Path) -> None:
    strict = ["--max-ground", "0", "--max-slide", "0", "--max-pop", "0", "--max-goals", "0"]
    arguments = ["validate", f"{stage.actions}#Kick", "--on", stage.hound, "--out", tmp_path / "grid"]
    assert cli(*arguments).status == 0
    assert cli(*arguments, *strict).status == 1
    assert _report(tmp_path / "grid")["settings"]["limits"]["ground"] == 0.0
    assert cli(*arguments, "--max-ground", "-1").status == 2


def test_a_sample_is_judged_alone(cli: Command, stage: Stage, tmp_path: Path) -> None:
    found: list[set[tuple[str, str]]] = []
    for name, seed in (("one", 1), ("two", 1), ("three", 2)):
        cli(
            "validate", stage.actions, "--on", stage.pair, stage.hound, "--sample", "4", "--seed", seed,
            "--out", tmp_path / name,
        )  # fmt: skip
        found.append(set(_statuses(_report(tmp_path / name))))
    assert [len(own) for own in found] == [4, 4, 4]
    assert found[0] == found[1]
    assert found[0] != found[2]


def test_what_has_changed_since_an_earlier_run_comes_first(cli: Command, stage: Stage, tmp_path: Path) -> None:
    arguments = ["validate", f"{stage.actions}#Dip", f"{stage.actions}#Sink", "--on", f"{stage.pair}#Ann", "--out"]
    cli(*arguments, tmp_path / "one", "--max-ground", "9")
    earlier = tmp_path / "one" / "report.json"
    said = cli(*arguments, tmp_path / "two", "--compare", earlier)
    assert said.out.startswith("regression: Sink, pair#Ann: ground")
    report = _report(tmp_path / "two")
    assert report["compared"]["regressions"] == [["Sink", "pair#Ann"]]
    assert report["cells"][0]["action"] == "Sink"
    assert "Regressions (1)" in (tmp_path / "two" / "index.html").read_text(encoding="utf-8")
    assert cli(*arguments, tmp_path / "three", "--max-ground", "9", "--compare", tmp_path / "two" / "report.json")
    assert _report(tmp_path / "three")["compared"]["mended"] == [["Sink", "pair#Ann"]]


# --- what goes wrong ---


def test_a_character_that_cannot_be_used_costs_its_own_cells_alone(cli: Command, stage: Stage, tmp_path: Path) -> None:
    broken = tmp_path / "broken.glb"
    broken.write_bytes(b"no rig at all")
    said = cli("validate", f"{stage.actions}#Dip", "--on", broken, f"{stage.pair}#Ann", "--out", tmp_path / "grid")
    assert said.status == 1
    report = _report(tmp_path / "grid")
    assert _statuses(report) == {("Dip", "broken"): "failed", ("Dip", "pair#Ann"): "passed"}
    assert "broken.glb" in report["cells"][0]["error"]


def test_unusable_requests_are_refused_and_leave_nothing(refused: Refused, stage: Stage, out: Path) -> None:
    grid, on = out / "grid", stage.pair
    refused("validate", stage.actions, "--on", out / "none.glb", "--out", grid, names="none.glb: no such file")
    refused("validate", out / "none.blend", "--on", on, "--out", grid, names="none.blend: no such file")
    refused("validate", f"{stage.actions}#None", "--on", on, "--out", grid, names="has no action 'None'")
    refused("validate", stage.pair, "--on", on, "--out", grid, names="holds no generalized action")
    refused("validate", stage.actions, "--on", on, "--out", out / "a" / "b", names="there is no folder")
    refused("validate", stage.actions, "--on", on, "--out", out / "older.blend", names="is a file: name a folder")
    refused("validate", stage.actions, stage.actions, "--on", on, "--out", grid, names="is there twice")
    refused("validate", stage.actions, "--on", on, on, "--out", grid, names="is there twice")
    refused(
        "validate", stage.actions, "--on", on, "--out", grid, "--compare", out / "older.blend",
        names="older.blend: is no report of a validation",
    )  # fmt: skip


# --- from scripts ---


@pytest.mark.usefixtures("known")
def test_scripts_judge_what_is_in_the_open_file(stage: Stage) -> None:
    load(Request(stage.pair))
    with bpy.data.libraries.load(str(stage.actions)) as (theirs, ours):
        ours.actions = [name for name in theirs.actions if name in ("Dip", "Sink")]
    obs = [bpy.data.objects["Ann"], bpy.data.objects["Bob"]]
    before = [ob.animation_data and ob.animation_data.action for ob in obs]
    found = cells.judged_all(obs, ours.actions, cells.Options(Limits(ground=9.0)))
    assert [cell.key for cell in found] == [(action.name, ob.name) for ob in obs for action in ours.actions]
    assert {cell.status for cell in found} == {Status.PASSED}
    assert all(np.isfinite(cell.strip.lines).all() for cell in found)
    assert [ob.animation_data and ob.animation_data.action for ob in obs] == before
    assert all(definitions.is_generalized(action) for action in ours.actions)
