"""BML: blocks of behaviours as commands."""

import random

import pytest

from morph_retarget.core.clips.commands import bml, bml_file
from morph_retarget.core.clips.commands.command import Command
from morph_retarget.core.errors import FileError, MorphError

SOUND = """<?xml version="1.0"?>
<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="bml1">
  <gaze id="look" start="1" end="4" target="Ball" influence="HEAD"/>
  <head id="yes" lexeme="NOD" start="look:ready+0.5" repetition="2" amount="0.3"/>
  <gesture id="beat" lexeme="BEAT" mode="LEFT_HAND" stroke="3"/>
  <pointing id="there" target="0.5 -2.0 1.0" mode="RIGHT_HAND" start="beat:end"/>
  <locomotion id="go" target="Door" manner="walk" start="there:end"/>
</bml>
"""


def _block(*lines: str, attributes: str = "") -> str:
    return "\n".join([f"<bml{attributes}>", *lines, "</bml>"])


def _times(text: str) -> dict[str, float]:
    return {str(command): round(command.time, 6) for command in bml.read(text, "a.bml").commands}


def _said(text: str) -> list[str]:
    return list(bml.read(text, "a.bml").warnings)


def test_a_block_is_read_as_commands_at_the_times_that_its_behaviours_tell_each_other() -> None:
    found = bml.read(SOUND, "a.bml")
    assert not found.warnings
    assert [(str(c), c.time, c.origin) for c in found.commands] == [
        ("start gaze target Ball level head", 1.0, "a.bml, line 3"),
        ("start nod repeats 2.0 amplitude 8.4", 1.9, "a.bml, line 4"),
        ("start beat side left stroke 0.7", 2.3, "a.bml, line 5"),
        ("stop gaze", pytest.approx(3.6), "a.bml, line 3"),
        ("start point place (0.5, -2.0, 1.0) side right", 3.8, "a.bml, line 6"),
        ("stop point", 5.4, "a.bml, line 6"),
        ("start go target Door manner walk", 6.0, "a.bml, line 7"),
    ]


def test_sync_points_between_those_that_are_told_lie_as_usual() -> None:
    usual = _times(_block('<gesture lexeme="wave" start="0" end="1.5"/>'))
    assert usual == {"start wave duration 1.5": 0.0}
    twice = bml.read(_block('<gesture id="a" lexeme="wave" end="3" start="0"/>', '<head start="a:stroke"/>'), "a.bml")
    assert [command.time for command in twice.commands] == [0.0, pytest.approx(0.7)]


def test_motions_take_as_long_as_is_known_of_them() -> None:
    found = bml.read(
        _block('<gesture lexeme="BOW" stroke="2"/>'), "a.bml", {"bow": (0.0, 0.1, 0.2, 1.0, 1.1, 1.2, 1.5)}
    )
    assert found.commands[0].time == pytest.approx(1.0)


def test_blocks_that_are_appended_begin_when_all_before_have_ended() -> None:
    first, second = _block('<head end="2"/>'), _block('<head start="1"/>', attributes=' composition="APPEND"')
    text = f"<act>{first}{second}</act>"
    assert [command.time for command in bml.read(text, "a.bml").commands] == [1.0, 3.0]


def test_a_block_that_replaces_takes_back_what_has_not_begun_before_it() -> None:
    first = _block('<head lexeme="SHAKE" start="0"/>')
    second = _block('<head start="1"/>', attributes=' composition="REPLACE"')
    assert [str(c) for c in bml.read(f"<a>{first}{second}</a>", "a.bml").commands] == ["start nod"]


def test_constraints_time_behaviours_too() -> None:
    same = ('<head id="a" start="2"/>', '<gesture id="b" lexeme="beat"/>')
    sync = '<constraint><synchronize ref="a:stroke"><sync ref="b:stroke+0.1"/></synchronize></constraint>'
    assert _times(_block(*same, sync))["start beat stroke 0.7"] == pytest.approx(2.5 - 0.1 - 0.7)
    after = '<required><constraint><after ref="a:end"><sync ref="b:start"/></after></constraint></required>'
    assert _times(_block(*same, after))["start beat"] == pytest.approx(3.0)


def test_faces_are_deforms_that_come_and_go_by_their_names() -> None:
    found = bml.read(
        _block('<faceFacs au="12" side="LEFT" amount="0.5" start="1" ready="1.25" relax="2" end="3"/>'), "a"
    )
    assert [(str(command), command.time) for command in found.commands] == [
        ("start face key AU12_L amount 0.5 fade 0.25", 1.0),
        ("stop face key AU12_L fade 1.0", 2.0),
    ]


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        (["<speech/>"], "line 2: <speech> is not supported"),
        (['<gaze target="Ball" offsetAngle="3"/>'], "line 2: 'offsetAngle' of <gaze> is not supported"),
        (["<gaze/>"], "line 2: <gaze> has no target"),
        (['<head lexeme="BOW"/>'], "line 2: lexeme is 'BOW': choose one of NOD, SHAKE, TILT"),
        (['<head amount="much"/>'], "amount is 'much', which is no number"),
        (['<head start="soon:"/>'], "start is 'soon:': give seconds"),
        (['<head start="b:end"/>'], "has no behaviour 'b' to wait for"),
        (['<head id="a" start="b:end"/>', '<head id="b" start="a:end"/>'], "waits for itself"),
        (['<head start="2" end="1"/>'], "are not in order"),
        (["<constraint><maybe/></constraint>"], "<maybe> is no constraint"),
        (["<gesture/>"], "<gesture> has no lexeme"),
    ],
)
def test_what_is_not_understood_is_told_with_its_line_and_the_rest_plays(lines: list[str], said: str) -> None:
    text = _block(*lines, '<pointing target="Ball" start="9"/>')
    assert any(said in warning for warning in _said(text)), _said(text)
    assert "start point target Ball" in _times(text)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<bml>",
        "<a/>",
        '<!DOCTYPE b [<!ENTITY a "b">]><bml>&a;</bml>',
        "<bml>" + "<a>" * 200 + "</a>" * 200 + "</bml>",
        "<bml>\udcff</bml>",
    ],
)
def test_a_file_that_is_no_bml_is_refused(text: str) -> None:
    with pytest.raises(FileError, match=r"a\.bml"):
        bml.read(text, "a.bml")


def test_spoilt_files_are_refused_or_read_and_nothing_else() -> None:
    rng = random.Random(5)
    for _ in range(1500):
        letters = list(SOUND)
        for _ in range(rng.randint(1, 5)):
            place = rng.randrange(len(letters))
            letters[place] = rng.choice(["", "<", ">", '"', "/", ":", "+", "1e999", "nan", "-", " ", "é", "\x00"])
        try:
            found = bml.read("".join(letters), "spoilt.bml")
        except MorphError:
            continue
        assert all(isinstance(command, Command) and abs(command.time) < 1e12 for command in found.commands)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("2.5", ("", "", 2.5)),
        ("a:end", ("a", "end", 0.0)),
        ("bml1:a:stroke - 0.5", ("a", "stroke", -0.5)),
        ("start+1", ("", "start", 1.0)),
    ],
)
def test_a_time_may_be_told_by_a_sync_point(text: str, told: tuple[str, str, float]) -> None:
    found = bml_file.reference(text)
    assert found is not None
    assert (found.behaviour, found.point, found.offset) == told
