"""Legs that stand in the middle of a body: third legs and only legs are found, and tails stay tails."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.character.morphology import Capability, LimbKind
from morph_retarget.core.locomotion.stepping import legs
from tests.morph_bodies import real_characters
from tests.skeletons import numbered, skeleton_of
from tools.creatures import CREATURES
from tools.figure import Bone, Build, Point, humanoid, moved

# --- bodies ---


def _chain(names: Sequence[str], parent: str, points: Sequence[Point]) -> list[Bone]:
    above = [parent, *names]
    return [Bone(n, p, a, b) for n, p, a, b in zip(names, above, points[:-1], points[1:], strict=False)]


def _leg(mark: str, parent: str, x: float, y: float, hip: float, ankle_y: float | None = None) -> list[Bone]:
    """Return a leg with a bent knee and toes; ``ankle_y`` is where it stands when that is not under its hip."""
    ankle = y if ankle_y is None else ankle_y
    knee = (x, 0.5 * (y + ankle) - 0.05, 0.5 * hip)
    points = [(x, y, hip), knee, (x, ankle, 0.08), (x, ankle - 0.15, 0.02), (x, ankle - 0.2, 0.02)]
    return _chain([part + mark for part in ("thigh", "shin", "foot", "toe")], parent, points)


def _pair(mark: str, parent: str, y: float, hip: float) -> list[Bone]:
    return [*_leg(f"{mark}.L", parent, 0.15, y, hip), *_leg(f"{mark}.R", parent, -0.15, y, hip)]


def _upright() -> list[Bone]:
    return [
        Bone("hips", None, (0.0, 0.0, 0.9), (0.0, 0.0, 1.05)),
        Bone("spine", "hips", (0.0, 0.0, 1.05), (0.0, 0.0, 1.4)),
        Bone("head", "spine", (0.0, 0.0, 1.4), (0.0, 0.0, 1.7)),
    ]


def _prone() -> list[Bone]:
    points = [(0.0, 0.5, 0.9), (0.0, 0.2, 0.9), (0.0, -0.2, 0.9), (0.0, -0.5, 0.95), (0.0, -0.7, 1.2), (0.0, -1.0, 1.2)]
    hips = Bone("hips", None, points[0], points[1])
    return [hips, *_chain(("spine", "chest", "neck", "head"), "hips", points[1:])]


def _hopper() -> list[Bone]:
    return [*_upright(), *_leg("", "hips", 0.0, 0.0, 0.85)]


def _armed_hopper() -> list[Bone]:
    trunk = [b for b in humanoid(build=Build(fingers=2)) if not {"Leg", "Foot", "Toe"} & _parts(b.name)]
    return [*trunk, *_leg("", "hips", 0.0, 0.0, 0.85)]


def _parts(name: str) -> set[str]:
    return {part for part in ("Leg", "Foot", "Toe") if part in name}


def _tripod() -> list[Bone]:
    return [*_upright(), *_pair("", "hips", 0.0, 0.85), *_leg("3", "hips", 0.0, 0.0, 0.85)]


def _third_hind_leg() -> list[Bone]:
    return [*_prone(), *_pair("F", "chest", -0.45, 0.8), *_leg("B", "hips", 0.0, 0.5, 0.8)]


def _armed_tripod() -> list[Bone]:
    return [*humanoid(build=Build(fingers=2)), *_leg("3", "hips", 0.0, 0.0, 0.85)]


BODIES: Mapping[str, Callable[[], list[Bone]]] = {
    "hopper": _hopper,
    "armed hopper": _armed_hopper,
    "tripod": _tripod,
    "third hind leg": _third_hind_leg,
    "armed tripod": _armed_tripod,
}
COUNT = {"hopper": 1, "armed hopper": 1, "tripod": 3, "third hind leg": 3, "armed tripod": 3}


def _tail(parent: str, *points: Point) -> list[Bone]:
    return _chain([f"tail{i}" for i in range(1, len(points))], parent, points)


def _kangaroo() -> list[Bone]:
    tail = _tail("hips", (0, 0.1, 0.8), (0, 0.3, 0.5), (0, 0.55, 0.2), (0, 0.8, 0.05), (0, 1.0, 0.02))
    return [*_upright(), *_pair("", "hips", 0.0, 0.85), *tail]


def _horse() -> list[Bone]:
    tail = _tail("hips", (0, 0.65, 0.9), (0, 0.7, 0.6), (0, 0.7, 0.3), (0, 0.7, 0.05), (0, 0.7, 0.0))
    return [*_prone(), *_pair("F", "chest", -0.45, 0.8), *_pair("B", "hips", 0.5, 0.8), *tail]


def _rat() -> list[Bone]:
    low = [Bone(b.name, b.parent, (*b.head[:2], 0.35 * b.head[2]), (*b.tail[:2], 0.35 * b.tail[2])) for b in _prone()]
    tail = _tail("hips", (0, 0.6, 0.28), (0, 0.75, 0.1), (0, 1.0, 0.02), (0, 1.3, 0.01), (0, 1.6, 0.01))
    return [*low, *_pair("F", "chest", -0.45, 0.25), *_pair("B", "hips", 0.5, 0.25), *tail]


def _cobra() -> list[Bone]:
    rising = [(0.0, 0.0, 0.5), (0.0, -0.05, 0.6), (0.0, -0.1, 0.7), (0.0, -0.25, 0.7)]
    body = [(0, 0.0, 0.5), (0, 0.1, 0.25), (0, 0.2, 0.04), *((0, 0.2 + 0.25 * i, 0.02) for i in range(1, 7))]
    neck = [Bone("middle", None, (0, 0.05, 0.5), rising[0]), *_chain(("neck", "head"), "middle", rising[1:])]
    return [*neck, *_tail("middle", *body)]


TAILED: Mapping[str, Callable[[], Sequence[Bone]]] = {
    "kangaroo": _kangaroo,
    "horse": _horse,
    "rat": _rat,
    "cobra": _cobra,
    "snake": CREATURES["snake"],
    "hound": CREATURES["hound"],
}


def _nameless(bones: Sequence[Bone]) -> tuple[Character, Mapping[str, str]]:
    """Return what is made of a body without names, and the old names by the new ones."""
    without, names = numbered(bones, np.random.default_rng(5))
    return analyze(skeleton_of(without)), {new: old for old, new in names.items()}


def _names(found: Character, bones: Sequence[int]) -> list[str]:
    return [found.skeleton.names[bone] for bone in bones]


# --- legs ---


@pytest.mark.parametrize("body", BODIES)
def test_a_leg_in_the_middle_has_a_foot_and_no_side(body: str) -> None:
    found = analyze(skeleton_of(BODIES[body]()))
    assert len(found.legs) == COUNT[body]
    (leg,) = (m for m in found.legs if m.side == 0)
    assert [name.rstrip("3B") for name in _names(found, leg.bones)] == ["thigh", "shin", "foot"]
    assert found.capabilities[found.skeleton.names[leg.end]] == (Capability.FOOT, Capability.LIMB)
    assert found.tails == ()
    assert not {*found.spine, *found.neck} & {*leg.bones, *leg.digits}
    assert np.isclose(found.frame.origin[2], 0.0)


@pytest.mark.parametrize("body", BODIES)
def test_it_needs_no_names_where_its_foot_is_under_the_body(body: str) -> None:
    bones = BODIES[body]()
    found, named = _nameless(bones)
    assert len(found.legs) == COUNT[body]
    (leg,) = (m for m in found.legs if m.side == 0)
    assert [named[name].rstrip("3B") for name in _names(found, leg.bones)][:3] == ["thigh", "shin", "foot"]
    assert found.tails == ()


@pytest.mark.parametrize(("mark", "count"), [("", 3), ("nameless", 2)])
def test_names_alone_tell_a_leg_that_stands_behind_from_a_tail(mark: str, count: int) -> None:
    bones = [*_upright(), *_pair("", "hips", 0.0, 0.85), *_leg("3", "hips", 0.0, 0.1, 0.85, ankle_y=0.45)]
    found = _nameless(bones)[0] if mark else analyze(skeleton_of(bones))
    assert len(found.legs) == count


def test_what_is_called_a_leg_but_ends_in_the_air_is_none() -> None:
    high = [Bone(b.name, b.parent, (*b.head[:2], b.head[2] + 0.4), b.tail) for b in _leg("3", "hips", 0.0, 0.0, 0.85)]
    found = analyze(skeleton_of([*_upright(), *_pair("", "hips", 0.0, 0.85), *high]))
    assert [leg.side for leg in found.legs] == [1, -1]


def test_toes_on_both_sides_of_a_foot_in_the_middle_are_its_digits() -> None:
    toes = [Bone(f"toe.{side}", "foot", (x, -0.12, 0.02), (x, -0.2, 0.02)) for side, x in (("L", 0.05), ("R", -0.05))]
    found = analyze(skeleton_of([*_hopper()[:-1], *toes]))
    (leg,) = found.limbs
    assert _names(found, leg.bones) == ["thigh", "shin", "foot"]
    assert sorted(_names(found, leg.digits)) == ["toe.L", "toe.R"]


def test_a_leg_between_two_others_is_in_their_row() -> None:
    for bones in (_tripod(), _armed_tripod()):
        assert [(leg.side, leg.row) for leg in analyze(skeleton_of(bones)).legs] == [(1, 0), (0, 0), (-1, 0)]
    assert [leg.row for leg in analyze(skeleton_of(_third_hind_leg())).legs] == [0, 0, 1]


def test_a_body_on_one_leg_is_no_humanoid_and_a_man_with_a_third_leg_is() -> None:
    for bones, humanoid_ in ((_armed_hopper(), False), (_armed_tripod(), True)):
        found = analyze(skeleton_of(bones))
        for character in (found, _nameless(bones)[0]):
            assert character.humanoid == humanoid_
            assert sum(m.kind is LimbKind.ARM for m in character.limbs) == 2
    assert not {"leftUpperLeg", "rightUpperLeg", "leftFoot"} & analyze(skeleton_of(_armed_hopper())).joints.keys()


def test_legs_that_start_in_the_middle_and_lead_away_from_it_have_sides() -> None:
    bones = [*_third_hind_leg()[:5], *_pair("F", "chest", -0.45, 0.8), *_pair("B", "hips", 0.5, 0.8)]
    middle = [Bone(b.name, b.parent, (0.0, *b.head[1:]), b.tail) if "thigh" in b.name else b for b in bones]
    assert [leg.side for leg in _nameless(middle)[0].legs] == [1, -1, 1, -1]


@pytest.mark.parametrize("seed", range(4))
def test_it_is_found_wherever_the_armature_is_placed_and_however_it_is_scaled(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = quat.to_matrix(quat.from_rotation_vector(np.array([np.pi / 2, 0.0, rng.uniform(-3.0, 3.0)])))
    placement = Placement(turn, float(10.0 ** rng.uniform(-2.0, 0.0)), rng.normal(size=3) * [1.0, 1.0, 0.0])
    inverse, back = placement.inverse(), np.eye(4)
    back[:3, :3], back[:3, 3] = inverse.scale * inverse.rotation, inverse.translation
    for bones in (_tripod(), _third_hind_leg()):
        here = analyze(skeleton_of(bones))
        there = analyze(skeleton_of(moved(bones, back), rng), placement)
        assert there.limbs == here.limbs


@pytest.mark.parametrize("body", BODIES)
def test_a_body_steps_on_it(body: str) -> None:
    found = legs.find(analyze(skeleton_of(BODIES[body]())))
    middle = next(leg for leg in found.legs if leg.side == 0)
    assert sum(len(group.legs) for group in found.groups) == COUNT[body]
    assert len(middle.path) == 3
    assert np.isclose(middle.home[0], 0.0)
    assert np.isclose(middle.sole, 0.0)
    assert middle.tip[1] < 0.0


# --- tails ---


@pytest.mark.parametrize("body", TAILED)
def test_tails_that_reach_the_ground_are_no_legs(body: str) -> None:
    bones = TAILED[body]()
    named, (nameless, _) = analyze(skeleton_of(bones)), _nameless(bones)
    assert named.tails
    assert len(named.legs) == sum(b.name.lower().startswith(("shin", "lowerarm")) for b in bones)
    assert all(limb.side for found in (named, nameless) for limb in found.limbs)


def test_real_bodies_have_no_legs_in_the_middle(data: Path) -> None:
    for name, found in real_characters(data).items():
        assert all(leg.side for leg in found.legs), name
