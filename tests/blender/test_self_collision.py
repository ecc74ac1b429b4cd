"""Self-collision: a character that avoids it swivels its arms out of its trunk, live, baked and on the command line."""

from pathlib import Path

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement
from tests.blender import acting, acts, results, scenes
from tests.blender.acts import Act
from tests.blender.command import Command

BELLY = Channel(
    "Belly", Context(Capability.GRASPER, side=Side.LEFT), Movement(secondary_relative=True), TargetKind.EXTERNAL
)
BONES = ["LowerArm.L", "Hand.L", "Chest"]

pytestmark = pytest.mark.usefixtures("registered")


def _act() -> Act:
    """Return a body that brings its left hand in front of the right side of its belly, where its elbow is inside."""
    act = acts.act([acting.creature("biped")], BELLY)
    act.values().target = acts.empty_object("Belly", (-0.1, -0.24, 1.15))
    act.key(1, position=(1.0, 0.0, 0.0))
    act.key(20, position=(1.0, 0.0, 0.0))
    return act


def _places(ob: bpy.types.Object) -> Array:
    """Return where elbow, hand and chest are, shape (3, 3)."""
    return scenes.evaluated(ob, BONES, [2.0])[0][:, :3, 3]


def test_an_elbow_leaves_the_trunk_of_the_character_that_avoids_it() -> None:
    """Live, and in the keys of a bake; the hand stays where it is, and off again all is as it was."""
    act = _act()
    ob = act.obs[0]
    assert cast.member(ob).solver.avoids_collisions is False
    before = _places(ob)
    of_rig(ob).avoids_collisions = True
    bpy.context.view_layer.update()
    live = _places(ob)
    assert np.abs(live[0] - before[0]).max() > 0.05
    assert np.abs(live[1:] - before[1:]).max() < 1e-5
    away = [np.linalg.norm((places[0] - places[2])[:2]) for places in (before, live)]
    assert away[1] > away[0] + 0.05
    of_rig(ob).avoids_collisions = False
    bpy.context.view_layer.update()
    assert np.abs(_places(ob) - before).max() < 1e-6
    of_rig(ob).avoids_collisions = True
    acting.baked(ob)
    assert np.abs(_places(ob) - live).max() < 1e-4


@pytest.mark.parametrize(
    ("kept", "option", "avoids"),
    [
        (False, [], False),
        (True, [], True),
        (False, ["--avoid-collisions"], True),
        (True, ["--no-avoid-collisions"], False),
    ],
)
def test_the_command_line_does_as_it_is_told_else_as_the_file_says(
    cli: Command, out: Path, kept: bool, option: list[str], avoids: bool
) -> None:
    ob = _act().obs[0]
    found = {}
    for on in (False, True):
        of_rig(ob).avoids_collisions = on
        bpy.context.view_layer.update()
        found[on] = _places(ob)
    of_rig(ob).avoids_collisions = kept
    scenes.save(out / "belly.blend")
    target = ["--target", "Belly=Belly"]
    said = cli("play", f"{out / 'belly.blend'}#Act", out / "belly.blend", "-o", out / "x.blend", *target, *option)
    assert (said.status, said.errors) == (0, [])
    assert np.abs(_places(results.reload(out / "x.blend")) - found[avoids]).max() < 1e-4
