"""Faces as behaviours: values that come and go by their names."""

import numpy as np

from morph_retarget.core.clips.behaviours import faces
from morph_retarget.core.clips.behaviours.behaviour import Scene
from morph_retarget.core.clips.commands.command import Command, Value, Verb

SCENE = Scene(np.arange(150) / 30.0)


def _say(time: float, verb: Verb, **parameters: Value) -> Command:
    return Command(time, verb, "face", parameters)


def test_what_is_shown_comes_and_goes_softly_and_others_stay() -> None:
    found, warnings = faces.weights(
        SCENE,
        [
            _say(0.5, Verb.START, key="Smile", amount=0.8),
            _say(1.0, Verb.START, key="Blink"),
            _say(2.0, Verb.STOP, key="Blink", fade=0.1),
            _say(4.0, Verb.STOP),
        ],
    )
    assert not warnings
    assert set(found) == {"Smile", "Blink"}
    at = lambda name, time: float(np.interp(time, SCENE.times, found[name]))  # noqa: E731
    assert [at("Smile", t) for t in (0.4, 1.5, 3.9, 4.9)] == [0.0, 0.8, 0.8, 0.0]
    assert [at("Blink", t) for t in (0.9, 1.5, 2.5)] == [0.0, 1.0, 0.0]
    assert max(np.abs(np.diff(curve)).max() for curve in found.values()) < 0.75


def test_a_face_without_a_name_is_told_and_a_reset_takes_no_time() -> None:
    found, warnings = faces.weights(
        SCENE, [_say(0.1, Verb.START), _say(0.5, Verb.START, key="Smile"), _say(2.0, Verb.RESET)]
    )
    assert len(warnings) == 1
    assert "it has no key" in warnings[0]
    assert found["Smile"][SCENE.times > 2.0].max() == 0.0
    assert found["Smile"][SCENE.times < 1.999].max() == 1.0
