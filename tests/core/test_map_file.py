"""Joint maps as files."""

import json

import pytest

from morph_retarget.core.character import map_file
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.control_given import Reaching, switch_of
from morph_retarget.core.errors import MappingError
from tests.skeletons import skeleton_of
from tools.figure import Bone, humanoid


def _described() -> dict[str, object]:
    bones = [*humanoid(), Bone('a "strange" one', "hips", (0, 0.3, 1.0), (0, 0.3, 1.1))]
    return map_file.describe("Figure", analyze(skeleton_of(bones)))


def test_the_description_has_the_documented_keys() -> None:
    out = _described()
    assert list(out) == ["rig", "bones", "frame", "joints", "capabilities", "unmapped"]
    assert out["rig"] == "Figure"
    assert out["frame"]["up"] == [0.0, 0.0, 1.0]
    assert out["frame"]["forward"] == [0.0, -1.0, 0.0]
    assert set(out["joints"]["leftHand"]) == {"bone", "confidence", "by"}
    assert out["capabilities"]["rightFoot"] == ["foot", "limb"]
    assert out["unmapped"] == ['a "strange" one']


def test_a_description_is_a_map() -> None:
    out = _described()
    assert map_file.parse(json.dumps(out), "map.json") == {j: m["bone"] for j, m in out["joints"].items()}


def test_presets_and_plain_tables_are_maps() -> None:
    joints = {"hips": "Becken", "head": ""}
    assert map_file.parse(map_file.preset(joints), "preset") == joints
    assert map_file.parse(json.dumps(joints), "plain") == joints
    assert map_file.parse('{"jaw": null}', "plain") == {"jaw": ""}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "m.json: line 1 is no JSON"),
        ("[1, 2]", "m.json: is no joint map: it should look like"),
        ('{"joints": 3}', "m.json: is no joint map"),
        ('{"leftHoof": "x"}', "m.json: unknown joint 'leftHoof': use VRM 1.0 names such as hips, spine"),
        ('{"hips": 7}', "m.json: joint hips is mapped to 7: give the name of a bone"),
        ('{"hips": ["__import__"]}', "joint hips is mapped to"),
    ],
)
def test_what_is_no_map_is_refused(text: str, message: str) -> None:
    with pytest.raises(MappingError, match=message):
        map_file.parse(text, "m.json")


def test_controls_come_through_a_preset_and_say_nothing_of_bones() -> None:
    joints, named = {"hips": "DEF-spine", "head": "DEF-head"}, {"hips": "torso"}
    text = map_file.preset(joints, named)
    assert map_file.parse(text, "preset") == joints
    assert map_file.parse_controls(text, "preset") == named
    alone = '{"joints": {"hips": {"control": "torso"}}}'
    assert map_file.parse(alone, "m.json") == {}
    assert map_file.parse_controls(alone, "m.json") == named
    with pytest.raises(MappingError, match=r"m.json: joint hips has the control 3"):
        map_file.parse_controls('{"hips": {"control": 3}}', "m.json")


def test_maps_say_how_hands_and_feet_are_brought_to_places() -> None:
    reaches = {"leftHand": Reaching("IK Hand", "Elbow", 'Dials["Arm L"] = 0'), "leftFoot": Reaching(pole="Knee")}
    text = map_file.preset({"hips": "H", "leftHand": "L", "leftFoot": "F"}, {"leftHand": "FK Hand"}, reaches)
    assert map_file.parse(text, "preset") == {"hips": "H", "leftHand": "L", "leftFoot": "F"}
    assert map_file.parse_controls(text, "preset") == {"leftHand": "FK Hand"}
    assert map_file.parse_reaches(text, "preset") == reaches
    assert map_file.parse('{"leftHand": {"pole": "Elbow"}}', "m.json") == {}
    for bad, message in (
        ('{"hips": {"reach": "H"}}', "joint hips has a reach, which only leftHand"),
        ('{"leftHand": {"pole": 3}}', "joint leftHand has the pole 3"),
        ('{"leftHand": {"switch": "Arm"}}', "the switch of leftHand is 'Arm': name a bone and its property"),
    ):
        with pytest.raises(MappingError, match=message):
            map_file.parse_reaches(bad, "m.json")


@pytest.mark.parametrize(
    ("text", "switch"),
    [
        ('Dials["Arm L"]', ("Dials", "Arm L", 1.0)),
        ("Dials['Arm L'] = 0", ("Dials", "Arm L", 0.0)),
        ('pose.bones["Dials [1]"]["Arm \\"L"] = 0.5', ("Dials [1]", 'Arm "L', 0.5)),
    ],
)
def test_switches_are_named_by_their_data_paths(text: str, switch: tuple[str, str, float]) -> None:
    assert switch_of(text, "leftHand") == switch
