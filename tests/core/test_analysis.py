"""What a rig is: bodies of many builds, placements and names, with clutter, without names, and against the truth."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import Overrides, analyze
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.errors import MappingError, RigError
from tests.skeletons import numbered, skeleton_of
from tools.figure import CHIBI, Bone, Build, blender, humanoid, moved, spaced, vrm

BUILDS = {
    "plain": Build(),
    "whole hands": Build(fingers=5),
    "long spine": Build(spine=5, neck=2, fingers=2),
    "short spine": Build(spine=1, neck=0, clavicles=False, toes=False),
    "twist bones": Build(twists=3, fingers=5),
    "A-pose": Build(arms_down=45.0, fingers=5, root=True),
    "arms down": Build(arms_down=80.0),
}
_EXPECTED = ("hips", "head", "leftHand", "rightHand", "leftUpperArm", "rightLowerArm", "leftFoot", "rightLowerLeg")


def _joints(bones: Sequence[Bone], placement: Placement | None = None, **options: object) -> dict[str, str]:
    found = analyze(skeleton_of(bones), placement, **options)
    return {joint: match.bone for joint, match in found.joints.items()}


@pytest.mark.parametrize("build", BUILDS.values(), ids=BUILDS)
@pytest.mark.parametrize("names", [vrm, blender, spaced])
def test_every_joint_of_a_named_body_is_found(build: Build, names: object) -> None:
    bones = humanoid(build=build, names=names)
    found = _joints(bones)
    canonical = {b.name for b in humanoid(build=build) if "Twist" not in b.name and b.name != "root"}
    canonical = {j for j in canonical if not j.removeprefix("spine").isdigit() and not j.removeprefix("neck").isdigit()}
    if build.spine == 1:
        canonical -= {"spine"}
        found.pop("spine", None)
    if build.spine > 3:
        # Which of five spine bones is the chest is a matter of taste; ends are not.
        for joint in ("chest", "upperChest"):
            canonical.discard(joint)
            found.pop(joint, None)
    assert found == {joint: names(joint) for joint in canonical}


@pytest.mark.parametrize("build", [b for k, b in BUILDS.items() if k != "arms down"])
def test_a_body_without_names_is_found_from_its_shape(build: Build) -> None:
    bones, names = numbered(humanoid(build=build), np.random.default_rng(8))
    found = _joints(bones)
    for joint in _EXPECTED:
        assert found.get(joint) == names[joint], joint


def test_a_body_with_a_big_head_and_short_legs_is_found_without_names() -> None:
    bones, names = numbered(humanoid(proportions=CHIBI, build=Build(fingers=3)), np.random.default_rng(9))
    found = _joints(bones)
    assert {j: found.get(j) for j in _EXPECTED} == {j: names[j] for j in _EXPECTED}


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("numbers", [False, True])
def test_the_user_s_up_axis_holds_whatever_is_seen(axis: int, numbers: bool) -> None:
    bones = humanoid()
    up = np.eye(3)[axis]
    for side in (up, -up):
        skeleton = skeleton_of(numbered(bones, np.random.default_rng(3))[0] if numbers else bones)
        found = analyze(skeleton, None, Overrides(up=side))
        assert np.allclose(found.frame.up, side, atol=1e-6)
        assert abs(found.frame.forward @ side) < 1e-6


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (np.pi / 2, 0.0, 0.0), (0.0, 0.0, 2.0), (0.0, 0.0, np.pi)])
def test_scaled_and_turned_objects_stand_as_they_do_in_the_world(scale: float, turn: tuple[float, ...]) -> None:
    rotation = quat.to_matrix(quat.from_rotation_vector(np.array(turn)))
    placement = Placement(rotation, scale, np.array([3.0, -2.0, 0.0]))
    back = np.eye(4)
    back[:3, :3] = rotation.T / scale
    upright = Placement(quat.to_matrix(quat.from_rotation_vector(np.array([0.0, 0.0, turn[2]]))), 1.0, np.zeros(3))
    bones = moved(humanoid(height=1.8, build=Build(fingers=5)), back @ _as_matrix(upright))
    found = analyze(skeleton_of(bones), placement)
    assert found.humanoid
    assert found.joints["leftHand"].bone == "leftHand"
    assert found.frame.height == pytest.approx(1.8, rel=0.15)
    assert np.allclose(found.frame.up, [0, 0, 1], atol=1e-6)
    assert np.allclose(found.frame.forward, upright.rotation @ [0, -1, 0], atol=1e-3)


def _as_matrix(placement: Placement) -> np.ndarray:
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = placement.scale * placement.rotation, placement.translation
    return out


def test_a_mirrored_object_keeps_the_sides_of_its_names_only_where_the_body_agrees() -> None:
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    swapped = moved(humanoid(build=Build(fingers=5)), mirror)
    found = analyze(skeleton_of(swapped))
    # Named left, but on the right of a body that faces -Y with its toes: the body decides, with a warning.
    assert found.joints["leftHand"].bone == "rightHand"
    assert any("contradict the body" in warning for warning in found.warnings)


def test_the_user_can_override_the_front() -> None:
    found = analyze(skeleton_of(humanoid()), None, Overrides(forward=np.array([0.0, 1.0, 0.0])))
    assert np.allclose(found.frame.forward, [0.0, 1.0, 0.0])


def _clutter(bones: Sequence[Bone], named: bool) -> list[Bone]:
    """Return a body with hair, a tail, a skirt, a sword on its back and control bones."""
    hips, head, chest = (next(b for b in bones if b.name == j) for j in ("hips", "head", "upperChest"))
    extra: list[Bone] = []

    def chain(stem: str, parent: str, start: np.ndarray, step: np.ndarray, count: int) -> None:
        above = parent
        for i in range(count):
            name = f"{stem}{i + 1}" if named else f"thing {stem[::-1]}{i}"
            head_, tail = start + i * step, start + (i + 1) * step
            extra.append(Bone(name, above, tuple(head_), tuple(tail)))
            above = name

    for side in (-1.0, 1.0):
        chain(
            f"hair_{'l' if side > 0 else 'r'}_",
            head.name,
            np.array([side * 0.08, 0.05, 1.7]),
            np.array([side * 0.02, 0.02, -0.1]),
            4,
        )
        chain(
            f"skirt_{'l' if side > 0 else 'r'}_",
            hips.name,
            np.array([side * 0.2, 0.0, 0.9]),
            np.array([side * 0.02, 0, -0.15]),
            3,
        )
    chain("tail", hips.name, np.array([0.0, 0.1, 0.95]), np.array([0.0, 0.12, -0.05]), 5)
    chain("sword", chest.name, np.array([0.15, 0.12, 1.5]), np.array([-0.1, 0.02, -0.2]), 3)
    chain("ik_hand_l", bones[0].name, np.array([0.7, 0.0, 1.4]), np.array([0.05, 0.0, 0.0]), 1)
    return [*bones, *extra]


@pytest.mark.parametrize("named", [True, False], ids=["named", "called otherwise"])
def test_hair_skirts_tails_and_swords_are_no_limbs(named: bool) -> None:
    bones = humanoid(build=Build(fingers=5, twists=1, root=True))
    plain = _joints(bones)
    assert _joints(_clutter(bones, named)) == plain


def test_capabilities_of_a_humanoid() -> None:
    found = analyze(skeleton_of(humanoid(build=Build(fingers=5, root=True))))
    tags = {bone: [c.value for c in own] for bone, own in found.capabilities.items()}
    assert tags["root"] == ["root"]
    assert tags["leftFoot"] == ["foot", "limb"]
    assert tags["rightHand"] == ["grasper", "limb"]
    assert tags["leftIndexProximal"] == ["finger"]
    assert "spine" in tags["chest"]
    assert "head" in tags["head"]
    assert [(leg.side, leg.row) for leg in found.legs] == [(1, 0), (-1, 0)]


def test_confidence_and_evidence_are_recorded() -> None:
    by_name = analyze(skeleton_of(humanoid())).joints
    by_shape = analyze(skeleton_of(numbered(humanoid(), np.random.default_rng(10))[0])).joints
    assert {match.by for match in by_name.values()} == {"name"}
    assert "name" not in {match.by for match in by_shape.values()}
    assert all(0.0 <= m.confidence <= 1.0 for m in (*by_name.values(), *by_shape.values()))


def test_users_joints_replace_what_was_found() -> None:
    bones = humanoid(build=Build(fingers=2))
    found = _joints(bones, overrides=Overrides(joints={"leftHand": "leftThumbMetacarpal", "jaw": "", "head": ""}))
    assert found["leftHand"] == "leftThumbMetacarpal"
    assert "head" not in found
    assert "leftThumbMetacarpal" not in found


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ({"leftHoof": "leftFoot"}, "unknown joint 'leftHoof': the names are hips, spine"),
        (
            {"hips": "Pelvis"},
            "joint hips is mapped to bone 'Pelvis', which the armature does not have: correct the map",
        ),
        ({"hips": "spine", "chest": "spine"}, "bone 'spine' is mapped to both hips and chest: keep one"),
    ],
)
def test_impossible_joints_are_refused(joints: dict[str, str], message: str) -> None:
    with pytest.raises(MappingError, match=message):
        analyze(skeleton_of(humanoid()), None, Overrides(joints=joints))


def test_one_bone_tells_nothing() -> None:
    bone = replace(humanoid()[0], parent=None)
    with pytest.raises(RigError, match="has one bone, 'hips', which tells nothing: choose a whole rig"):
        analyze(skeleton_of([bone]))


@pytest.mark.parametrize("seed", range(5))
def test_the_decision_does_not_depend_on_the_order_of_bones(seed: int) -> None:
    bones = humanoid(build=Build(fingers=5, twists=1))
    rng = np.random.default_rng(seed)
    # Siblings in another order; parents still come first.
    shuffled: list[Bone] = [bones[0]]
    for bone in shuffled:
        children = [b for b in bones if b.parent == bone.name]
        shuffled.extend(children[i] for i in rng.permutation(len(children)))
    assert _joints(shuffled) == _joints(bones)


@pytest.mark.parametrize("name", ['arm"L"', "hand]", "[bone]", "骨🦴", "a" * 60, "\\", "b'c"])
def test_strange_names_are_harmless(name: str) -> None:
    bones = [replace(b, name=name) if b.name == "jaw" else b for b in humanoid()]
    bones.append(Bone(name, "head", (0.0, -0.1, 1.6), (0.0, -0.15, 1.6)))
    assert _joints(bones)["head"] == "head"
