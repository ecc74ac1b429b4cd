"""Manners of four feet: walk, trot, pace, canter, gallop and bound.

Feet stand in the order left hind, right hind, left fore, right fore. In gaits whose left and right feet are half a
cycle apart, the fore foot follows the hind foot of its side by 1/4 of the cycle in a walk of even beats, by 1/2 in a
trot and by nothing in a pace; feet stand for more than half of the cycle in walks and for less in runs (Hildebrand
1965).

Strides are about 2.3 u^0.6 hip heights long (Alexander 1976), a little less in gallops: those of walks are below 2, of
trots between 2 and 2.9, of faster gaits above that, as in the data behind it. Horses change from walk to trot where u²
is about 0.35 (Griffin et al. 2004), others nearer to 1/2, and from trot to gallop where it is 2 to 3 (Alexander & Jayes
1983): here the one change goes on from u = 0.5 to 0.85, the other from 1.6 to 2.5 with a canter in between. Duty
factors between these marks are our choice, as is where in the cycle all phases begin: they are laid so that a faster
gait grows out of the slower one with little change.
"""

from .manner import Manner

_WALK = (0.0, 0.5, 0.25, 0.75)
_TROT = (0.875, 0.375, 0.375, 0.875)
_AMBLE = (0.0, 0.5, 0.15, 0.65)
"""Between walk and pace: slow paces have four beats."""
_PACE = (0.0, 0.5, 0.02, 0.52)
_CANTER = (0.11, 0.39, 0.39, 0.64)
"""The trailing hind foot, the leading one with the fore foot across from it, the leading fore foot."""
_GALLOP = (0.11, 0.27, 0.53, 0.68)
"""Left before right behind and in front: the transverse gallop of horses. Dogs and cheetahs at speed have the rotary
one, left before right behind and right before left in front (Bertram & Gutmann 2009; Biancardi & Minetti 2012)."""
_BOUND = (0.0, 0.0, 0.45, 0.45)

_WALKS = (
    Manner(0.0, 0.78, _WALK, 0.6, lift=0.05, bob=0.002, bob_phase=0.14, sway=0.2, yaw=0.15, roll=0.03, crouch=0.005,
           toe_off=0.2),
    Manner(0.25, 0.7, _WALK, 1.0, lift=0.07, bob=0.006, bob_phase=0.1, sway=0.2, yaw=0.2, roll=0.05, crouch=0.02,
           swing=0.25, toe_off=0.3),
    Manner(0.5, 0.63, _WALK, 1.5, lift=0.08, bob=0.01, bob_phase=0.06, sway=0.15, yaw=0.2, roll=0.05, lean=0.01,
           crouch=0.03, swing=0.3, toe_off=0.35),
)  # fmt: skip
_FAST_WALK = Manner(0.8, 0.57, _WALK, 1.95, lift=0.09, bob=0.012, bob_phase=0.04, sway=0.12, yaw=0.2, roll=0.05,
                    lean=0.02, crouch=0.04, swing=0.35, toe_off=0.35)  # fmt: skip
_TROTS = (
    Manner(0.85, 0.47, _TROT, 2.1, lift=0.12, bob=0.018, bob_phase=0.36, sway=0.03, yaw=0.12, roll=0.03, lean=0.02,
           crouch=0.04, swing=0.35, toe_off=0.35),
    Manner(1.2, 0.42, _TROT, 2.55, lift=0.14, bob=0.024, bob_phase=0.335, sway=0.03, yaw=0.12, roll=0.03, lean=0.02,
           crouch=0.05, swing=0.4, toe_off=0.35),
    Manner(1.6, 0.37, _TROT, 2.9, lift=0.15, bob=0.026, bob_phase=0.31, sway=0.02, yaw=0.12, roll=0.03, lean=0.02,
           crouch=0.055, swing=0.4, toe_off=0.35),
)  # fmt: skip
_FAST_TROT = Manner(2.4, 0.31, _TROT, 3.45, lift=0.16, bob=0.026, bob_phase=0.28, sway=0.02, yaw=0.12, roll=0.03,
                    lean=0.03, crouch=0.06, swing=0.4, toe_off=0.35)  # fmt: skip
_CANTERS = (
    Manner(2.0, 0.33, _CANTER, 3.2, lift=0.15, bob=0.03, bob_beats=1, bob_phase=0.04, sway=0.02, yaw=0.08, roll=0.03,
           pitch=0.07, lean=0.01, crouch=0.06, swing=0.4, toe_off=0.4),
)  # fmt: skip
_GALLOPS = (
    Manner(2.5, 0.27, _GALLOP, 3.65, lift=0.16, bob=0.035, bob_beats=1, bob_phase=0.03, yaw=0.06, roll=0.03,
           pitch=0.12, crouch=0.065, swing=0.4, toe_off=0.4),
    Manner(3.2, 0.22, _GALLOP, 4.3, lift=0.18, bob=0.035, bob_beats=1, bob_phase=0.005, yaw=0.06, roll=0.02,
           pitch=0.16, crouch=0.07, swing=0.4, toe_off=0.4),
    Manner(4.0, 0.19, _GALLOP, 4.9, lift=0.18, bob=0.035, bob_beats=1, bob_phase=0.99, yaw=0.06, roll=0.02,
           pitch=0.18, crouch=0.075, swing=0.4, toe_off=0.4),
)  # fmt: skip

WALK = (*_WALKS, _FAST_WALK)

TROT = (
    Manner(0.0, 0.56, _TROT, 0.6, lift=0.06, bob=0.006, bob_phase=0.405, sway=0.05, yaw=0.12, roll=0.03, crouch=0.01,
           toe_off=0.25),
    Manner(0.45, 0.52, _TROT, 1.35, lift=0.1, bob=0.012, bob_phase=0.385, sway=0.05, yaw=0.12, roll=0.03, lean=0.01,
           crouch=0.015, swing=0.3, toe_off=0.3),
    *_TROTS,
    _FAST_TROT,
)  # fmt: skip

PACE = (
    Manner(0.0, 0.74, _AMBLE, 0.6, lift=0.06, bob=0.004, bob_phase=0.12, sway=0.3, yaw=0.1, roll=0.05, toe_off=0.2),
    Manner(0.5, 0.6, _AMBLE, 1.5, lift=0.08, bob=0.01, bob_phase=0.05, sway=0.25, yaw=0.1, roll=0.06, lean=0.01,
           crouch=0.01, swing=0.3, toe_off=0.3),
    Manner(1.0, 0.47, _PACE, 2.3, lift=0.12, bob=0.02, bob_phase=0.485, sway=0.2, yaw=0.06, roll=0.08, lean=0.02,
           crouch=0.02, swing=0.35, toe_off=0.35),
    Manner(2.4, 0.33, _PACE, 3.4, lift=0.15, bob=0.025, bob_phase=0.42, sway=0.15, yaw=0.06, roll=0.08, lean=0.03,
           crouch=0.03, swing=0.4, toe_off=0.35),
)  # fmt: skip

CANTER = (
    Manner(0.0, 0.56, _CANTER, 0.7, lift=0.07, bob=0.01, bob_beats=1, bob_phase=0.155, sway=0.05, yaw=0.08, roll=0.03,
           pitch=0.03, crouch=0.01, toe_off=0.25),
    Manner(0.6, 0.47, _CANTER, 1.65, lift=0.11, bob=0.02, bob_beats=1, bob_phase=0.11, sway=0.03, yaw=0.08, roll=0.03,
           pitch=0.05, lean=0.01, crouch=0.02, swing=0.3, toe_off=0.3),
    Manner(1.2, 0.4, _CANTER, 2.5, lift=0.14, bob=0.028, bob_beats=1, bob_phase=0.075, sway=0.02, yaw=0.08, roll=0.03,
           pitch=0.06, lean=0.01, crouch=0.03, swing=0.4, toe_off=0.4),
    *_CANTERS,
    Manner(2.8, 0.27, _CANTER, 3.85, lift=0.16, bob=0.032, bob_beats=1, bob_phase=0.01, sway=0.02, yaw=0.08, roll=0.03,
           pitch=0.08, lean=0.01, crouch=0.05, swing=0.4, toe_off=0.4),
)  # fmt: skip

GALLOP = (
    Manner(0.0, 0.5, _GALLOP, 0.7, lift=0.08, bob=0.012, bob_beats=1, bob_phase=0.145, yaw=0.06, roll=0.03, pitch=0.04,
           crouch=0.02, toe_off=0.3),
    Manner(0.8, 0.41, _GALLOP, 1.95, lift=0.12, bob=0.025, bob_beats=1, bob_phase=0.1, yaw=0.06, roll=0.03, pitch=0.07,
           crouch=0.03, swing=0.3, toe_off=0.35),
    Manner(1.6, 0.33, _GALLOP, 2.8, lift=0.15, bob=0.032, bob_beats=1, bob_phase=0.06, yaw=0.06, roll=0.03,
           pitch=0.1, crouch=0.04, swing=0.4, toe_off=0.4),
    *_GALLOPS,
)  # fmt: skip

BOUND = (
    Manner(0.0, 0.5, _BOUND, 0.7, lift=0.08, bob=0.015, bob_beats=1, bob_phase=0.975, pitch=0.06, crouch=0.03,
           toe_off=0.3),
    Manner(0.8, 0.4, _BOUND, 2.0, lift=0.13, bob=0.035, bob_beats=1, bob_phase=0.925, pitch=0.12, crouch=0.05,
           swing=0.4, toe_off=0.4),
    Manner(1.6, 0.32, _BOUND, 2.8, lift=0.16, bob=0.045, bob_beats=1, bob_phase=0.885, pitch=0.18, crouch=0.06,
           swing=0.5, toe_off=0.4),
    Manner(2.8, 0.24, _BOUND, 3.95, lift=0.18, bob=0.05, bob_beats=1, bob_phase=0.845, pitch=0.22, crouch=0.07,
           swing=0.5, toe_off=0.4),
    Manner(4.0, 0.19, _BOUND, 4.9, lift=0.18, bob=0.05, bob_beats=1, bob_phase=0.82, pitch=0.24, crouch=0.08,
           swing=0.5, toe_off=0.4),
)  # fmt: skip
"""Both hind feet together, then both fore feet, as squirrels and weasels go."""

RUN = (
    Manner(0.0, 0.52, _TROT, 0.6, lift=0.07, bob=0.008, bob_phase=0.385, sway=0.03, yaw=0.12, roll=0.03, crouch=0.02,
           toe_off=0.25),
    *_TROTS,
    *_CANTERS,
    *_GALLOPS,
)  # fmt: skip

AUTO = (*_WALKS, *_TROTS, *_CANTERS, *_GALLOPS)
