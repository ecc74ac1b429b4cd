"""The damped Jacobian (Feng 2013 §4.2): rebuild the chain and measure where its end is."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.solve.jacobian_ik import NONE, Effector, JacobianSettings, Problem, solve

LEG = Problem(
    parents=(NONE, 0),
    offsets=np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -0.45]]),
    effectors=(Effector(1, np.array([0.0, 0.0, -0.43])),),
)
HIP = np.array([0.0, 0.0, 0.95])


def _bent(frames: int) -> np.ndarray:
    """Return a leg with a slightly bent knee, turn of each joint."""
    out = quat.identity(frames, 2)
    out[:, 0] = quat.from_rotation_vector(np.array([-0.15, 0.0, 0.0]))
    out[:, 1] = quat.from_rotation_vector(np.array([0.15, 0.0, 0.0]))
    return out


def _end(problem: Problem, turns: np.ndarray, anchor: np.ndarray, effector: int = 0) -> np.ndarray:
    """Return where an effector is, joint by joint from the top."""
    chain, joint = [], problem.effectors[effector].joint
    while joint != NONE:
        chain.insert(0, joint)
        joint = problem.parents[joint]
    place = anchor
    for above, below in pairwise(chain):
        place = place + quat.rotate(turns[:, above], problem.offsets[below])
    return place + quat.rotate(turns[:, chain[-1]], problem.effectors[effector].offset)


def _solve(targets: np.ndarray, settings: JacobianSettings | None = None) -> tuple[np.ndarray, np.ndarray]:
    frames = len(targets)
    turns = _bent(frames)
    anchors = np.broadcast_to(HIP, (frames, 2, 3)).copy()
    root = np.broadcast_to(HIP + np.array([0.0, 0.0, 0.05]), (frames, 3))
    out = solve(LEG, turns, anchors, targets[:, None], root, 1.75, settings)
    return out.turns, out.error


def test_a_foot_arrives_within_a_millimetre() -> None:
    rng = np.random.default_rng(1)
    directions = quat.unit(rng.normal(size=(300, 3)) * [0.4, 0.6, 0.2] + [0.0, -0.2, -1.0])
    targets = HIP + rng.uniform(0.3, 0.875, size=(300, 1)) * directions
    turns, error = _solve(targets)
    assert np.linalg.norm(_end(LEG, turns, HIP) - targets, axis=-1).max() < 1e-3
    assert error.max() < 1e-3


def test_a_pose_that_is_already_right_is_left_alone() -> None:
    turns = _bent(3)
    there = _end(LEG, turns, HIP)
    out, _ = _solve(there)
    assert quat.angle_between(out, turns).max() < 1e-9


def test_a_nearly_straight_leg_can_be_made_much_shorter() -> None:
    rng = np.random.default_rng(4)
    turns = _bent(40)
    there = _end(LEG, turns, HIP)
    shorter = HIP + (there - HIP) * rng.uniform(0.6, 0.8, size=(40, 1))
    out, error = _solve(shorter)
    assert np.linalg.norm(_end(LEG, out, HIP) - shorter, axis=-1).max() < 1e-3
    assert error.max() < 1e-3


def test_targets_out_of_reach_are_pulled_into_the_sphere_of_reach() -> None:
    targets = np.array([[0.0, -3.0, 0.0], [0.0, 0.0, -5.0]])
    turns, error = _solve(targets)
    ends = _end(LEG, turns, HIP)
    straight = np.linalg.norm(ends - HIP, axis=-1)
    assert (straight > 0.8).all()
    wanted = quat.unit(targets - HIP)
    assert (np.sum(quat.unit(ends - HIP) * wanted, axis=-1) > 0.99).all()
    assert (error < 0.1).all()


def test_frames_do_not_know_of_each_other() -> None:
    rng = np.random.default_rng(2)
    targets = HIP + np.array([0.0, -0.1, -0.7]) + 0.1 * rng.normal(size=(20, 3))
    together, _ = _solve(targets)
    alone = np.concatenate([_solve(targets[i : i + 1])[0] for i in range(20)])
    assert quat.angle_between(together, alone).max() < 1e-9


def test_two_effectors_on_a_shared_joint_both_arrive() -> None:
    trunk = Problem(
        parents=(NONE, 0, 1, 0, 3),
        offsets=np.array([[0, 0, 0], [0.2, 0, 0.4], [0.28, 0, 0], [-0.2, 0, 0.4], [-0.28, 0, 0]], dtype=float),
        effectors=(Effector(2, np.array([0.25, -0.05, 0])), Effector(4, np.array([-0.25, -0.05, 0]))),
    )
    rng = np.random.default_rng(3)
    frames = 50
    turns = quat.identity(frames, 5)
    for joint, sign in ((2, 1.0), (4, -1.0)):
        turns[:, joint] = quat.from_rotation_vector(np.array([0.0, 0.0, sign * -0.3]))
    anchors = np.zeros((frames, 5, 3))
    spread = np.array([[0.45, -0.25, 0.35], [-0.45, -0.25, 0.35]])
    targets = spread + 0.08 * rng.normal(size=(frames, 2, 3))
    out = solve(trunk, turns, anchors, targets, np.zeros((frames, 3)), 1.75)
    for effector in (0, 1):
        end = _end(trunk, out.turns, np.zeros(3), effector)
        assert np.linalg.norm(end - targets[:, effector], axis=-1).max() < 1e-3


def test_a_stiff_joint_leaves_the_work_to_the_others() -> None:
    stiff = replace(LEG, stiffness=np.array([0.0, 1.0]))
    turns = _bent(1)
    target = _end(LEG, turns, HIP) + np.array([0.0, 0.05, 0.03])
    out = solve(stiff, turns, np.broadcast_to(HIP, (1, 2, 3)), target[:, None], HIP[None], 1.75)
    assert quat.angle_between(out.turns[:, 0], turns[:, 0]).max() < 1e-9
    assert quat.angle_between(out.turns[:, 1], turns[:, 1]).max() > 0.01


@pytest.mark.parametrize("damping", [0.01, 0.05, 0.2])
def test_damping_changes_the_way_and_not_the_place(damping: float) -> None:
    targets = HIP + np.array([[0.1, -0.2, -0.6]])
    turns, _ = _solve(targets, JacobianSettings(damping=damping, iterations=60))
    assert np.linalg.norm(_end(LEG, turns, HIP) - targets) < 1e-3
