"""Reading bone names: conventions, languages, sides."""

import pytest

from morph_retarget.core.character.joint_names import joint_scores
from morph_retarget.core.character.names import read_names
from morph_retarget.core.character.words import Sense

_BODY = ("Hips", "Spine", "Neck", "Head", "LeftArm", "RightArm", "LeftUpLeg", "RightUpLeg")


def _best(name: str) -> str | None:
    """Return the unsided joint that a name speaks for most, read alone."""
    scores = {j: s for j, s in joint_scores(read_names([name])[0]).items() if j}
    return max(scores, key=scores.__getitem__) if scores else None


@pytest.mark.parametrize(
    ("name", "joint", "side"),
    [
        ("mixamorig:LeftForeArm", "LowerArm", 1),
        ("Bip01 R UpperArm", "UpperArm", -1),
        ("ValveBiped.Bip01_L_Calf", "LowerLeg", 1),
        ("DEF-upper_arm.R", "UpperArm", -1),
        ("CC_Base_L_Thigh", "UpperLeg", 1),
        ("J_Bip_R_LowerLeg", "LowerLeg", -1),
        ("clavicle_l", "Shoulder", 1),
        ("左ひじ", "LowerArm", 1),
        ("右足首", "Foot", -1),
        ("Linker Unterschenkel", "LowerLeg", 1),
        ("avant-bras_droit", "LowerArm", -1),
        ("rodilla.izquierda", "LowerLeg", 1),
        ("lfemur", "UpperLeg", 1),
        ("b_RightFoot_042", "Foot", -1),
        ("RToe", "Toes", -1),
        ("DEF-r_toe.L", "Toes", 1),
        ("DEF-r_toe.R", "Toes", -1),
    ],
)
def test_limbs_are_read_in_many_conventions(name: str, joint: str, side: int) -> None:
    assert _best(name) == joint
    assert read_names([name])[0].side == side


@pytest.mark.parametrize(
    ("name", "joint"), [("頭", "head"), ("Becken", "hips"), ("cou", "neck"), ("Ｓｐｉｎｅ", "spine"), ("шея", "neck")]
)
def test_the_trunk_is_read_in_many_languages(name: str, joint: str) -> None:
    assert _best(name) == joint


def test_a_prefix_that_all_bones_share_says_nothing() -> None:
    plain, prefixed = read_names(_BODY), read_names([f"Bip01 {name}" for name in _BODY])
    assert [r.senses for r in prefixed] == [r.senses for r in plain]


def test_a_running_number_says_nothing() -> None:
    readings = read_names([f"{name}_{i:03}" for i, name in enumerate(_BODY)])
    assert all(not r.numbers for r in readings)


def test_one_sided_letters_belong_to_some_other_code() -> None:
    assert {r.side for r in read_names([f"R_{name}" for name in ("Spine", "Neck", "Head", "Hip", "Knee")])} == {0}


@pytest.mark.parametrize("name", ["hair_01", "skirt.L", "hand_ik.R", "weapon_l", "MCH-thigh.L", "Breast_R"])
def test_things_are_no_joints(name: str) -> None:
    assert joint_scores(read_names([name])[0])[""] < -5.0


def test_twist_bones_are_known_as_such() -> None:
    reading = read_names(["LeftArmTwist1"])[0]
    assert reading.has(Sense.TWIST)
    assert reading.side == 1


@pytest.mark.parametrize("name", ["", "___", ":", '"', "🦴", "]", "123"])
def test_names_without_words_say_nothing(name: str) -> None:
    reading = read_names([name])[0]
    assert not reading.known
    assert joint_scores(reading)[""] == 0.0


_LIMBS = [f"{part}.{side}" for side in "LR" for part in ("Humerus", "Forearm", "Hand", "Femur", "Shin", "Foot")]


def test_words_for_controls_that_all_limbs_bear_say_nothing() -> None:
    plain = read_names(["Head", *_LIMBS, "Eye.L"])
    called = read_names(["Head", *(f"CTRL_FK_{name}" for name in _LIMBS), "Eye.L", "CTRL_Eye.L"])
    assert [r.senses for r in called[:-1]] == [r.senses for r in plain]
    assert joint_scores(called[-1])[""] < -5.0, "the other eye is a control"


def test_controls_beside_limbs_are_controls() -> None:
    called = read_names([*_LIMBS, *(f"CTRL_FK_{name}" for name in _LIMBS)])
    assert all(joint_scores(r)[""] < -5.0 for r in called[len(_LIMBS) :])


@pytest.mark.parametrize("codes", ["lf rf lr rr", "lf rf lh rh", "fl fr bl br", "FL FR RL RR"])
def test_codes_of_four_legs_are_read_as_side_and_row(codes: str) -> None:
    readings = read_names([f"{code}_leg_{part}" for code in codes.split() for part in ("upper", "lower", "foot")])
    front_left, front_right, rear_left, rear_right = readings[::3]
    assert [r.side for r in readings[::3]] == [1, -1, 1, -1]
    assert front_left.has(Sense.FRONT)
    assert front_right.has(Sense.FRONT)
    assert rear_left.has(Sense.REAR)
    assert rear_right.has(Sense.REAR)


def test_codes_of_legs_say_nothing_on_bodies_without_all_four() -> None:
    assert not read_names(["fl_leg", "bl_leg", "spine"])[0].has(Sense.FRONT)
