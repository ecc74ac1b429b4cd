"""How well, how smoothly and how fast bodies are brought to random goals, beside Blender's own inverse kinematics.

``python -m tests.bench.ik [RIG…] [--sets N] [--paths N] [--each] [--no-blender] [--speed]``
measures some rigs alone.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.solve import posing
from morph_retarget.core.solve.goals import Goals
from morph_retarget.core.solve.plan import Plan
from morph_retarget.core.solve.settings import SolverSettings
from tests import goal_sets, pose_measures
from tests.conftest import DATA
from tests.goal_sets import Sets, Subject
from tests.morph_bodies import real_characters
from tests.pose_measures import MEET
from tests.skeletons import skeleton_of
from tools.figure import Bone, Build, humanoid

from .blenders_ik import SOLVERS, Rival
from .figures import Figure, medians, seconds, short, table

SETS, PATHS, STEPS = 1000, 20, 100
"""Sets of goals for each rig, ways between two of them, and steps of a way."""
BLENDER_SETS, BLENDER_PATHS = 100, 4
"""The same where Blender's solvers take part: they pose frames one by one."""
WIDE = 20.0
"""Nothing may turn further in a step [deg]."""
BUILD = Build(spine=4, neck=2, root=True)
"""Gives 25 bodies, of which root, head, hands and feet have goals."""
FRAMES, ALONE, REPETITIONS = 250, 10, 9
BODIES = (25, 80, 200)
"""Of the centipedes that show how time grows."""
PER_SEGMENT, PER_END = 7, 3
"""Bones of a centipede's segment with two legs, and of its ground, neck and head."""


@dataclass(frozen=True)
class Steps:
    """How much joints turn from frame to frame."""

    turns: Array
    """The most that any joint turns in each step [deg], shape (step,)."""
    motions: Array
    """How far goals go in each step, see `pose_measures.goal_motion`, shape (step,)."""

    @property
    def slopes(self) -> Array:
        """Turn [rad] over the motion of goals, shape (step,): the largest is the Lipschitz constant as far as seen."""
        return np.radians(self.turns) / np.maximum(self.motions, 1e-12)

    @property
    def cells(self) -> list[str]:
        """Return the 99th percentile and the most of both."""
        return [short(f(values)) for values in (self.turns, self.slopes) for f in (_most_of, np.max)]


@dataclass(frozen=True, eq=False)
class Row:
    """What one solver does with one rig."""

    missed: Array
    """See `pose_measures.misses`, all goals but the root's, shape (set, goal)."""
    reachable: Steps
    """On ways on which all goals can be met."""
    seconds: float
    """Time a frame."""
    straight: Steps | None = None
    """On straight ways, on which not all can."""
    length: float = 0.0
    """Largest error of a bone's length, see `pose_measures.length_errors`."""
    gap: float = 0.0
    """The same of what is between a limb and a foot or hand that hangs elsewhere, see `pose_measures.gaps`."""
    turn: float = 0.0
    """Largest angle between a body and its goal [rad]."""

    @property
    def met(self) -> float:
        """Share of goals that are met [%]."""
        return 100.0 * float((self.missed <= MEET).mean())

    @property
    def whole(self) -> float:
        """Share of sets of which all goals are met [%]."""
        return 100.0 * float((self.missed <= MEET).all(axis=1).mean())


@dataclass
class Findings:
    """Rows of all rigs, by the name of what solved them."""

    rows: dict[str, list[Row]] = field(default_factory=dict[str, list[Row]])

    def add(self, solver: str, row: Row) -> Row:
        """Keep a row, and return it."""
        self.rows.setdefault(solver, []).append(row)
        return row

    def met(self, solver: str) -> float:
        """Share of all goals of all rigs that are met [%]."""
        return 100.0 * float(np.mean(np.concatenate([(r.missed <= MEET).ravel() for r in self.rows[solver]])))


def _most_of(values: Array) -> float:
    return float(np.percentile(values, 99.0))


def run() -> list[Figure]:
    """Return shares of goals met and speeds, over all rigs and Blender's solvers on the same."""
    if not DATA.is_dir():
        print(f"no real rigs at {DATA}: only the sample characters (set MORPH_RETARGET_DATA to their folder)")
    figures = _accuracy(characters(), SETS, PATHS, blender=True)
    return [*figures, *_speeds()]


def characters() -> Mapping[str, Character]:
    """Return the sample characters and all real rigs, by name."""
    return {**goal_sets.creatures(), **(real_characters(DATA) if DATA.is_dir() else {})}


# --- accuracy and smoothness ---


def _accuracy(rigs: Mapping[str, Character], sets: int, paths: int, blender: bool, each: bool = False) -> list[Figure]:
    found = Findings()
    subjects = {name: Subject(character) for name, character in rigs.items()}
    subjects = {name: subject for name, subject in subjects.items() if len(subject.goals) > 1}
    ours = ["bodies", "goals", "met %", "sets %", "worst mm", "worst °", "length"]
    smooth = ["°/step 99%", "most", "slope 99%", "most"]
    print(f"{sets} sets a rig; {paths} ways of {STEPS} steps: reachable all along | straight")
    print(_line("", [*ours, *smooth, "|", *smooth[:2], "µs"]))
    for name, subject in subjects.items():
        row = found.add("ours", _measured(subject, _sets(subject, sets), paths))
        worst = [short(1e3 * row.missed.max()), short(np.degrees(row.turn)), f"{row.length:.0e}"]
        shares = [f"{row.met:.2f}", f"{row.whole:.1f}"]
        counts = [str(len(subject.bodies)), str(len(subject.goals))]
        ways = [*row.reachable.cells, "|", *(row.straight.cells[:2] if row.straight else [])]
        print(_line(name, [*counts, *shares, *worst, *ways, short(1e6 * row.seconds)]), flush=True)
        if each:
            print(f"    {_of_each(subject, row)}")
    if blender:
        _compare(subjects, found, min(sets, BLENDER_SETS), min(paths, BLENDER_PATHS))
    return list(_figures(list(subjects), found))


def _compare(subjects: Mapping[str, Subject], found: Findings, sets: int, paths: int) -> None:
    """Print what Blender's solvers do, beside ours on the same goals."""
    print(f"\nbeside Blender's solvers, on the first {sets} sets and {paths} reachable ways, one frame at a time")
    names = ["ours", *SOLVERS.values()]
    print(_line("", [cell for name in names for cell in (name, "worst mm", "°/step", "slope", "µs", "|")][:-1]))
    for name, subject in subjects.items():
        goals = _sets(subject, sets)
        rows = [found.add("ours, same", _alone(subject, goals, paths))]
        with Rival(subject) as rival:
            rows += [found.add(title, _rivals(rival, solver, goals, paths)) for solver, title in SOLVERS.items()]
        cells = [
            [f"{r.met:.1f}%", short(1e3 * r.missed.max()), r.reachable.cells[1], r.reachable.cells[3], _us(r), "|"]
            for r in rows
        ]
        print(_line(name, [cell for row in cells for cell in row][:-1]), flush=True)


def _of_each(subject: Subject, row: Row) -> str:
    """Return how often each goal is met, in words."""
    shares = 100.0 * (row.missed <= MEET).mean(axis=0)
    names = [subject.bodies.names[body] for body in subject.goals[1:]]
    return ", ".join(f"{name} {share:.1f}" for name, share in zip(names, shares, strict=True))


def _us(row: Row) -> str:
    return short(1e6 * row.seconds)


def _line(name: str, cells: Sequence[str]) -> str:
    return " ".join([f"{name:28}", *(cell if cell == "|" else cell.rjust(10) for cell in cells)])


def _sets(subject: Subject, count: int) -> Sets:
    """Return the same sets, however many are asked for."""
    all_of_them = goal_sets.random_sets(subject, np.random.default_rng(0), SETS)
    return all_of_them.first(count)


def _ways(sets: Sets, paths: int) -> Iterator[tuple[int, int]]:
    """Yield the sets at the ends of each way."""
    pairs = max(len(sets) // 2, 1)
    yield from ((2 * (i % pairs), min(2 * (i % pairs) + 1, len(sets) - 1)) for i in range(paths))


def _measured(subject: Subject, sets: Sets, paths: int) -> Row:
    """Return what the pose step does with all sets in one batch."""
    goals = sets.goals
    _ = subject.plan
    pose = posing.solve(subject.plan, goals)
    taken = seconds(lambda: posing.solve(subject.plan, goals).positions)
    missed = pose_measures.misses(subject, goals, pose_measures.rebuilt(subject, pose))
    ways = list(_ways(sets, paths))
    return Row(
        missed[:, 1:],
        _steps(subject, [sets.toward(*way, STEPS).goals for way in ways]),
        taken / len(sets),
        _steps(subject, [sets.straight(*way, STEPS) for way in ways]),
        float(pose_measures.length_errors(subject, pose.positions).max(initial=0.0)),
        float(pose_measures.gaps(subject, pose.positions).max(initial=0.0)),
        float(quat.angle_between(pose.turns[:, goals.bodies], goals.turns).max()),
    )


def _alone(subject: Subject, sets: Sets, paths: int) -> Row:
    """Return what the pose step does with sets one by one."""
    goals = sets.goals
    single = [goal_sets.rows(goals, slice(i, i + 1)) for i in range(len(sets))]
    poses = [posing.solve(subject.plan, one) for one in single]
    taken = seconds(lambda: [posing.solve(subject.plan, one).positions for one in single])
    places = np.concatenate([pose_measures.rebuilt(subject, pose) for pose in poses])
    missed = pose_measures.misses(subject, goals, places)[:, 1:]
    ways = [sets.toward(*way, STEPS).goals for way in _ways(sets, paths)]
    return Row(missed, _steps(subject, ways), taken / len(sets))


def _rivals(rival: Rival, solver: str, sets: Sets, paths: int) -> Row:
    """Return what one of Blender's solvers does."""
    subject, goals = rival.subject, sets.goals
    solved = rival.solve(solver, goals)
    missed = pose_measures.misses(subject, goals, solved.places)[:, 1:]
    ways = [sets.toward(*way, STEPS).goals for way in _ways(sets, paths)]
    turns = [rival.solve(solver, way).turns for way in ways]
    return Row(missed, _steps_of(subject, ways, turns), solved.seconds)


def _steps(subject: Subject, ways: Sequence[Goals]) -> Steps:
    return _steps_of(subject, ways, [posing.solve(subject.plan, way).turns for way in ways])


def _steps_of(subject: Subject, ways: Sequence[Goals], turns: Sequence[Array]) -> Steps:
    most = [np.degrees(pose_measures.step_turns(turn[:, subject.joints])) for turn in turns]
    return Steps(np.concatenate(most), np.concatenate([pose_measures.goal_motion(subject, way) for way in ways]))


def _figures(names: Sequence[str], found: Findings) -> Iterator[Figure]:
    rows = found.rows["ours"]
    worst = int(np.argmin([row.met for row in rows]))
    jump = int(np.argmax([row.reachable.turns.max() for row in rows]))
    straight = [row.straight.turns for row in rows if row.straight is not None]
    yield Figure("ik: goals met, all rigs", found.met("ours"), "%", 99.0, at_least=True)
    yield Figure(f"ik: goals met, {names[worst]} (least)", rows[worst].met, "%", 99.0, at_least=True)
    yield Figure("ik: rigs that meet fewer", sum(row.met < 99.0 for row in rows), "rigs", 0.0)
    yield Figure("ik: error of a bone's length", max(row.length for row in rows), "", 1e-5)
    yield Figure("ik: gap to a foot that hangs elsewhere, over the bone's length", max(row.gap for row in rows), "")
    yield Figure(f"ik: turn in a 1 % step, {names[jump]} (most)", rows[jump].reachable.turns.max(), "°", WIDE)
    yield Figure("ik: the same, 99 % of steps", _most_of(np.concatenate([r.reachable.turns for r in rows])), "°")
    yield Figure("ik: turn in a step straight through, 99 % of steps", _most_of(np.concatenate(straight)), "°")
    for solver in ("ours, same", *SOLVERS.values()):
        if solver in found.rows:
            turns = np.concatenate([row.reachable.turns for row in found.rows[solver]])
            taken = float(np.median([row.seconds for row in found.rows[solver]]))
            title = {"ours, same": "ours on the same"}.get(solver, f"Blender's {solver}")
            yield Figure(f"ik: goals met, {title}", found.met(solver), "%")
            yield Figure(f"ik: most in a 1 % step, {title}", float(turns.max()), "°")
            yield Figure(f"ik: one frame alone, median of rigs, {title}", 1e6 * taken, "µs")


# --- speed ---


def _speeds() -> list[Figure]:
    """Return the times of a frame in a batch and alone, and how they grow with the bodies."""
    adult = Subject(analyze(skeleton_of(humanoid(1.75, build=BUILD), np.random.default_rng(0))))
    batch, alone = _times(adult, adult.plan)
    still_batch, still_alone = _times(adult, _without_bending(adult))
    print(f"\n{len(adult.bodies)} bodies, {len(adult.goals)} goals: ", end="")
    print(f"{short(1e6 * batch)} µs a frame in a batch of {FRAMES}, {short(1e6 * alone)} µs alone")
    print(f"the same, whose spine does not bend: {short(1e6 * still_batch)} µs, {short(1e6 * still_alone)} µs alone")
    crowd = [Subject(analyze(skeleton_of(centipede(bodies)))) for bodies in BODIES]
    times = [_times(subject, subject.plan) for subject in crowd]
    for subject, (together, single) in zip(crowd, times, strict=True):
        counts = f"centipede, {len(subject.bodies)} bodies, {len(subject.goals)} goals"
        print(f"{counts}: {short(1e6 * together)} µs a frame in a batch, {short(1e6 * single)} µs alone")
    least, most = (times[i][0] / len(crowd[i].bodies) for i in (0, -1))
    return [
        Figure("ik: 25 bodies and 6 goals, in a batch of 250", 1e6 * batch, "µs a frame", 20.0),
        Figure("ik: 25 bodies and 6 goals, one frame alone", 1e6 * alone, "µs", 500.0),
        Figure("ik: the same without Bend Spine, in a batch", 1e6 * still_batch, "µs a frame", 20.0),
        Figure("ik: the same without Bend Spine, one frame alone", 1e6 * still_alone, "µs", 500.0),
        Figure(f"ik: time a body, {BODIES[-1]} bodies over {BODIES[0]}", most / least, "", 1.25),
    ]


def _without_bending(subject: Subject) -> Plan:
    """Return how the same goals are met by limbs alone, as characters do unless they are told to bend their spines."""
    wanted = [(int(body), True, True) for body in subject.goals]
    return posing.prepare(subject.character, subject.bodies.positions, subject.root, wanted, SolverSettings())


def _times(subject: Subject, plan: Plan) -> tuple[float, float]:
    """Return the times of a frame in a batch and alone, places of all bodies included [s]."""
    goals = _sets(subject, FRAMES).goals
    one = goal_sets.rows(goals, slice(0, 1))
    batch, alone = medians(
        [
            lambda: seconds(lambda: posing.solve(plan, goals).positions),
            lambda: seconds(lambda: [posing.solve(plan, one).positions for _ in range(ALONE)]) / ALONE,
        ],
        REPETITIONS,
    )
    return batch / FRAMES, alone


def centipede(bodies: int) -> list[Bone]:
    """Return a figure whose goals grow with its bodies: two legs a segment; what is left over are antennae."""
    segments = (bodies - PER_END) // PER_SEGMENT
    starts = 0.1 * np.arange(segments + 1) - 0.05 * segments
    above, out = "Root", [Bone("Root", None, (0.0, 0.0, 0.0), (0.0, 0.1, 0.0))]
    for i, (start, end) in enumerate(zip(-starts[:-1], -starts[1:], strict=True), 1):
        own, middle = f"Spine.{i:03}", 0.5 * (start + end)
        out.append(Bone(own, above, (0.0, start, 0.2), (0.0, end, 0.2)))
        above = own
        for side, sign in (("L", 1.0), ("R", -1.0)):
            line = [f"{joint}{i}.{side}" for joint in ("Thigh", "Shin", "Foot")]
            points = [(sign * x, middle, z) for x, z in ((0.05, 0.2), (0.18, 0.26), (0.25, 0.02), (0.3, 0.0))]
            parents = [own, *line]
            out += [Bone(*bone) for bone in zip(line, parents, points[:-1], points[1:], strict=False)]
    front = float(-starts[-1])
    neck, head = (0.0, front, 0.2), (0.0, front - 0.06, 0.24)
    out += [Bone("Neck", above, neck, head), Bone("Head", "Neck", head, (0.0, front - 0.16, 0.24))]
    rest = range(bodies - len(out))
    return [*out, *(Bone(f"Antenna{i}", "Head", (0.0, front - 0.1, 0.27), (0.0, front - 0.2, 0.3)) for i in rest)]


def main(arguments: Sequence[str]) -> int:
    """Measure some rigs and return the exit status."""
    parser = argparse.ArgumentParser(prog="ik", description="Measure how bodies are brought to random goals.")
    parser.add_argument("rigs", nargs="*", metavar="RIG", help="all when none is named")
    parser.add_argument("--sets", type=int, default=SETS, metavar="N", help=f"of goals, {SETS} at most")
    parser.add_argument("--paths", type=int, default=PATHS, metavar="N", help="ways between two sets")
    parser.add_argument("--no-blender", action="store_true", help="leave Blender's own solvers out")
    parser.add_argument("--each", action="store_true", help="tell how often each goal is met [%%]")
    parser.add_argument("--speed", action="store_true", help="measure times as well")
    asked = parser.parse_args(arguments)
    rigs = characters()
    unknown = [name for name in asked.rigs if name not in rigs]
    if unknown:
        print(f"no rig {unknown[0]!r}: choose from {', '.join(rigs)}", file=sys.stderr)
        return 2
    chosen = {name: rigs[name] for name in asked.rigs or rigs}
    figures = _accuracy(chosen, asked.sets, asked.paths, not asked.no_blender, asked.each)
    print(table([*figures, *(_speeds() if asked.speed else [])]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
