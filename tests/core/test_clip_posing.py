"""Poses as frames of clips, and back."""

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.frame import Placement
from morph_retarget.core.clips import posing, spots
from morph_retarget.core.clips.character_model import CharacterModel
from morph_retarget.core.clips.travel import Travel
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.play import root_of
from tests.legged import crawler
from tests.skeletons import skeleton_of, wild

RNG = np.random.default_rng(5)


def _model() -> CharacterModel:
    turned = quat.to_matrix(quat.from_axis_angle([0.3, 0.9, 0.1] / np.linalg.norm([0.3, 0.9, 0.1]), 1.1))
    place = Placement(turned, 0.02, np.array([3.0, -2.0, 1.0]))
    bones = [
        bone.__class__(bone.name, bone.parent, *(tuple((np.array(p) @ turned) * 50.0) for p in (bone.head, bone.tail)))
        for bone in crawler(4)
    ]
    character = analyze(skeleton_of(bones, np.random.default_rng(2)), place)
    return CharacterModel(character, root_of(Bodies.of(character)))


def _way(count: int) -> Travel:
    return Travel(np.cumsum(RNG.normal(size=(count, 2)), axis=0), np.cumsum(RNG.normal(size=count)))


def test_frames_seen_from_a_travel_and_carried_along_it_again_are_the_poses_that_they_came_from() -> None:
    model = _model()
    pose, way = wild(model.character.skeleton, 12, RNG), _way(12)
    frames = posing.frames_of(model, pose, way, np.ones((12, 4)))
    back = posing.pose_of(model, frames, way)
    size = np.ptp(model.character.skeleton.rest_positions, axis=0).max()
    tree = model.character.skeleton.tree
    carried = [model.root, *tree.below(model.root)]  # what is above the root rests
    assert np.abs(back.positions - pose.positions)[:, carried].max() < 1e-9 * size
    assert quat.angle_between(back.rotations, pose.rotations)[:, carried].max() < 1e-6


def test_the_spot_of_a_standing_foot_stays_in_its_place_whatever_the_travel() -> None:
    model = _model()
    pose, way, contacts = wild(model.character.skeleton, 12, RNG), _way(12), np.zeros((12, 4))
    contacts[3:9, 1] = 1.0
    frames = posing.frames_of(model, pose, way, contacts)
    places = spots.in_world(frames.feet, way)
    assert np.ptp(places[3:9, 1, :2], axis=0).max() < 1e-9
    ankles = model.character.local_to_character.points(pose.positions[:, model.feet])
    assert np.abs(places - ankles)[..., 2].max() < 1e-9


def test_travel_there_and_back_is_none() -> None:
    way = _way(9)
    none = way.then(way.inverse())
    assert np.abs(none.places).max() < 1e-12
    assert np.abs(none.headings).max() < 1e-12


def test_steps_of_a_travel_sum_up_to_it() -> None:
    way = _way(9)
    again = way[:1].then(way.steps().summed())
    assert np.abs(again.places - way.places).max() < 1e-12
    assert np.abs(again.headings - way.headings).max() < 1e-12


def test_each_joint_is_in_one_part_of_the_body() -> None:
    parts = _model().parts
    single = [flags for name, flags in parts.items() if name not in {"legs", "arms", "upper", "lower", "all"}]
    assert (np.sum(single, axis=0) == 1).all()
