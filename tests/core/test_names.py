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
