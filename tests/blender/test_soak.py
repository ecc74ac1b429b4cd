"""Random operations on random characters: nothing goes wrong, nothing else changes; and the soak would see it."""

from collections.abc import Callable

import bpy
import pytest

from morph_retarget.blender import actions
from morph_retarget.blender.properties import of_rig
from tools.soak import bystander, running
from tools.soak.operations import World


def test_sixty_random_operations_go_well() -> None:
    found = running.run(60, seed=3)
    assert not found.faults, "\n".join(found.details.values())
    assert found.operations == 60
    assert sum(found.refused.values()) < 30


def _trip(_: World) -> None:
    raise KeyError("tripped")


def _report(_: World) -> None:
    bpy.ops.morph_retarget.analyze(rig="nobody")


def _handler(_: World) -> None:
    def broken(*_: object) -> None:
        raise ValueError("handler tripped")

    bpy.app.handlers.frame_change_post.append(broken)
    try:
        bpy.context.scene.frame_set(7)
    finally:
        bpy.app.handlers.frame_change_post.remove(broken)


def _nudge(_: World) -> None:
    bpy.data.objects[bystander.NAME].pose.bones[3].location.x += 1e-3


def _switch(_: World) -> None:
    of_rig(bpy.data.objects[bystander.NAME]).bends_spine = False


def _remove(_: World) -> None:
    bpy.data.objects.remove(bpy.data.objects[bystander.NAME])


def _key(_: World) -> None:
    action = bpy.data.actions[bystander.NAME]
    curve = next(iter(actions.curves(action, action.slots[0]).values()))
    curve.keyframe_points[2].co[1] += 0.5


@pytest.mark.parametrize(
    ("operation", "told"),
    [
        (_trip, "KeyError: 'tripped'"),
        (_handler, "ValueError: handler tripped"),
        (_nudge, "_nudge changed a bystander"),
        (_switch, "_switch changed a bystander"),
        (_key, "_key changed a bystander"),
        (_remove, "_remove: a bystander is gone"),
        (_report, ""),
    ],
)
def test_a_soak_sees_what_is_wrong(
    monkeypatch: pytest.MonkeyPatch, operation: Callable[[World], None], told: str
) -> None:
    monkeypatch.setattr(running, "OPERATIONS", {operation: 1})
    found = running.run(1, seed=1)
    assert list(found.faults) == ([told] if told else [])
    assert found.refused["_report"] == (0 if told else 1)
