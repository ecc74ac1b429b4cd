"""Getting about without feet: poses are rebuilt by the pose step and measured."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array, Indices
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.errors import MotionError, RigError
from morph_retarget.core.ground import Ground
from morph_retarget.core.locomotion import course, getting_about
from morph_retarget.core.locomotion.course import Course
from morph_retarget.core.locomotion.footless import crawling, line
from morph_retarget.core.locomotion.footless.crawling import Movement
from morph_retarget.core.locomotion.footless.floating import Floating
from morph_retarget.core.locomotion.footless.hopping import HEIGHT, Hopping
from morph_retarget.core.locomotion.footless.inchworm import Inchworm
from morph_retarget.core.locomotion.footless.line import Line
from morph_retarget.core.locomotion.footless.serpentine import Serpentine
from morph_retarget.core.locomotion.moving import Moving
from morph_retarget.core.locomotion.settings import GaitSettings
from morph_retarget.core.morph.bodies import Bodies
from morph_retarget.core.solve import posing
from tests import truth
from tests.skeletons import skeleton_of
from tools.creatures import CREATURES
from tools.figure import Bone, humanoid

PLAIN = GaitSettings()
TIMES = np.arange(0.0, 8.0, 1.0 / 24.0)
PIECE, HEAD, HIGH = 0.2, 0.15, 0.08


def _worm(spine: int, root: int = 0) -> Character:
    """Return a worm along Y with its head in front; the bone ``root``, counted from the rear, carries the others."""
    bones: list[Bone] = []

    def add(i: int, parent: int | None, back: bool) -> None:
        front, rear = np.array([0.0, -PIECE * (i + 1), HIGH]), np.array([0.0, -PIECE * i, HIGH])
        ends = (front, rear) if back else (rear, front)
        bones.append(Bone(f"Spine{i}", None if parent is None else f"Spine{parent}", *ends))

    add(root, None, back=False)
    for i in range(root + 1, spine):
        add(i, i - 1, back=False)
    for i in range(root - 1, -1, -1):
        add(i, i + 1, back=True)
    end = -PIECE * spine
    bones.append(Bone("Head", f"Spine{spine - 1}", np.array([0.0, end, HIGH]), np.array([0.0, end - HEAD, HIGH])))
    if root:
        # Bones to the rear start where the one that carries them does.
        place = {bone.name: bone for bone in bones}
        assert np.allclose(place[f"Spine{root}"].head, place[f"Spine{root - 1}"].head)
    return analyze(skeleton_of(bones, np.random.default_rng(spine)))


def _named(*bones: Bone) -> Character:
    return analyze(skeleton_of(bones, np.random.default_rng(3)))


def _bone(name: str, parent: str | None, head: tuple[float, ...], tail: tuple[float, ...]) -> Bone:
    return Bone(name, parent, np.array(head), np.array(tail))


def _snake() -> Character:
    return analyze(skeleton_of(CREATURES["snake"](), np.random.default_rng(7)))


def _ghost() -> Character:
    return _named(
        _bone("Body", None, (0.0, 0.0, 0.5), (0.0, 0.0, 0.9)),
        _bone("Chest", "Body", (0.0, 0.0, 0.9), (0.0, 0.0, 1.3)),
        _bone("Head", "Chest", (0.0, 0.0, 1.3), (0.0, 0.0, 1.6)),
    )


def _winged_head() -> Character:
    return _named(
        _bone("Head", None, (0.0, 0.0, 0.2), (0.0, 0.0, 0.5)),
        _bone("Jaw", "Head", (0.0, -0.1, 0.25), (0.0, -0.2, 0.2)),
        *(
            _bone(f"Wing.{side}", "Head", (0.1 * x, 0.0, 0.4), (0.6 * x, 0.0, 0.5))
            for side, x in (("L", 1.0), ("R", -1.0))
        ),
    )


CRAWLERS: Mapping[str, Character] = {
    **{f"{count} bodies": _worm(count) for count in (2, 3, 4, 5)},
    "led from the front": _worm(5, 4),
    "led from the middle": _worm(5, 2),
}
SNAKES: Mapping[str, Character] = {
    "a snake with a raised neck": _snake(),
    "a long worm": _worm(14),
    "led from the front": _worm(14, 13),
    "led from the middle": _worm(14, 6),
}


def _root(character: Character) -> int:
    return Bodies.of(character).with_capability(Capability.ROOT)[0]


def _line(character: Character) -> Line:
    found = line.find(character, _root(character))
    assert found is not None
    return found


def _going(size: float, speed: float = 0.4, turn: float = 0.5) -> Course:
    """Return a course that goes straight, then winds to both sides; speeds in sizes."""
    times = np.array([0.0, 3.0, 3.5, 5.0, 5.5, 8.0])
    return course.from_speed(times, np.full(6, speed * size), turn * np.array([0.0, 0.0, 1.0, 1.0, -1.0, -1.0]))


def _prepared(
    character: Character,
    way: Course,
    settings: GaitSettings = PLAIN,
    ground: Ground | None = None,
    movement: Movement | None = None,
) -> crawling.Footless:
    return crawling.prepare(character, _root(character), way, settings, ground, movement)


def _posed(character: Character, moving: Moving, times: Array = TIMES) -> posing.BodyPose:
    """Return the pose that the pose step makes of the goals."""
    rest = character.local_to_character.points(character.skeleton.rest_positions)
    plan = posing.prepare(character, rest, _root(character), list(moving.wanted))
    return posing.solve(plan, moving.evaluate(times))


def _rest(character: Character) -> Array:
    return character.local_to_character.points(character.skeleton.rest_positions)


def _joints(character: Character, points: Array) -> Indices:
    """Return the bodies whose joints are at points of a rest pose, shape (n,)."""
    away = quat.length(_rest(character)[None] - points[:, None])
    assert away.min(axis=1).max() < 1e-9
    return away.argmin(axis=1)


def _hills(points: Array) -> Array:
    return 0.15 * np.sin(0.9 * points[:, 0]) + 0.2 * np.cos(0.8 * points[:, 1])


# --- all of them ---


def _everyone() -> list[tuple[Character, Movement]]:
    return [
        (_snake(), Movement.SERPENTINE),
        (_worm(4), Movement.INCHWORM),
        (_worm(1), Movement.INCHWORM),
        (_ghost(), Movement.FLOAT),
    ]


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
@pytest.mark.parametrize("ground", [None, _hills], ids=["level", "hills"])
def test_a_frame_alone_is_what_it_is_among_others_to_the_bit(
    character: Character, movement: Movement, ground: Ground | None
) -> None:
    moving = _prepared(character, _going(1.0), ground=ground, movement=movement)
    whole = moving.evaluate(TIMES)
    for frame in (0, 7, 100, 191):
        alone = moving.evaluate(TIMES[frame : frame + 1])
        assert (alone.positions[0] == whole.positions[frame]).all()
        assert (alone.turns[0] == whole.turns[frame]).all()


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
def test_goals_are_met_by_the_pose_step_and_follow_the_course(character: Character, movement: Movement) -> None:
    way = _going(1.0)
    moving = _prepared(character, way, movement=movement)
    goals, pose = moving.evaluate(TIMES), _posed(character, moving)
    assert [int(b) for b in goals.bodies] == [body for body, _, _ in moving.wanted]
    assert quat.angle_between(pose.turns[:, goals.bodies], goals.turns).max() < 1e-6
    assert np.abs(pose.positions[:, _root(character)] - goals.positions[:, 0]).max() < 1e-9
    middle = pose.positions.mean(axis=1)[:, :2] - way.at(TIMES)[0][:, :2]
    assert np.hypot(middle[:, 0], middle[:, 1]).max() < 2.5


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
def test_poses_are_continuous(character: Character, movement: Movement) -> None:
    moving = _prepared(character, _going(1.0), ground=_hills, movement=movement)
    fine = np.linspace(-1.0, 9.0, 40_001)
    goals = moving.evaluate(fine)
    assert np.abs(np.diff(goals.positions[:, 0], axis=0)).max() < 0.01
    assert quat.angle_between(goals.turns[1:], goals.turns[:-1]).max() < 0.05


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
def test_a_moving_object_carries_goals_rigidly(character: Character, movement: Movement) -> None:
    moving = _prepared(character, _going(1.0), movement=movement)
    turn = quat.from_rotation_vector(np.array([0.3, -0.8, 1.2]))
    carried = np.tile(np.eye(4), (len(TIMES), 1, 1))
    carried[:, :3, :3], carried[:, :3, 3] = quat.to_matrix(turn), [1.0, 2.0, 3.0]
    own, seen = moving.evaluate(TIMES), moving.evaluate(TIMES, carried)
    moved = quat.rotate(turn[None], own.positions[:, 0]) + carried[:, :3, 3]
    assert np.allclose(seen.positions[:, 0], moved)
    assert quat.angle_between(seen.turns, quat.multiply(turn[None, None], own.turns)).max() < 1e-6


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
def test_a_jump_of_the_course_is_a_jump_and_no_way(character: Character, movement: Movement) -> None:
    places = np.zeros((len(TIMES), 3))
    places[:, 1] = -0.3 * TIMES
    places[96:, 0] += 50.0
    frames = np.tile(np.eye(4), (len(TIMES), 1, 1))
    frames[:, :3, 3] = places
    moving = _prepared(character, course.from_frames(TIMES, frames), movement=movement)
    pose = _posed(character, moving, np.sort(np.concatenate([TIMES, TIMES[95] + np.linspace(0.0, 0.0416, 50)])))
    root = _root(character)
    aside = pose.positions[:, [root, *character.skeleton.tree.below(root)], 0]
    assert (aside.max(axis=1) - aside.min(axis=1)).max() < 3.0
    assert ((np.abs(aside) < 3.0) | (np.abs(aside - 50.0) < 3.0)).all()


@pytest.mark.parametrize(("character", "movement"), _everyone(), ids=["snake", "inch-worm", "hopping", "floating"])
def test_turning_on_the_spot_turns_the_body_on_the_spot(character: Character, movement: Movement) -> None:
    # A quarter turn to the left, standing before and after it.
    times = np.array([0.0, 2.0, 2.01, 4.99, 5.0, 8.0])
    rates = np.pi / 2.0 / 3.0 * np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
    moving = _prepared(character, course.from_speed(times, np.zeros(6), rates), movement=movement)
    goals, size = moving.evaluate(TIMES), Bodies.of(character).size
    still = (TIMES[1:] < 2.0) | (TIMES[:-1] > 5.0)
    if movement is not Movement.FLOAT:
        assert np.abs(np.diff(goals.positions, axis=0))[still].max() < 1e-9
    assert np.hypot(*(goals.positions[:, 0] - goals.positions[0, 0])[:, :2].T).max() < 0.6 * size
    front = goals.turns[:, list(goals.bodies).index(character.head) if character.head in goals.bodies else 0]
    ahead = quat.rotate(front, np.array([0.0, -1.0, 0.0]))
    assert ahead[0] @ [0.0, -1.0, 0.0] > 0.9
    assert ahead[-1] @ [1.0, 0.0, 0.0] > 0.6


# --- snakes ---


def _lying(character: Character) -> Indices:
    """Return the bodies whose joints lie on the ground, from the front to the rear."""
    own = _line(character)
    first, last = own.lying
    rest = _rest(character)
    points = [p for p in own.points[first : last + 1] if quat.length(rest - p).min() < 1e-9]
    return _joints(character, np.array(points))


@pytest.mark.parametrize("character", SNAKES.values(), ids=SNAKES)
def test_every_part_of_a_snake_follows_the_way_of_the_first_so_that_nothing_slips_sideways(
    character: Character,
) -> None:
    size = _line(character).length
    moving = _prepared(character, _going(size))
    fine = np.linspace(-1.5, 8.0, 4_001)
    bodies = _lying(character)
    ways = _posed(character, moving, fine).positions[:, bodies, :2]
    led, starts = ways[:, 0], ways[fine > 5.0]
    for i in range(1, len(bodies)):
        for point in starts[::200, i]:
            assert np.hypot(*(led - point).T).min() < 2e-3 * size


@pytest.mark.parametrize("character", SNAKES.values(), ids=SNAKES)
def test_a_snake_lies_as_high_over_hills_as_it_rests(character: Character) -> None:
    size = _line(character).length
    moving = _prepared(character, _going(size), ground=_hills)
    bodies = _lying(character)
    places = _posed(character, moving).positions[:, bodies]
    over = places[..., 2] - _hills(places.reshape(-1, 3)).reshape(places.shape[:2])
    assert np.abs(over - _rest(character)[bodies, 2]).max() < 4e-3 * size


def test_the_head_of_a_snake_stays_up_and_looks_ahead() -> None:
    character = _snake()
    moving = _prepared(character, course.from_speed(np.array([0.0, 8.0]), np.full(2, 0.5), np.zeros(2)))
    pose, head = _posed(character, moving), character.head
    assert np.allclose(pose.positions[:, head, 2], _rest(character)[head, 2], atol=1e-6)
    assert quat.angle_between(pose.turns[:, head], quat.IDENTITY).max() < 1e-6
    # What is behind it winds.
    tail = pose.turns[:, _line(character).bodies[-3]]
    assert quat.angle_between(tail, quat.IDENTITY).max() > 0.4


def test_a_snake_coils_no_tighter_than_its_pieces_allow() -> None:
    character = _worm(14)
    size = _line(character).length
    for speed, turn in ((0.4, 2.0), (0.2, 3.0), (0.4, 6.0)):
        way = course.from_speed(np.array([0.0, 8.0]), np.full(2, speed * size), np.full(2, turn))
        turns = _prepared(character, way).evaluate(TIMES).turns[:, 1:]
        bends = quat.angle_between(turns[:, 1:], turns[:, :-1])
        assert bends.max() < np.radians(110.0)
        assert bends.mean() < np.radians(45.0)


def test_a_snake_winds_about_its_course_and_keeps_up_with_it() -> None:
    character = _worm(14)
    way = course.from_speed(np.array([0.0, 8.0]), np.full(2, 0.5), np.zeros(2))
    pose = _posed(character, _prepared(character, way))
    places = pose.positions[:, character.head]
    assert abs(places[:, 0].mean()) < 0.05
    assert np.ptp(places[:, 0]) > 0.1
    ahead = -places[:, 1] - 0.5 * TIMES
    assert np.ptp(ahead) < 0.02 * _line(character).length


def test_a_snake_without_width_is_straight_and_stands_when_its_course_does() -> None:
    character = _worm(14)
    way = course.from_speed(np.array([0.0, 2.0, 2.1, 8.0]), np.array([1.0, 1.0, 0.0, 0.0]), np.zeros(4))
    straight = _posed(character, _prepared(character, way, GaitSettings(width=0.0)))
    assert np.abs(straight.positions[..., 0]).max() < 1e-6
    still = _posed(character, _prepared(character, way)).positions[TIMES > 2.1]
    assert np.abs(still - still[0]).max() == 0.0


def test_a_snake_goes_back_through_the_poses_in_which_it_came() -> None:
    character, rates = _worm(14), np.array([0.4, 0.4, 0.4, 0.4])
    times, speed = np.array([0.0, 3.999, 4.001, 8.0]), np.array([1.0, 1.0, -1.0, -1.0])
    moving = _prepared(character, course.from_speed(times, speed, rates * speed))
    assert moving.warnings == ()
    there = np.linspace(0.5, 3.5, 20)
    forth, back = (_posed(character, moving, t).positions for t in (there, 8.0 - there))
    assert np.abs(forth - back).max() < 0.02
    astray = _prepared(character, course.from_speed(times, speed, np.array([0.0, 0.0, 0.8, 0.8])))
    assert len(astray.warnings) == 1
    assert "off its course" in astray.warnings[0]


def test_a_real_snake_winds(data: Path) -> None:
    table = next(t for t in truth.tables(data) if t["id"] == "m2m_snake")
    character = truth.find(truth.rig(data, table))
    moving = _prepared(character, _going(_line(character).length))
    assert isinstance(moving, Serpentine)
    pose = _posed(character, moving)
    assert np.abs(np.diff(pose.positions, axis=0)).max() < 0.15
    assert np.ptp(pose.positions[0][:, 0]) > 0.2
    assert pose.positions[..., 2].max() < 0.2


# --- inch-worms ---


def _feet(character: Character, moving: Inchworm) -> Array:
    """Return where the points of the pseudo-feet are in the solved pose, shape (frame, 2, 3)."""
    own = moving.line
    pose = _posed(character, moving)
    turns = pose.turns[:, list(own.bodies)]
    body = own.bodies[own.carrier]
    # The point behind the body that carries the line, and from there all others.
    away = own.points[own.carrier + 1] - _rest(character)[body]
    held = pose.positions[:, body] + quat.rotate(turns[:, own.carrier], np.broadcast_to(away, (len(turns), 3)))
    points = own.along(turns, own.carrier + 1, held)
    return points[:, [moving.front.point, moving.rear.point]]


@pytest.mark.parametrize("character", CRAWLERS.values(), ids=CRAWLERS)
@pytest.mark.parametrize("ground", [None, _hills], ids=["level", "hills"])
def test_pseudo_feet_that_stand_do_not_slip_and_one_always_stands(character: Character, ground: Ground | None) -> None:
    size = _line(character).length
    moving = _prepared(character, _going(size), ground=ground)
    assert isinstance(moving, Inchworm)
    standing, places = moving.standing(TIMES), _feet(character, moving)
    assert standing.any(axis=1).all()
    assert (~standing).any(axis=0).all()
    moved = quat.length(np.diff(places, axis=0))
    assert moved[standing[1:] & standing[:-1]].max() < 1e-6 * size
    assert moved.max() > 0.02 * size


@pytest.mark.parametrize("character", CRAWLERS.values(), ids=CRAWLERS)
def test_an_inch_worm_starts_as_it_rests_and_keeps_up_with_its_course(character: Character) -> None:
    size = _line(character).length
    way = course.from_speed(np.array([0.0, 8.0]), np.full(2, 0.3 * size), np.zeros(2))
    pose = _posed(character, _prepared(character, way))
    assert np.abs(pose.positions[0] - _rest(character)).max() < 1e-6 * size
    ahead = -pose.positions[:, character.head, 1] - 0.3 * size * TIMES
    assert np.ptp(ahead) < 0.5 * size
    assert abs(ahead[-24:].mean() - ahead[:24].mean()) < 0.25 * size


@pytest.mark.parametrize("character", CRAWLERS.values(), ids=CRAWLERS)
def test_the_body_arches_up_between_its_pseudo_feet(character: Character) -> None:
    moving = _prepared(character, _going(_line(character).length))
    assert isinstance(moving, Inchworm)
    high = _posed(character, moving).positions[..., 2]
    assert high.max() > _rest(character)[:, 2].max() + 0.3 * moving.stride
    assert high.min() > _rest(character)[:, 2].min() - 1e-6


def test_higher_and_longer_steps_are_what_settings_ask_for() -> None:
    character, way = _worm(5), _going(1.0)
    usual, other = (_prepared(character, way, s) for s in (PLAIN, GaitSettings(stride=0.5, step_height=3.0)))
    assert isinstance(usual, Inchworm)
    assert isinstance(other, Inchworm)
    assert other.stride == pytest.approx(0.5 * usual.stride)
    assert other.lift == pytest.approx(3.0 * usual.lift)
    endless = _prepared(character, way, GaitSettings(stride=100.0))
    assert isinstance(endless, Inchworm)
    assert endless.stride < endless.arch.longest


def test_a_body_without_a_spine_hops_and_says_so() -> None:
    character = _worm(1)
    moving = _prepared(character, _going(1.0))
    assert isinstance(moving, Hopping)
    assert "hops" in moving.warnings[0]
    standing, root = moving.standing(TIMES), _posed(character, moving).positions[:, _root(character)]
    both = standing[1:] & standing[:-1]
    moved = quat.length(np.diff(root, axis=0))
    assert moved[both].max() < 1e-9
    assert both.any()
    assert root[~standing, 2].max() > root[standing, 2].max() + 0.8 * moving.height


@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("movement", [Movement.INCHWORM, Movement.FLOAT])
def test_what_has_one_body_that_can_do_anything_goes_as_its_size_lets_it(movement: Movement, size: float) -> None:
    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 0.6 * size], [0.0, 0.0, size]])
    character = analyze(skeleton_of([Bone("Pot", None, ends[0], ends[1]), Bone("Lid", "Pot", ends[1], ends[2])]))
    assert len(character.capabilities) < 2
    moving = _prepared(character, _going(size), movement=movement)
    if isinstance(moving, Hopping):
        assert moving.height == pytest.approx(HEIGHT * size)
    else:
        assert isinstance(moving, Floating)
        assert moving.size == pytest.approx(size)


# --- floating ---


def test_what_floats_stays_about_where_its_course_is_and_bobs() -> None:
    character = _ghost()
    pose = _posed(character, _prepared(character, Course(np.zeros(1), np.zeros((1, 3)), np.zeros(1))))
    away = pose.positions - _rest(character)
    assert np.abs(away[..., :2]).max() < 1e-9
    assert 0.02 < np.abs(away[..., 2]).max() < 0.1
    assert quat.angle_between(pose.turns, quat.IDENTITY).max() < 1e-9


def test_what_floats_leans_into_what_pulls_it() -> None:
    character = _ghost()
    times = np.array([0.0, 2.0, 3.0, 5.0, 6.0, 8.0])
    straight = course.from_speed(times, np.array([0.0, 0.0, 3.0, 3.0, 0.0, 0.0]), np.zeros(6))
    moving = _prepared(character, straight)

    def lean(way: Moving, time: float) -> Array:
        return quat.rotate(way.evaluate(np.array([time])).turns[0, 0], np.array([0.0, 0.0, 1.0]))

    assert np.allclose(lean(moving, 1.0), [0.0, 0.0, 1.0])
    assert -lean(moving, 2.5)[1] > -lean(moving, 4.0)[1] > 0.05
    assert lean(moving, 5.5)[1] > 0.0
    circle = _prepared(character, course.from_speed(times, np.full(6, 2.0), np.full(6, 1.5)))
    at = 4.0
    left = quat.rotate(quat.from_axis_angle(np.array([0.0, 0.0, 1.0]), 1.5 * at), np.array([1.0, 0.0, 0.0]))
    assert lean(circle, at) @ left > 0.1
    wild = _prepared(character, course.from_speed(times, np.full(6, 500.0), np.full(6, 20.0)))
    assert (wild.evaluate(TIMES).turns[:, 0, 1:3] ** 2).sum(axis=1).max() < np.sin(np.radians(20.0)) ** 2


def test_what_floats_keeps_its_height_over_the_ground() -> None:
    character = _ghost()
    moving = _prepared(character, _going(1.0), ground=lambda points: np.full(len(points), 2.0))
    root = _posed(character, moving).positions[:, _root(character), 2]
    assert np.abs(root - 2.0 - _rest(character)[_root(character), 2]).max() < 0.15
    nowhere = _prepared(character, _going(1.0), ground=lambda points: np.full(len(points), np.nan))
    assert np.isfinite(nowhere.evaluate(TIMES).positions).all()


# --- who does what ---


@pytest.mark.parametrize(
    ("character", "movement"),
    [
        (_snake(), Movement.SERPENTINE),
        (_worm(14), Movement.SERPENTINE),
        (_worm(5), Movement.INCHWORM),
        (_worm(2), Movement.INCHWORM),
        (_ghost(), Movement.FLOAT),
        (_winged_head(), Movement.FLOAT),
    ],
    ids=["a snake", "a long worm", "a caterpillar", "a maggot", "a ghost", "a head with wings"],
)
def test_what_has_no_feet_gets_about_as_its_body_lies(character: Character, movement: Movement) -> None:
    assert crawling.choose(character, _root(character)) is movement


def test_real_bodies_without_feet_get_about(data: Path) -> None:
    found = {}
    for table in truth.tables(data):
        if table["id"] in ("m2m_snake", "quaternius_bee"):
            character = truth.find(truth.rig(data, table))
            found[table["id"]] = crawling.choose(character, _root(character))
    assert found == {"m2m_snake": Movement.SERPENTINE, "quaternius_bee": Movement.FLOAT}


def test_any_body_can_be_made_to_float_or_to_crawl() -> None:
    for character in (_snake(), _worm(5), _worm(1), _ghost(), _winged_head()):
        for movement in (Movement.FLOAT, Movement.INCHWORM):
            moving = _prepared(character, _going(1.0), movement=movement)
            assert np.isfinite(_posed(character, moving).positions).all()


def test_a_body_without_a_spine_cannot_wind() -> None:
    with pytest.raises(RigError, match="no spine of 3 bodies"):
        _prepared(_worm(1), _going(1.0), movement=Movement.SERPENTINE)


def test_a_stride_that_leads_nowhere_is_refused() -> None:
    for character in (_snake(), analyze(skeleton_of(humanoid()))):
        with pytest.raises(MotionError, match="stride is 0"):
            getting_about.prepare(character, _root(character), _going(1.0), GaitSettings(stride=0.0))


def test_bodies_that_hang_on_nothing_are_told_of() -> None:
    loose = _named(
        _bone("Body", None, (0.0, 0.0, 0.3), (0.0, 0.0, 0.6)),
        _bone("Head", None, (0.0, 0.0, 0.8), (0.0, 0.0, 1.2)),
        *(
            _bone(f"Wing.{side}", "Head", (0.1 * x, 0.0, 0.9), (0.6 * x, 0.0, 1.0))
            for side, x in (("L", 1.0), ("R", -1.0))
        ),
    )
    moving = _prepared(loose, _going(1.0))
    assert any("'Head' does not hang on 'Body'" in warning for warning in moving.warnings)
