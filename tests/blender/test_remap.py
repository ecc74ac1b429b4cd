"""Key remapping: whatever movement mode is changed, the active body moves as before (Hecker 2008 §3.3)."""

import itertools
from collections.abc import Iterator, Mapping, Sequence

import bpy
import numpy as np
import pytest

from morph_retarget.blender.morph import cast, definitions, keys
from morph_retarget.blender.morph.properties import of_action
from morph_retarget.blender.properties import of_rig
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.channels import Channel, MirrorRule, TargetKind
from morph_retarget.core.morph.context import Context, Side
from morph_retarget.core.morph.movement import Movement
from tests.blender import acts, scenes
from tests.blender.acts import Act

SAME = 1e-5
"""How far a motion may be from what it was [m or rad]."""
CHOICES: Mapping[str, Sequence[object]] = {
    "position": ("rest_relative", "absolute"),
    "rotation": ("rest_relative", "absolute"),
    "scale": ("none", "creature_size", "limb_length"),
    "ground_relative": (False, True),
    "sagittal_relative": (False, True),
    "secondary_relative": (False, True),
    "directional_only": (False, True),
    "look_at": (False, True),
}
TARGETS = ("external", "context", "none")
FIRST = {name: values[0] for name, values in CHOICES.items()}

pytestmark = pytest.mark.usefixtures("registered")


def _hands(*names: str, **options: object) -> Act:
    """Return creatures that move a left hand, which has a target to reach for; a biped alone without names."""
    context = Context(Capability.GRASPER, side=Side.LEFT)
    channel = Channel("Hand", context, Movement(), TargetKind.EXTERNAL, **options)
    act = acts.act([acts.creature(name) for name in names or ("biped",)], channel)
    fruit = acts.empty_object("Fruit", (0.4, -0.6, 0.9))
    for i in range(len(act.obs)):
        act.values(i).target = fruit
        of_rig(act.obs[i]).muted = True  # curves are looked at, not poses
    act.channel().secondary.capability = "mouth"
    return act


def _key(act: Act, seed: int = 3, **options: object) -> None:
    """Key positions and rotations; options are those of the keys."""
    rng = np.random.default_rng(seed)
    for frame in (1, 8, 20):
        act.key(frame, position=rng.normal(size=3) * 0.3, rotation=_turn(rng))
    for curve in _curves(act):
        for point in curve.keyframe_points:
            for name, value in options.items():
                setattr(point, name, value)
        curve.update()
    bpy.context.view_layer.update()


def _key_more(act: Act) -> None:
    """Key some components at times of their own."""
    for part, index, frame in (("position", 0, 13), ("position", 2, 5), ("rotation", 1, 11), ("rotation", 3, 16)):
        act.curve(part, index).keyframe_points.insert(frame, 0.2)
    bpy.context.view_layer.update()


def _turn(rng: np.random.Generator) -> np.ndarray:
    value = rng.normal(size=4) * 0.3 + np.array([1.0, 0.0, 0.0, 0.0])
    return value / np.linalg.norm(value)


def _choose(act: Act, **wanted: object) -> None:
    item = act.channel()
    for name, value in wanted.items():
        if getattr(item, name) != value:
            setattr(item, name, value)


def _curves(act: Act) -> list[bpy.types.FCurve]:
    return list(keys.curves(act.action).values())


def _times(act: Act) -> list[list[float]]:
    return [[point.co[0] for point in curve.keyframe_points] for curve in _curves(act)]


# --- every mode to every other ---


@pytest.mark.parametrize("target", TARGETS)
def test_no_change_from_one_setting_to_another_moves_the_active_body(target: str) -> None:
    act = _hands()
    _key(act)
    _key_more(act)
    _choose(act, target=target)
    states = [FIRST, *(FIRST | {name: value} for name, values in CHOICES.items() for value in values[1:])]
    was = acts.motion(act.obs[0])
    pairs = set()
    count = len(states)
    route = [step for i in range(count) for j in range(i + 1, count) for step in ((i, j, i) if j == i + 1 else (j, i))]
    for old, new in itertools.pairwise(route):
        if old == new:
            continue
        _choose(act, **states[new])
        pairs.add((old, new))
        assert acts.apart(acts.motion(act.obs[0]), was) < SAME, (states[old], states[new])
    assert pairs >= set(itertools.permutations(range(count), 2))


def test_a_walk_through_all_combinations_of_modes_never_moves_the_active_body() -> None:
    act = _hands()
    _key(act)
    _key_more(act)
    rng = np.random.default_rng(11)
    frames = acts.FRAMES[::5]
    was, seen = acts.motion(act.obs[0], frames), set()
    for combination in _walk(rng):
        _choose(act, **combination)
        seen.add(tuple(combination.values()))
        # What a change has moved stays moved: it is enough to look now and then, in every setting.
        assert len(seen) % 4 or acts.apart(acts.motion(act.obs[0], frames), was) < SAME, combination
        if rng.random() < 0.1:
            _choose(act, target=TARGETS[rng.integers(3)])
    assert len(seen) == 384


def _walk(rng: np.random.Generator) -> Iterator[dict[str, object]]:
    """Yield all combinations, each with one setting changed since the one before."""
    names = [str(name) for name in rng.permutation(list(CHOICES))]
    up, place = dict.fromkeys(names, 1), dict.fromkeys(names, 0)
    while True:
        yield {name: CHOICES[name][place[name]] for name in names}
        for name in names:
            if 0 <= place[name] + up[name] < len(CHOICES[name]):
                place[name] += up[name]
                break
            up[name] *= -1
        else:
            return


# --- shapes of curves ---

PLACED = {"secondary_relative": True, "scale": "creature_size"}
MIXING = PLACED | {"rotation": "absolute", "look_at": True}
"""What mixes the components of positions and rotations with each other."""
EASED = ("SINE", "BACK", "ELASTIC", "BOUNCE", "EXPO")


@pytest.mark.parametrize("handles", ["FREE", "ALIGNED", "AUTO", "AUTO_CLAMPED", "VECTOR"])
def test_curves_with_handles_of_every_kind_keep_their_shape(handles: str) -> None:
    act = _hands()
    _key(act, handle_left_type=handles, handle_right_type=handles)
    _key_more(act)
    rng = np.random.default_rng(5)
    for curve in _curves(act):
        for point in curve.keyframe_points:
            if handles in {"FREE", "ALIGNED"}:  # of lengths of their own, some so long that they overlap
                left, right = rng.normal([-3.5, 0.0], [1.0, 0.2]), rng.normal([3.5, 0.0], [1.0, 0.2])
                point.handle_left, point.handle_right = left + point.co, right + point.co
        curve.update()
    _stays(act)


@pytest.mark.parametrize("interpolation", ["LINEAR", "CONSTANT", *EASED])
def test_curves_of_every_interpolation_keep_their_shape(interpolation: str) -> None:
    act = _hands()
    _key(act, interpolation=interpolation, easing="EASE_IN_OUT")
    _choose(act, scale="limb_length")
    assert {point.interpolation for curve in _curves(act) for point in curve.keyframe_points} == {interpolation}
    _stays(act)


@pytest.mark.parametrize("interpolation", ["LINEAR", "CONSTANT", "SINE", "BOUNCE"])
def test_components_with_different_keys_and_interpolations_keep_their_shapes(interpolation: str) -> None:
    act = _hands()
    _key(act)
    _key_more(act)
    for curve in _curves(act)[::2]:
        for point in curve.keyframe_points:
            point.interpolation = interpolation
        curve.update()
    _stays(act)


def _stays(act: Act) -> None:
    frames = np.arange(-5.0, 30.01, 0.23)
    was = acts.motion(act.obs[0], frames)
    turned = MIXING if any("rotation" in path for path, _ in keys.curves(act.action)) else PLACED
    for wanted in (turned, FIRST, {"scale": "limb_length"}, {"position": "absolute"}, FIRST):
        _choose(act, **wanted)
        assert acts.apart(acts.motion(act.obs[0], frames), was) < SAME, wanted


def test_a_change_of_scale_alone_leaves_every_component_its_own_keys() -> None:
    act = _hands()
    _key(act)
    _key_more(act)
    x = act.curve()
    x.keyframe_points[1].type, x.keyframe_points[1].interpolation = "EXTREME", "ELASTIC"
    x.keyframe_points[1].amplitude, x.keyframe_points[2].select_control_point = 0.3, False
    times, rotations = _times(act), [point.co[1] for point in act.curve("rotation", 2).keyframe_points]
    _choose(act, ground_relative=True, scale="limb_length")
    assert _times(act) == times
    assert [point.co[1] for point in act.curve("rotation", 2).keyframe_points] == rotations
    point = act.curve().keyframe_points[1]
    assert (point.type, point.interpolation) == ("EXTREME", "ELASTIC")
    assert not act.curve().keyframe_points[2].select_control_point
    assert {p.handle_left_type for p in act.curve("position", 1).keyframe_points} == {"AUTO_CLAMPED"}


def test_cycles_go_on_in_new_modes_and_on_curves_that_come_with_them() -> None:
    act = _hands()
    for frame, x in ((1, 0.2), (8, -0.1), (13, 0.2)):
        act.values().position = (x, 0.0, 0.0)
        act.obs[0].keyframe_insert(keys.path("Hand", "position"), index=0, frame=frame)
    keys.by_name(act.action, act.obs[0])
    act.curve().modifiers.new("CYCLES")
    _stays(act)
    _choose(act, **PLACED)
    assert len(_curves(act)) == 3
    assert all(curve.modifiers[0].type == "CYCLES" for curve in _curves(act))


def test_curves_that_run_on_straight_run_on_straight() -> None:
    act = _hands()
    _key(act)
    for curve in _curves(act):
        curve.extrapolation = "LINEAR"
        curve.keyframe_points[0].interpolation = "LINEAR"
    _stays(act)


def test_a_single_key_and_single_components_are_enough() -> None:
    act = _hands()
    act.values().position = (0.1, 0.2, 0.3)
    act.obs[0].keyframe_insert(keys.path("Hand", "position"), index=2, frame=4)
    _choose(act, scale="limb_length")
    assert list(keys.curves(act.action)) == [(keys.path("Hand", "position"), 2)]
    _stays(act)


def test_a_muted_curve_is_remapped_with_the_others() -> None:
    act = _hands()
    _key(act)
    act.curve("position", 1).mute = True
    x, y = (keys.bag_of(act.action).fcurves.find(keys.path("Hand", "position"), index=i) for i in (0, 1))
    before = [[c.keyframe_points[1].co[1] for c in (x, y)]]
    _choose(act, scale="limb_length")
    before.append([c.keyframe_points[1].co[1] for c in (x, y)])
    assert before[1][0] / before[0][0] == pytest.approx(before[1][1] / before[0][1])


# --- bodies ---


def test_another_character_moves_otherwise_in_the_new_mode() -> None:
    act = _hands("biped", "lopside", "asura")
    _key(act)
    was = [acts.motion(ob) for ob in act.obs]
    _choose(act, scale="limb_length")
    moved = [acts.apart(acts.motion(ob), motion) for ob, motion in zip(act.obs, was, strict=True)]
    assert moved[0] < SAME
    assert min(moved[1:]) > 0.01
    bpy.context.view_layer.objects.active = act.obs[2]
    was = [acts.motion(ob) for ob in act.obs]
    _choose(act, secondary_relative=True)
    moved = [acts.apart(acts.motion(ob), motion) for ob, motion in zip(act.obs, was, strict=True)]
    assert moved[2] < SAME
    assert min(moved[:2]) > 0.01


@pytest.mark.parametrize("side", ["L", "R"])
def test_an_active_body_that_is_mirrored_moves_as_before(side: str) -> None:
    channel = Channel("Hands", Context(Capability.GRASPER), mirror=MirrorRule.LEFT)
    act = acts.act([acts.creature("lopside")], channel)
    ob, body = act.obs[0], f"Hand.{side}"
    act.values().active_body = body
    act.values().target = acts.empty_object("Fruit", (0.3, -0.5, 0.8))
    _key(act)
    _key_more(act)
    mirrored = {_name_of(e.body, ob): e.mirrored for e in cast.member(ob).binding.entries}
    assert mirrored[body] == (side == "R")
    was = acts.motion(ob, body=body)
    for wanted in ({"target": "external"}, MIXING, {"sagittal_relative": True}, {"ground_relative": True}, FIRST):
        _choose(act, **wanted)
        assert acts.apart(acts.motion(ob, body=body), was) < SAME, wanted


def _name_of(body: int, ob: bpy.types.Object) -> str:
    return cast.member(ob).bodies.names[body]


def test_the_limb_that_is_active_decides_which_movements_are_kept() -> None:
    """With the long limb active its large movement is kept, and the short one's becomes large; and the other way."""
    act = acts.act([acts.creature("lopside")], Channel("Hands", Context(Capability.GRASPER)))
    ob = act.obs[0]
    _choose(act, scale="limb_length")
    act.key(1, position=(0.0, 0.0, 0.0))
    act.key(20, position=(0.5, 0.0, 0.0))

    def ways() -> dict[str, float]:
        bodies = [_name_of(body, ob) for body in acts.goals(ob).bodies]
        return {body: abs(float(np.diff(acts.motion(ob, np.array([1.0, 20.0]), body)[0][:, 0])[0])) for body in bodies}

    before = ways()
    long, short = max(before, key=before.__getitem__), min(before, key=before.__getitem__)
    assert before[long] > 1.2 * before[short]
    for active in (long, short):
        act.values().active_body = active
        _choose(act, scale="none")
        assert list(ways().values()) == pytest.approx([before[active]] * len(before))
        _choose(act, scale="limb_length")
        assert ways() == pytest.approx(before, rel=1e-4)


def test_a_foot_that_goes_below_and_above_its_rest_moves_as_before() -> None:
    """Ground-relative heights bend at rest for bodies near the ground; keys are added where curves cross it."""
    channel = Channel("Feet", Context(Capability.FOOT, side=Side.LEFT), target=TargetKind.EXTERNAL)
    act = acts.act([acts.creature("biped")], channel)
    ob = act.obs[0]
    act.values().target = acts.empty_object("Ball", (0.3, -0.7, 0.2))
    for frame, z in ((1, 0.0), (6, 0.2), (12, -0.04), (20, 0.1)):
        act.key(frame, position=(0.05 * frame, 0.1, z))
    bpy.context.view_layer.update()
    was, times = acts.motion(ob), _times(act)
    for wanted in ({"ground_relative": True}, PLACED, {"ground_relative": False}, {"ground_relative": True}, FIRST):
        _choose(act, **wanted)
        assert acts.apart(acts.motion(ob), was) < SAME, wanted
    assert _times(act)[0] != times[0]
    assert {6.0, 12.0, 20.0} <= set(_times(act)[2])


# --- targets ---


def test_other_kinds_of_targets_do_not_move_the_active_body() -> None:
    act = _hands()
    _key(act)
    was = acts.motion(act.obs[0])
    _choose(act, secondary_relative=True, look_at=True)
    for target in ("context", "none", "external", "none", "context", "external"):
        _choose(act, target=target)
        assert acts.apart(acts.motion(act.obs[0]), was) < SAME, target


def test_a_target_that_is_another_body_counts_where_its_own_channel_brings_it() -> None:
    right = Channel("Right", Context(Capability.GRASPER, side=Side.RIGHT))
    left = Channel("Left", Context(Capability.GRASPER, side=Side.LEFT))
    act = acts.act([acts.creature("biped")], right, left)
    act.values(0, "Right").position = (0.1, -0.3, 0.3)
    item = act.channel("Left")
    item.secondary.side = "right"
    for frame, x in ((1, 0.1), (20, -0.3)):
        act.key(frame, "Left", position=(x, 0.2, -0.1))
    place = np.array([body == "Hand.L" for body in _bodies(act)]).argmax()
    was = acts.goals(act.obs[0]).positions[:, place]
    for name, value in (("target", "context"), ("secondary_relative", True), ("directional_only", True)):
        setattr(item, name, value)
        now = acts.goals(act.obs[0]).positions[:, [b == "Hand.L" for b in _bodies(act)].index(True)]
        assert np.abs(now - was).max() < SAME
    assert np.abs(acts.goals(act.obs[0]).positions[:, 1 - place] - acts.heads(act.obs[0], ["Hand.R"])).max() < 0.05


def _bodies(act: Act) -> list[str]:
    return [_name_of(body, act.obs[0]) for body in acts.goals(act.obs[0]).bodies]


def test_keys_toward_a_target_that_moves_keep_their_poses_at_their_times() -> None:
    act = _hands()
    _key(act)
    fruit = act.values().target
    for frame, x in ((1, 0.4), (20, -0.3)):
        fruit.location.x = x
        fruit.keyframe_insert("location", frame=frame)
    ob, scene = act.obs[0], bpy.context.scene
    of_rig(ob).muted = False

    def poses() -> list[np.ndarray]:
        out = []
        for frame in (1, 8, 20):
            scene.frame_set(frame)
            goals = act.shown()
            out += [goals.positions[0, 0], goals.turns[0, 0]]
        return out

    was = poses()
    scene.frame_set(5)
    _choose(act, secondary_relative=True, look_at=True)
    assert scene.frame_current == 5
    for old, new in zip(was, poses(), strict=True):
        assert min(np.abs(new - old).max(), np.abs(new + old).max()) < SAME


def test_keys_wait_for_a_target_that_is_chosen_later() -> None:
    act = _hands()
    fruit, act.values().target = act.values().target, None
    _key(act)
    was, keyed = acts.motion(act.obs[0]), scenes.keys_of(act.action)
    _choose(act, secondary_relative=True)
    assert scenes.keys_of(act.action) == keyed
    assert "has no target" in act.tell()
    act.values().target = fruit
    assert acts.apart(acts.motion(act.obs[0]), was) < SAME
    assert scenes.keys_of(act.action) != keyed
    fruit.location.x += 0.2
    keyed = scenes.keys_of(act.action)
    act.values().target = acts.empty_object("Another", (0.0, -0.5, 0.5))
    assert scenes.keys_of(act.action) == keyed


# --- what is not remapped ---


def test_keys_are_left_alone_when_remapping_is_off() -> None:
    act = _hands()
    of_action(act.action).remap = False
    _key(act)
    keyed, was = scenes.keys_of(act.action), acts.motion(act.obs[0])
    _choose(act, **MIXING)
    assert scenes.keys_of(act.action) == keyed
    assert acts.apart(acts.motion(act.obs[0]), was) > 0.01
    movement, target = definitions.from_text(act.channel().keyed_in)
    assert (movement, target) == (definitions.movement(act.channel()), TargetKind.EXTERNAL)
    of_action(act.action).remap = True
    was = acts.motion(act.obs[0])
    _choose(act, **FIRST)
    assert acts.apart(acts.motion(act.obs[0]), was) < SAME


def test_values_without_keys_are_kept_too_but_rest_stays_rest() -> None:
    act = _hands("biped", "lopside")
    _choose(act, look_at=True)
    assert tuple(act.values().rotation) == (1.0, 0.0, 0.0, 0.0)
    act.values().position = (0.1, 0.2, 0.3)
    was = acts.motion(act.obs[0])
    _choose(act, scale="limb_length", secondary_relative=True)
    assert acts.apart(acts.motion(act.obs[0]), was) < SAME
    assert tuple(act.values(1).position) == tuple(act.values(0).position) != (0.1, 0.2, 0.3)
    assert not keys.curves(act.action)


def test_values_next_to_keys_are_not_keyed_by_a_change_of_mode() -> None:
    act = _hands()
    bpy.context.scene.tool_settings.use_keyframe_insert_auto = True
    act.values().position = (0.1, 0.2, 0.3)
    act.obs[0].keyframe_insert(keys.path("Hand", "position"), index=0, frame=4)
    _choose(act, scale="limb_length")
    assert list(keys.curves(act.action)) == [(keys.path("Hand", "position"), 0)]
    assert _times(act) == [[4.0]]


def test_a_change_is_undone_with_its_keys() -> None:
    act = _hands()
    _key(act)
    bpy.ops.ed.undo_push(message="before")
    was, text = scenes.keys_of(act.action), act.channel().keyed_in
    _choose(act, **MIXING)
    changed, new = scenes.keys_of(act.action), act.channel().keyed_in
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    action = bpy.data.actions["Act"]
    assert scenes.keys_of(action) == was
    assert (of_action(action).channels[0].keyed_in, of_action(action).channels[0].scale) == (text, "none")
    bpy.ops.ed.redo()
    action = bpy.data.actions["Act"]
    assert scenes.keys_of(action) == changed
    assert of_action(action).channels[0].keyed_in == new


def test_a_channel_that_nobody_plays_takes_new_modes_as_they_are() -> None:
    act = _hands()
    _key(act)
    cast.remove(act.obs[0])
    keyed = scenes.keys_of(act.action)
    _choose(act, scale="limb_length")
    assert scenes.keys_of(act.action) == keyed
    assert definitions.from_text(act.channel().keyed_in)[0].scale == "limb_length"
