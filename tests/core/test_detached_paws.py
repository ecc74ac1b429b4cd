"""Paws, feet and hands that are roots of their own, as where inverse kinematics was baked: they end their limbs."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.morphology import Capability, LimbKind
from tests.morph_bodies import real_characters
from tests.skeletons import numbered, skeleton_of
from tools.creatures import CREATURES
from tools.figure import Bone, Build, blender, humanoid

PAWS = ("FrontPaw.L", "FrontPaw.R", "HindPaw.L", "HindPaw.R")
FEET = ("Foot.L", "Foot.R")
BODIES: Mapping[str, tuple[Callable[[], Sequence[Bone]], Collection[str]]] = {
    "hound": (CREATURES["hound"], PAWS),
    "human": (lambda: humanoid(build=Build(fingers=2, root=True), names=blender), FEET),
    "human without toes": (lambda: humanoid(build=Build(fingers=2, toes=False), names=blender), FEET),
    "human without hands": (lambda: humanoid(build=Build(fingers=2), names=blender), ("Hand.L", "Hand.R")),
}


def _plain(bones: Sequence[Bone]) -> list[Bone]:
    return [Bone(b.name, b.parent, b.head, b.tail) for b in bones]


def _apart(bones: Sequence[Bone], paws: Collection[str], rename: Mapping[str, str] | None = None) -> list[Bone]:
    """Return a body whose paws hang on nothing, after all that does not hang on them."""
    names = rename or {}
    out = [replace(b, parent=None) if b.name in paws else b for b in _plain(bones)]
    return [replace(b, name=names.get(b.name, b.name), parent=names.get(b.parent or "", b.parent)) for b in out]


def _limbs(found: Character) -> set[tuple[object, ...]]:
    name = found.skeleton.names
    return {(m.kind, m.side, m.row, tuple(name[b] for b in m.bones)) for m in found.limbs}


# --- a real one ---


def test_the_wolf_stands_on_its_paws(data: Path) -> None:
    wolf = real_characters(data)["quaternius_wolf"]
    names = wolf.skeleton.names
    ends = [(names[leg.end], leg.side, leg.row) for leg in wolf.legs]
    assert ends == [("FF.L", 1, 0), ("FF.R", -1, 0), ("FFB.L", 1, 1), ("FFB.R", -1, 1)]
    assert {names[leg.bones[-2]] for leg in wolf.legs} == {
        f"{leg}LowerLeg.{s}" for leg in ("Front", "Back") for s in "LR"
    }
    heights = wolf.local_to_character.points(wolf.skeleton.rest_positions)[:, 2]
    feet = heights[[leg.end for leg in wolf.legs]]
    assert (feet > 0.0).all()
    assert (feet < 0.05 * wolf.frame.height).all()
    assert wolf.frame.height > 0.95 * float(np.ptp(heights))


def test_its_controls_are_no_bones_of_its_legs(data: Path) -> None:
    wolf = real_characters(data)["quaternius_wolf"]
    names, tagged = wolf.skeleton.names, wolf.capabilities
    assert sum(Capability.FOOT in own for own in tagged.values()) == 4
    assert not any(name.startswith(("IK", "Pole")) for name in tagged)
    assert not any(names[b].startswith(("IK", "Pole")) for leg in wolf.legs for b in (*leg.bones, *leg.digits))


# --- our own ---


@pytest.mark.parametrize("body", BODIES)
def test_a_body_taken_apart_is_read_as_the_whole(body: str) -> None:
    make, paws = BODIES[body]
    whole, apart = (analyze(skeleton_of(bones)) for bones in (_plain(make()), _apart(make(), paws)))
    assert _limbs(apart) == _limbs(whole)
    assert {j: m.bone for j, m in apart.joints.items()} == {j: m.bone for j, m in whole.joints.items()}
    assert apart.capabilities == whole.capabilities
    assert np.allclose(apart.frame.origin, whole.frame.origin)
    assert np.isclose(apart.frame.height, whole.frame.height)


@pytest.mark.parametrize("body", ["hound", "human without toes"])
def test_paws_may_be_called_anything(body: str) -> None:
    make, paws = BODIES[body]
    names = {paw: f"FX{paw[0]}.{paw[-1]}" for paw in paws}
    found = analyze(skeleton_of(_apart(make(), paws, names)))
    assert {found.skeleton.names[leg.end] for leg in found.legs} == set(names.values())
    assert np.isclose(found.frame.origin[2], 0.0)


def test_nothing_needs_a_name() -> None:
    make, paws = BODIES["human without toes"]
    bones, names = numbered(_apart(make(), paws), np.random.default_rng(3))
    found = analyze(skeleton_of(bones))
    assert {found.skeleton.names[leg.end] for leg in found.legs} == {names[foot] for foot in FEET}
    assert found.humanoid


# --- what is no paw ---


def _with(extra: Mapping[str, tuple[float, float, float]]) -> Character:
    """Return a human beside whom other bones stand, each a root."""
    bones = _plain(humanoid(build=Build(toes=False, fingers=2), names=blender))
    return analyze(skeleton_of([*bones, *(Bone(n, None, at, (at[0], at[1] - 0.05, at[2])) for n, at in extra.items())]))


@pytest.mark.parametrize(
    "places",
    [
        {"Bone.031": (0.09, -0.05, 0.08), "Bone.032": (-0.09, -0.05, 0.08)},
        {"Bone.031": (0.09, -0.6, 0.49), "Bone.032": (-0.09, -0.6, 0.49)},
        {"ik_foot.L": (0.1, 0.2, 0.3), "ik_foot.R": (-0.1, 0.2, 0.3)},
        {"Ball": (0.3, -0.3, 0.1)},
        {"Eye.L": (0.04, -0.1, 1.65), "Eye.R": (-0.04, -0.1, 1.65)},
    ],
    ids=["targets in the feet", "poles before the knees", "controls", "a ball", "eyes"],
)
def test_other_roots_change_no_limb(places: Mapping[str, tuple[float, float, float]]) -> None:
    assert _limbs(_with(places)) == _limbs(_with({}))


def test_a_paw_needs_its_mirror_image() -> None:
    make, paws = BODIES["hound"]
    bones = [b for b in _plain(make()) if b.name not in paws]
    ball = Bone("Bone.007", None, (0.09, -0.2, 0.06), (0.09, -0.25, 0.06))
    assert _limbs(analyze(skeleton_of([*bones, ball]))) == _limbs(analyze(skeleton_of(bones)))


def test_a_limb_that_hangs_on_nothing_at_all_is_left_alone() -> None:
    make, _ = BODIES["human"]
    whole = analyze(skeleton_of(_plain(make())))
    found = analyze(skeleton_of(_apart(make(), ("UpperArm.L", "UpperArm.R"))))
    arms = [m for m in found.limbs if m.kind is LimbKind.ARM]
    assert all("Clavicle" not in found.skeleton.names[b] for m in arms for b in m.bones)
    assert {m for m in _limbs(found) if m[0] is LimbKind.LEG} == {m for m in _limbs(whole) if m[0] is LimbKind.LEG}


def test_bones_that_all_hang_on_nothing_are_read_without_complaint() -> None:
    bones = [replace(b, parent=None) for b in _plain(humanoid(names=blender))]
    assert analyze(skeleton_of(bones)).legs == []
