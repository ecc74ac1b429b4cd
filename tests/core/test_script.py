"""Scripts: commands as lines and as TOML."""

import random
from dataclasses import replace

import pytest

from morph_retarget.core.clips.commands import line, script
from morph_retarget.core.clips.commands.command import Command, Verb
from morph_retarget.core.clips.commands.script import Script
from morph_retarget.core.errors import FileError, MorphError

VALUES = [
    1.5,
    -3.0,
    True,
    False,
    "happy",
    "5",
    "yes",
    "1,2",
    "a b",
    "x'y",
    'say "hi"',
    (0.5, -2.0),
    (1.0, 2.0, 3.0),
    "ü",
    "",
]
SOUND = """
frame_rate = 30
library = "mine.npz"
[targets]
ball = [0.5, -2.0, 1.0]
cup = "Cup"

[[command]]
at = "15f"
start = "wave"
side = "left"

[[command]]
at = 0
start = "walk"
speed = 1.2
to = [1, 2]

[[command]]
do = "4.0 stop walk"
"""


def test_a_script_is_read_in_the_order_of_its_times() -> None:
    found = script.read(SOUND, "dance.toml")
    assert [str(command) for command in found.commands] == [
        "start walk speed 1.2 to (1.0, 2.0)",
        "start wave side left",
        "stop walk",
    ]
    assert [command.time for command in found.commands] == [0.0, 0.5, 4.0]
    assert [command.origin for command in found.commands] == [
        "dance.toml, line 13",
        "dance.toml, line 8",
        "dance.toml, line 19",
    ]
    assert found.targets == {"ball": (0.5, -2.0, 1.0), "cup": "Cup"}
    assert (found.library, found.warnings) == ("mine.npz", ())


@pytest.mark.parametrize("value", VALUES)
def test_a_value_written_on_a_line_is_read_again(value: object) -> None:
    written = line.written(Verb.START, "pick up", {"it": value})  # type: ignore[dict-item]
    assert line.parse(written) == (Verb.START, "pick up", {"it": value})


def test_a_script_that_was_written_is_read_again() -> None:
    rng = random.Random(3)
    commands = [
        Command(
            round(i * 0.37, 3),
            rng.choice(list(Verb)),
            rng.choice(["walk", "pick up"]),
            {"a": rng.choice(VALUES), "b c": rng.choice(VALUES)},
        )
        for i in range(60)
    ]
    before = Script(tuple(commands), {"ball": (1.0, 2.0, 3.0), "a cup": "Cup.001"}, "lib rary.npz")
    after = script.read(script.written(before), "again.toml")
    assert [(c.time, c.verb, c.model, dict(c.parameters)) for c in after.commands] == [
        (c.time, c.verb, c.model, dict(c.parameters)) for c in before.commands
    ]
    assert (after.targets, after.library, after.warnings) == (before.targets, before.library, ())


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[command]]\nstart = 'walk'", "line 1: it has no time"),
        ("[[command]]\nat = 'soon'\nstart = 'walk'", "at is 'soon'"),
        ("\n\n[[command]]\nat = 1", "line 3: it needs one of start, stop, reset"),
        ("[[command]]\nat = 1\nstart = 3", "start is 3"),
        ("[[command]]\nat = 1\nstart = 'walk'\nspeed = [1, 'a']", "speed is [1, 'a']"),
        ("[[command]]\ndo = '1 begin walk'", "'begin walk' is no command"),
        ("[[command]]\ndo = '1 start walk speed'", "'speed' is no parameter"),
        ("[[command]]\ndo = '1 start walk'\nat = 2", "'do' says all in one line"),
        ("[targets]\nball = 3", "target 'ball' is 3"),
        ("speed = 3", "there is no 'speed' in a script"),
        ('text = """\n[[command]]\n"""\n[[command]]\nat = 1', "line 4: it needs one of"),
    ],
)
def test_what_is_wrong_is_told_with_its_line_and_the_rest_plays(text: str, said: str) -> None:
    found = script.read(f"{text}\n[[command]]\ndo = '9 stop idle'", "a.toml")
    assert any(said in warning for warning in found.warnings), found.warnings
    assert [str(command) for command in found.commands] == ["stop idle"]


@pytest.mark.parametrize(
    "text", ["[[command", "command = 3", "targets = 3", "frame_rate = 0", "library = 3", "a = " + "9" * 5000]
)
def test_a_file_that_is_no_script_is_refused(text: str) -> None:
    with pytest.raises(FileError, match=r"a\.toml"):
        script.read(text, "a.toml")


def test_spoilt_scripts_are_refused_or_read_and_nothing_else() -> None:
    rng = random.Random(11)
    for _ in range(1500):
        letters = list(SOUND)
        for _ in range(rng.randint(1, 6)):
            place = rng.randrange(len(letters))
            letters[place] = rng.choice(["", "\n", '"', "[", "]", "=", "1e999", "nan", "é", "\x00", ",", "'", "{", "-"])
        try:
            found = script.read("".join(letters), "spoilt.toml")
        except MorphError:
            continue
        again = script.read(script.written(found), "again.toml")
        ours, theirs = ([replace(command, origin="") for command in own.commands] for own in (again, found))
        assert ours == theirs
