"""Which controls pose a rig: by the names of families, and by what bones copy."""

from dataclasses import replace

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.character import control_names, controls, deform_tree
from morph_retarget.core.character.control_facts import BoneFacts, Follows
from morph_retarget.core.character.control_given import Reaching
from morph_retarget.core.character.control_limbs import Setting
from morph_retarget.core.character.control_names import FAMILIES, Limb
from morph_retarget.core.character.controls import Wanted
from morph_retarget.core.errors import MappingError
from morph_retarget.core.skeleton import Skeleton

RIGIFY, AUTO_RIG_PRO, CLOUDRIG = FAMILIES
SIDES = ("L", "R")


def bone(name: str, parent: str | None = None, *follows: Follows, props: tuple[str, ...] = ()) -> BoneFacts:
    deform = name.startswith("DEF-")
    return BoneFacts(name, parent, deform, not deform and not name.startswith(("ORG-", "MCH-")), follows, props)


def copying(*names: str, switch: tuple[str, str] | None = None, counts: tuple[float, float] = (1.0, 1.0)) -> Follows:
    return Follows("COPY_TRANSFORMS", names, switch, counts)


def leg(side: str) -> list[BoneFacts]:
    """Return a leg as Rigify builds it, without what lies between."""
    switch = f"thigh_parent.{side}", "IK_FK"
    out = [bone(f"thigh_parent.{side}", "ORG-spine", props=("IK_FK", "pole_vector"))]
    above = "torso"
    for part in ("thigh", "shin", "foot"):
        out += [
            bone(f"{part}_fk.{side}", above),
            bone(
                f"ORG-{part}.{side}",
                None,
                copying(f"{part}_fk.{side}"),
                copying(f"MCH-{part}_ik.{side}", switch=switch, counts=(1.0, 0.0)),
            ),
            bone(f"MCH-{part}_ik.{side}", "root"),
            bone(f"DEF-{part}.{side}", None, copying(f"ORG-{part}.{side}")),
        ]
        above = f"{part}_fk.{side}"
    return [*out, bone(f"foot_ik.{side}", "root"), bone(f"thigh_ik_target.{side}", "root")]


RIG = [
    bone("root"),
    bone("torso", "root", props=("neck_follow",)),
    bone("spine_fk", "MCH-spine"),
    bone("MCH-spine", "torso"),
    bone("hips", "torso"),
    bone("ORG-spine", "tweak_spine"),
    bone("tweak_spine", "spine_fk"),
    bone("DEF-spine", "root", copying("tweak_spine")),
    *(fact for side in SIDES for fact in leg(side)),
]
LIMBS = [Limb("leg", f"DEF-thigh.{s}", f"DEF-shin.{s}", f"DEF-foot.{s}") for s in SIDES]
BONES = ["DEF-spine", *(b for limb in LIMBS for b in (limb.upper, limb.middle, limb.end))]
WANTED = Wanted(BONES, {"hips": "DEF-spine"}, LIMBS)


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("thigh.L", ("thigh", ".L")),
        ("spine.001", ("spine", ".001")),
        ("f_index.01.R", ("f_index.01", ".R")),
        ("thigh.L.001", ("thigh", ".L.001")),
        ("root.x", ("root", ".x")),
        ("arm_l", ("arm", "_l")),
        ("head", ("head", "")),
        ("", ("", "")),
    ],
)
def test_side_and_number_end_a_name(name: str, parts: tuple[str, str]) -> None:
    assert control_names.split(name) == parts


@pytest.mark.parametrize(
    ("family", "deform", "control"),
    [
        (RIGIFY, "DEF-upper_arm.L", "upper_arm_fk.L"),
        (RIGIFY, "DEF-spine.001", "spine_fk.001"),
        (RIGIFY, "DEF-f_index.01.L", "f_index.01.L"),
        (AUTO_RIG_PRO, "forearm_stretch.l", "c_forearm_fk.l"),
        (AUTO_RIG_PRO, "toes_01.r", "c_toes_fk.r"),
        (AUTO_RIG_PRO, "root.x", "c_root.x"),
        (CLOUDRIG, "DEF-UpperArm1.L", "FK-UpperArm.L"),
        (CLOUDRIG, "DEF-UpperArm_1.L", "FK-UpperArm.L"),
        (CLOUDRIG, "DEF-Spine2", "FK-Spine2"),
    ],
)
def test_families_name_controls_after_parts(family: control_names.Family, deform: str, control: str) -> None:
    assert control_names.among(family.turning, control_names.bases(family, deform), {control, "other"}) == control


def test_a_rig_of_a_known_family_is_read() -> None:
    found = controls.read(RIG, WANTED)
    assert found is not None
    assert found.family == "Rigify"
    assert found.turning["DEF-shin.R"] == "shin_fk.R"
    assert found.trunk == "torso"
    assert found.carriers["shin_fk.L"] == "thigh_fk.L"
    assert found.carriers["spine_fk"] == "torso"
    assert found.settings == (Setting("torso", "neck_follow", 1.0),)
    assert {"tweak_spine", "root"} <= set(found.still)
    assert "hips" not in found.still, "nothing follows it here"


def test_limbs_are_switched_and_reach() -> None:
    found = controls.read(RIG, WANTED)
    assert found is not None
    left = found.limbs[0]
    assert (left.control, left.pole) == ("foot_ik.L", "thigh_ik_target.L")
    assert [(s.bone, s.prop, s.value) for s in left.turned] == [("thigh_parent.L", "IK_FK", 1.0)]
    assert [(s.prop, s.value) for s in left.reached] == [("IK_FK", 0.0), ("pole_vector", 1.0)]


@pytest.mark.parametrize("high", [0.0, 1.0])
def test_which_value_of_a_switch_turns_is_read_from_what_it_does(high: float) -> None:
    """Drivers tell it whatever the property is called and whichever way it counts."""
    counts = (1.0 - high, high)
    rig = [
        BoneFacts(
            f.name,
            f.parent,
            f.deform,
            f.shaped,
            tuple(
                Follows(one.kind, one.bones, ("thigh_parent.L", "Mode"), counts) if one.switch else one
                for one in f.follows
            ),
            f.properties,
        )
        for f in RIG
    ]
    found = controls.read(rig, WANTED)
    assert found is not None
    assert [(s.prop, s.value) for s in found.limbs[0].turned] == [("Mode", 1.0 - high)]


def test_rigs_of_no_family_are_read_by_what_bones_copy() -> None:
    plain = [
        bone("Hip Control"),
        bone("MCH-a", "Hip Control"),
        bone("DEF-a", None, copying("MCH-a")),
        bone("Leg Control", "Hip Control"),
        bone("DEF-b", "DEF-a", copying("Leg Control")),
        bone("DEF-c", "DEF-b"),
    ]
    found = controls.read(plain, Wanted(["DEF-a", "DEF-b", "DEF-c"], {"hips": "DEF-a"}))
    assert found is not None
    assert found.family == controls.FOUND
    assert dict(found.turning) == {"DEF-a": "Hip Control", "DEF-b": "Leg Control", "DEF-c": "DEF-c"}
    assert found.trunk == "Hip Control"


def test_rigs_that_are_posed_by_their_bones_have_no_controls() -> None:
    plain = [bone("DEF-a"), bone("DEF-b", "DEF-a")]
    assert controls.read(plain, Wanted(["DEF-a", "DEF-b"], {"hips": "DEF-a"})) is None


def test_what_the_user_names_counts_and_must_exist() -> None:
    wanted = Wanted(BONES, {"hips": "DEF-spine"}, LIMBS, given={"DEF-spine": "hips"})
    found = controls.read(RIG, wanted)
    assert found is not None
    assert (found.turning["DEF-spine"], found.trunk) == ("hips", "hips")
    with pytest.raises(MappingError, match="control 'Nobody', which the armature does not have"):
        controls.read(RIG, Wanted(BONES, {}, given={"DEF-spine": "Nobody"}))


def test_rigs_that_copy_in_circles_are_read_too() -> None:
    circle = [
        bone("DEF-a", "DEF-b", copying("ORG-a")),
        bone("ORG-a", "ORG-b", copying("ORG-b")),
        bone("ORG-b", "ORG-a", copying("ORG-a", "Gone")),
        bone("DEF-b", None, copying("ORG-b")),
    ]
    found = controls.read(circle, Wanted(["DEF-a", "DEF-b"], {"hips": "DEF-b"}))
    assert found is None or not found.turning


def test_the_body_of_a_rig_hangs_together_past_its_mechanism() -> None:
    tree = {
        "root": None,
        "ORG-spine": "root",
        "MCH-legs": "ORG-spine",
        "DEF-spine": "root",
        "DEF-thigh.L": "MCH-legs",
        "DEF-shin.L": "DEF-thigh.L",
        "chest_control": "root",
        "DEF-chest": "root",
        "DEF-arm.L": "chest_control",
    }
    names = tuple(tree)
    count = len(names)
    whole = Skeleton(
        names,
        np.array([-1 if above is None else names.index(above) for above in tree.values()]),
        np.random.default_rng(3).normal(size=(count, 3)),
        quat.identity(count),
        np.zeros((count, 3)),
    )
    deform = {name for name in names if name.startswith("DEF-")}
    body, rows = deform_tree.within(whole, deform, {"DEF-chest": ["chest_control"]}, {})
    assert set(body.names) == deform
    above = {name: body.names[p] if p >= 0 else None for name, p in zip(body.names, body.parents, strict=True)}
    assert above == {
        "DEF-spine": None,
        "DEF-thigh.L": "DEF-spine",
        "DEF-shin.L": "DEF-thigh.L",
        "DEF-chest": None,
        "DEF-arm.L": "DEF-chest",
    }
    assert [names[row] for row in rows] == list(body.names)
    assert np.array_equal(body.rest_positions, whole.rest_positions[rows])


def test_what_hangs_where_a_bone_starts_that_points_elsewhere_hangs_on_what_turns_it() -> None:
    tree = {
        "hips_fk": None,
        "start_tweak": "hips_fk",
        "middle_tweak": "hips_fk",
        "ORG-loin": "middle_tweak",
        "loin_fk": None,
        "end_tweak": "loin_fk",
        "DEF-hips": None,
        "DEF-loin": None,
        "DEF-thigh.L": "ORG-loin",
        "DEF-rib.L": "loin_fk",
    }
    names, count = tuple(tree), len(tree)
    parents = np.array([-1 if above is None else names.index(above) for above in tree.values()])
    whole = Skeleton(names, parents, np.zeros((count, 3)), quat.identity(count), np.zeros((count, 3)))
    copies = {"DEF-hips": ["start_tweak"], "DEF-loin": ["middle_tweak"]}
    aims = {"DEF-hips": ["middle_tweak"], "DEF-loin": ["end_tweak"]}
    body, _ = deform_tree.within(whole, {name for name in names if name.startswith("DEF-")}, copies, aims)
    above = {name: body.names[p] if p >= 0 else None for name, p in zip(body.names, body.parents, strict=True)}
    assert above["DEF-thigh.L"] == "DEF-hips"
    assert above["DEF-rib.L"] == "DEF-loin"


def test_rigs_whose_bones_copy_others_are_controlled() -> None:
    deform = [f"DEF-{i}" for i in range(12)]
    assert deform_tree.is_controlled(deform, {name: ["x"] for name in deform[:6]})
    assert not deform_tree.is_controlled(deform, {name: ["x"] for name in deform[:2]})
    assert not deform_tree.is_controlled(deform[:4], {name: ["x"] for name in deform[:4]})


# --- limbs by what inverse kinematics aims at ---

ARM = Limb("arm", "DEF-a", "DEF-b", "DEF-c")
"""An arm whose names tell nothing."""


def arm(*, switch: tuple[str, str] | None = ("Dial", "Mode"), last: str = "M") -> list[BoneFacts]:
    """Return an arm whose deform bones follow controls that turn it (T) and a mechanism that reaches (M).

    Args:
        switch: Drives the second of these two.
        last: Which of them comes second.
    """
    first = "T" if last == "M" else "M"
    drawn = [bone("Root"), bone("Hips", "Root"), bone("DEF-h", None, copying("Hips")), bone("Dial", props=("Mode",))]
    for part, above in (("a", "Hips"), ("b", None), ("c", None)):
        counts = (0.0, 1.0) if switch else (1.0, 1.0)
        drawn += [
            bone(f"T {part}", above or f"T {chr(ord(part) - 1)}"),
            bone(
                f"DEF-{part}", None, copying(f"{first} {part}"), copying(f"{last} {part}", switch=switch, counts=counts)
            ),
        ]
    aim = Follows("IK", ("M c",), pole="Elbow Twin")
    mechanism = [bone("M a", "Hips"), bone("M b", "M a", aim), bone("M c", "Roll")]
    held = [
        bone("Roll", "Grab"),
        bone("Grab", "Root"),
        bone("Elbow", "Root"),
        BoneFacts("Elbow Twin", "Elbow", False, False),
    ]
    return [*drawn, *[replace(one, shaped=False) for one in mechanism], *held]


def reached(facts: list[BoneFacts]) -> controls.Controls | None:
    return controls.read(facts, Wanted(["DEF-h", "DEF-a", "DEF-b", "DEF-c"], {"hips": "DEF-h"}, [ARM]))


def test_what_inverse_kinematics_aims_at_leads_to_the_outermost_control_that_carries_nothing_else() -> None:
    found = reached(arm())
    assert found is not None
    (limb,) = found.limbs
    assert (limb.control, limb.pole) == ("Grab", "Elbow")
    assert [(s.bone, s.prop, s.value) for s in limb.turned] == [("Dial", "Mode", 0.0)]
    assert [(s.bone, s.prop, s.value) for s in limb.reached] == [("Dial", "Mode", 1.0)]


def test_a_limb_without_a_switch_reaches_always_when_that_is_what_it_follows_last() -> None:
    found = reached(arm(switch=None))
    assert found is not None
    assert [(limb.control, limb.turned, limb.reached) for limb in found.limbs] == [("Grab", (), ())]
    other = reached(arm(switch=None, last="T"))
    assert other is not None
    assert not other.limbs


def test_what_the_user_says_of_a_limb_counts_and_must_exist() -> None:
    facts = [replace(one, follows=()) if one.name == "M b" else one for one in arm(switch=None)]
    wanted = Wanted(["DEF-h", "DEF-a", "DEF-b", "DEF-c"], {"hips": "DEF-h"}, [ARM])

    def said(reach: Reaching) -> controls.LimbControls:
        found = controls.read(facts, replace(wanted, reaches={"DEF-c": reach}))
        assert found is not None
        return found.limbs[0]

    limb = said(Reaching("Grab", "Elbow", 'Dial["Mode"] = 0'))
    assert (limb.control, limb.pole) == ("Grab", "Elbow")
    assert [(s.bone, s.prop, s.value) for s in (*limb.turned, *limb.reached)] == [
        ("Dial", "Mode", 1.0),
        ("Dial", "Mode", 0.0),
    ]
    for bad, message in (
        (Reaching(pole="Elbow"), "name its IK control too"),
        (Reaching("Nobody"), "moved by 'Nobody', which the armature does not have"),
        (Reaching("Grab", switch='Dial["None"]'), "which the armature does not have"),
    ):
        with pytest.raises(MappingError, match=message):
            said(bad)


def test_a_limb_whose_end_does_not_turn_with_what_it_aims_at_is_turned() -> None:
    facts = [replace(one, follows=()) if one.name == "DEF-c" else one for one in arm()]
    found = reached(facts)
    assert found is not None
    assert not found.limbs
