"""Staying above the ground: tails that an action turns down lie on it, live, baked and on the command line."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel
from morph_retarget.core.morph.context import Context
from tests.blender import acting, acts, results, scenes
from tests.blender.acts import Act
from tests.blender.command import Command

TAIL = Channel("Tail", Context(Capability.TAIL), poses_position=False)
DOWN = (float(np.cos(0.3)), -float(np.sin(0.3)), 0.0, 0.0)

pytestmark = pytest.mark.usefixtures("registered")


def _act() -> Act:
    """Return a snake whose tail is turned down, into the ground on which it lies."""
    act = acts.act([acting.creature("snake")], TAIL)
    for frame in (1, 20):
        act.key(frame, rotation=DOWN)
    return act


def _lowest(ob: bpy.types.Object) -> float:
    """Return the height of the lowest joint [m]."""
    names = [bone.name for bone in ob.pose.bones]
    return float(scenes.evaluated(ob, names, [2.0])[0][:, 2, 3].min())


def test_a_tail_that_is_turned_down_lies_on_the_ground_unless_it_shall_not() -> None:
    """Live, and in the keys of a bake."""
    act = _act()
    ob = act.obs[0]
    assert cast.member(ob).solver.keeps_above_ground
    live = _lowest(ob)
    assert live > -0.005
    of_rig(ob).keeps_above_ground = False
    bpy.context.view_layer.update()
    assert _lowest(ob) < -0.1
    of_rig(ob).keeps_above_ground = True
    acting.baked(ob)
    assert abs(_lowest(ob) - live) < 1e-4


@pytest.mark.parametrize(
    ("kept", "option", "stays"),
    [(True, [], True), (False, [], False), (True, ["--no-above-ground"], False), (False, ["--above-ground"], True)],
)
def test_the_command_line_does_as_it_is_told_else_as_the_file_says(
    cli: Command, out: Path, kept: bool, option: list[str], stays: bool
) -> None:
    ob = _act().obs[0]
    of_rig(ob).keeps_above_ground = kept
    scenes.save(out / "down.blend")
    said = cli("play", f"{out / 'down.blend'}#Act", out / "down.blend", "-o", out / "x.blend", *option)
    assert (said.status, said.errors) == (0, [])
    assert (_lowest(results.reload(out / "x.blend")) > -0.005) == stays
