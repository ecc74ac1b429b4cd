"""Manners of three, five and six feet, and of any number in metachronal waves.

Insects: the faster they go the smaller their duty factor, down to 1/2 and less in running cockroaches (Ting, Blickhan &
Full 1994), while the lag between neighbours grows, from waves through fours to two tripods that take turns, without a
jump (Wilson 1966; Szczecinski et al. 2018); the fastest lift tripods before the others land (Full & Tu 1991). How long
feet stand in the slowest walks, and strides, are our choice. Odd numbers of feet have no model in nature but the slow
walk of kangaroos, whose tail is a fifth leg (O'Connor et al. 2014), and theirs is another; ours step in turn when slow,
and bound over the odd foot when fast.
"""

from collections.abc import Sequence

from .manner import Manner, lag, wave

_Row = tuple[float, float, float, float]


def _rows(
    rows: Sequence[_Row], triggers: Sequence[tuple[float, ...]], bob: float = 0.006, sway: float = 0.05
) -> tuple[Manner, ...]:
    """Return manners of bodies between sprawling legs, from rows of speed, duty factor, stride and lift."""
    return tuple(
        Manner(speed, duty, own, stride, lift=lift, bob=bob * min(speed, 1.0), sway=sway, yaw=0.05, roll=0.02)
        for (speed, duty, stride, lift), own in zip(rows, triggers, strict=True)
    )


_INSECT: tuple[_Row, ...] = (
    (0.0, 0.8, 0.4, 0.06), (0.12, 0.74, 0.65, 0.08), (0.3, 0.66, 1.05, 0.1), (0.6, 0.57, 1.5, 0.11),
    (1.0, 0.5, 1.95, 0.12), (2.0, 0.41, 2.6, 0.13), (4.0, 0.32, 3.3, 0.14),
)  # fmt: skip
_CROWD: tuple[_Row, ...] = (
    (0.0, 0.8, 0.4, 0.06), (0.3, 0.7, 1.0, 0.09), (0.8, 0.6, 1.65, 0.1), (1.5, 0.52, 2.1, 0.11), (4.0, 0.4, 2.7, 0.12),
)  # fmt: skip
_SLOW: tuple[_Row, ...] = (
    (0.0, 0.84, 0.4, 0.06), (0.3, 0.78, 0.9, 0.09), (0.8, 0.72, 1.35, 0.1), (2.0, 0.66, 1.65, 0.11),
)  # fmt: skip

SIX = _rows(_INSECT, [wave(6, 1.0 - max(duty, 0.5)) for _, duty, *_ in _INSECT])
TRIPOD = _rows(_INSECT, [wave(6, 0.5)] * len(_INSECT))
RIPPLE = _rows(_INSECT[:5], [wave(6, 1.0 / 3.0)] * 5)

_THIRDS = (0.0, 0.667, 0.333)
_THREE_BEATS = (0.0, 0.9, 0.45)
THREE = (
    Manner(0.0, 0.8, _THIRDS, 0.5, lift=0.05, bob=0.002, sway=0.2, yaw=0.15, roll=0.04, toe_off=0.2),
    Manner(0.3, 0.71, _THIRDS, 1.1, lift=0.08, bob=0.008, sway=0.15, yaw=0.15, roll=0.05, crouch=0.01, swing=0.3,
           toe_off=0.3),
    Manner(0.6, 0.63, _THIRDS, 1.65, lift=0.1, bob=0.012, sway=0.12, yaw=0.15, roll=0.05, lean=0.02, crouch=0.02,
           swing=0.35, toe_off=0.35),
    Manner(0.95, 0.45, _THREE_BEATS, 2.2, lift=0.13, bob=0.03, bob_beats=1, bob_phase=0.4, sway=0.03, yaw=0.08,
           roll=0.03, pitch=0.08, lean=0.02, crouch=0.04, swing=0.4, toe_off=0.4),
    Manner(2.0, 0.32, _THREE_BEATS, 3.4, lift=0.16, bob=0.035, bob_beats=1, bob_phase=0.335, yaw=0.06, roll=0.03,
           pitch=0.12, lean=0.03, crouch=0.05, swing=0.4, toe_off=0.4),
    Manner(4.0, 0.21, _THREE_BEATS, 5.0, lift=0.18, bob=0.035, bob_beats=1, bob_phase=0.28, yaw=0.06, roll=0.02,
           pitch=0.16, lean=0.04, crouch=0.06, swing=0.4, toe_off=0.4),
)  # fmt: skip

_FIFTHS = (0.0, 0.6, 0.2, 0.8, 0.4)
_CROSSED = (0.0, 0.5, 0.5, 0.0, 0.25)
FIVE = (
    Manner(0.0, 0.82, _FIFTHS, 0.45, lift=0.05, bob=0.002, sway=0.1, yaw=0.08, roll=0.02, toe_off=0.15),
    Manner(0.3, 0.72, _FIFTHS, 1.05, lift=0.08, bob=0.005, sway=0.1, yaw=0.08, roll=0.03, crouch=0.01, toe_off=0.2),
    Manner(0.6, 0.62, _FIFTHS, 1.6, lift=0.1, bob=0.008, sway=0.08, yaw=0.08, roll=0.03, crouch=0.02, toe_off=0.25),
    Manner(1.0, 0.48, _CROSSED, 2.2, lift=0.12, bob=0.016, bob_phase=0.49, sway=0.03, yaw=0.08, roll=0.03, lean=0.02,
           crouch=0.03, toe_off=0.3),
    Manner(2.0, 0.36, _CROSSED, 3.1, lift=0.14, bob=0.02, bob_phase=0.43, yaw=0.08, roll=0.02, lean=0.02,
           crouch=0.04, toe_off=0.3),
    Manner(4.0, 0.25, _CROSSED, 4.3, lift=0.15, bob=0.02, bob_phase=0.375, yaw=0.08, roll=0.02, lean=0.03,
           crouch=0.05, toe_off=0.3),
)  # fmt: skip


def crowd(feet: int) -> tuple[Manner, ...]:
    """Return generated manners of seven or more feet: waves that run forward along both sides (Hecker 2008 §4.2).

    Their speeds, duty factors and strides are our choice.
    """
    return _rows(_CROWD, [wave(feet, lag(feet, duty)) for _, duty, *_ in _CROWD], bob=0.003, sway=0.0)


def slow_wave(feet: int) -> tuple[Manner, ...]:
    """Return generated manners of any number of feet, of which as many as can be stay on the ground."""
    return _rows(_SLOW, [wave(feet, lag(feet, duty)) for _, duty, *_ in _SLOW], bob=0.004, sway=0.15)
