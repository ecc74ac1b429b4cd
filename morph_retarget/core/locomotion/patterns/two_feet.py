"""Manners of one and of two feet: standing and hopping, walking, running and skipping.

Humans and birds change from walk to run near u = 0.7, where u² is 1/2 (Kram, Domingo & Ferris 1997): our walks end
there, u = 0.2 to 0.7 being 0.6 to 2 m/s for a person, and runs begin at 0.9. A foot stands for about 60 % of the cycle
of a walk, 40 to 30 % of that of a run and near 20 % of a sprint's (Novacheck 1998); strides are about as long as
Alexander 1976 found for animals of all sizes, 2.3 u^0.6 hip heights. A walking body is highest over the foot that
carries it, a running one between its steps (Cavagna, Heglund & Taylor 1977). The hips turn and drop by about 5° to
either side in a walk (Saunders, Inman & Eberhart 1953). All else, and what lies between, is our choice by eye.
"""

from .manner import Manner

_HALVES = (0.0, 0.5)
_SKIP = (0.0, 0.3)

WALK = (
    Manner(0.0, 0.74, _HALVES, 0.55, lift=0.03, bob=0.002, bob_phase=0.37, sway=0.35, yaw=0.2, roll=0.05, crouch=0.005,
           swing=0.1, toe_off=0.3, heel_strike=0.1),
    Manner(0.2, 0.68, _HALVES, 0.95, lift=0.04, bob=0.008, bob_phase=0.34, sway=0.35, yaw=0.25, roll=0.07, crouch=0.01,
           swing=0.3, toe_off=0.65, heel_strike=0.25),
    Manner(0.45, 0.62, _HALVES, 1.55, lift=0.05, bob=0.02, bob_phase=0.31, sway=0.25, yaw=0.25, roll=0.09, lean=0.03,
           crouch=0.02, swing=0.5, toe_off=0.95, heel_strike=0.35),
    Manner(0.7, 0.57, _HALVES, 1.95, lift=0.06, bob=0.028, bob_phase=0.29, sway=0.2, yaw=0.28, roll=0.1, lean=0.06,
           crouch=0.03, swing=0.65, toe_off=1.05, heel_strike=0.4),
)  # fmt: skip

_RUNS = (
    Manner(0.9, 0.39, _HALVES, 2.15, lift=0.12, bob=0.04, bob_phase=0.445, sway=0.12, yaw=0.2, roll=0.09, lean=0.1,
           crouch=0.05, swing=0.6, toe_off=1.05, heel_strike=0.2),
    Manner(1.2, 0.33, _HALVES, 2.75, lift=0.18, bob=0.045, bob_phase=0.415, sway=0.1, yaw=0.2, roll=0.09, lean=0.12,
           crouch=0.055, swing=0.75, toe_off=1.1, heel_strike=0.15),
    Manner(1.7, 0.27, _HALVES, 3.5, lift=0.25, bob=0.04, bob_phase=0.385, sway=0.08, yaw=0.2, roll=0.09, lean=0.15,
           crouch=0.06, swing=0.9, toe_off=1.1, heel_strike=0.1),
    Manner(3.0, 0.21, _HALVES, 4.5, lift=0.33, bob=0.035, bob_phase=0.355, sway=0.05, yaw=0.2, roll=0.08, lean=0.2,
           crouch=0.06, swing=1.1, toe_off=1.1),
    Manner(4.0, 0.18, _HALVES, 4.9, lift=0.36, bob=0.03, bob_phase=0.34, sway=0.05, yaw=0.2, roll=0.08, lean=0.24,
           crouch=0.06, swing=1.2, toe_off=1.1),
)  # fmt: skip

RUN = (
    Manner(0.0, 0.48, _HALVES, 0.6, lift=0.05, bob=0.015, bob_phase=0.49, sway=0.15, yaw=0.15, roll=0.06, lean=0.02,
           crouch=0.04, swing=0.3, toe_off=0.5),
    Manner(0.5, 0.43, _HALVES, 1.4, lift=0.08, bob=0.03, bob_phase=0.465, sway=0.15, yaw=0.2, roll=0.08, lean=0.06,
           crouch=0.045, swing=0.5, toe_off=0.85, heel_strike=0.15),
    *_RUNS,
)  # fmt: skip

AUTO = (*WALK, *_RUNS)

SKIP = (
    Manner(0.0, 0.56, _SKIP, 0.6, lift=0.05, bob=0.015, bob_beats=1, bob_phase=0.93, sway=0.1, yaw=0.1, roll=0.05,
           crouch=0.03, swing=0.3, toe_off=0.5),
    Manner(0.5, 0.47, _SKIP, 1.4, lift=0.1, bob=0.035, bob_beats=1, bob_phase=0.885, sway=0.1, yaw=0.1, roll=0.06,
           lean=0.04, crouch=0.04, swing=0.6, toe_off=0.9, heel_strike=0.1),
    Manner(1.0, 0.4, _SKIP, 2.4, lift=0.15, bob=0.055, bob_beats=1, bob_phase=0.85, sway=0.1, yaw=0.1, roll=0.06,
           lean=0.08, crouch=0.05, swing=0.8, toe_off=1.0, heel_strike=0.1),
    Manner(2.0, 0.3, _SKIP, 3.5, lift=0.2, bob=0.05, bob_beats=1, bob_phase=0.8, sway=0.05, yaw=0.1, roll=0.06,
           lean=0.15, crouch=0.06, swing=1.0, toe_off=1.1),
)  # fmt: skip
"""The same foot always trails: it lands first, then the leading one, then the body flies (Minetti 1998; Andrada et al.
2016, "unilateral skipping"). By how much the one is behind the other is our choice."""

HOP = (
    Manner(0.0, 0.72, (0.0,), 0.35, lift=0.04, bob=0.015, bob_beats=1, bob_phase=0.86, crouch=0.04, toe_off=0.4),
    Manner(0.3, 0.62, (0.0,), 0.8, lift=0.08, bob=0.035, bob_beats=1, bob_phase=0.81, lean=0.03, crouch=0.05,
           toe_off=0.7),
    Manner(0.7, 0.52, (0.0,), 1.45, lift=0.12, bob=0.055, bob_beats=1, bob_phase=0.76, lean=0.06, crouch=0.06,
           toe_off=0.9),
    Manner(1.2, 0.42, (0.0,), 2.2, lift=0.15, bob=0.065, bob_beats=1, bob_phase=0.71, lean=0.1, crouch=0.07,
           toe_off=1.0),
    Manner(2.2, 0.32, (0.0,), 3.3, lift=0.18, bob=0.06, bob_beats=1, bob_phase=0.66, lean=0.14, crouch=0.07,
           toe_off=1.0),
    Manner(4.0, 0.23, (0.0,), 4.8, lift=0.2, bob=0.05, bob_beats=1, bob_phase=0.615, lean=0.18, crouch=0.07,
           toe_off=1.0),
)  # fmt: skip
