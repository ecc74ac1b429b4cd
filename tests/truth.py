"""Hand-checked truth about real rigs, and how well the analysis does against it."""

import importlib.util
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.character.analysis import analyze
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.joints import mirrored
from morph_retarget.core.skeleton import Skeleton
from tests import skeletons

Table = Mapping[str, Any]
CAPABILITIES = ("foot", "spine", "head", "tail", "grasper")


def tables(data: Path) -> Iterator[Table]:
    """Yield all tables of the data folder."""
    yield from _loader(data).tables(str(data))


def _loader(data: Path) -> Any:
    """Return the module beside the tables that reads them and lays out those without positions."""
    spec = importlib.util.spec_from_file_location("skeleton_loader", data / "skeleton_loader.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@dataclass(frozen=True)
class Rig:
    """One rig of the tables, with the names it has in this trial."""

    table: Table
    skeleton: Skeleton
    original: Mapping[str, str]
    """Name in this trial to the table's."""


def rig(data: Path, table: Table) -> Rig:
    """Return a table's rig as it is."""
    heads, tails, _ = _loader(data)._positions(table)
    parents = {b["name"]: b["parent"] for b in table["bones"]}
    return _build({n: (parents[n], np.array(heads[n]), np.array(tails[n])) for n in parents}, table)


_Bones = dict[str, tuple[str | None, np.ndarray, np.ndarray]]


def _build(bones: _Bones, table: Table, names: Mapping[str, str] | None = None) -> Rig:
    order = [n for n, (parent, _, _) in bones.items() if parent is None]
    for name in order:
        order.extend(n for n, (parent, _, _) in bones.items() if parent == name)
    names = names or {n: n for n in order}
    place = {n: i for i, n in enumerate(order)}
    parents = [-1 if (p := bones[n][0]) is None else place[p] for n in order]
    skeleton = Skeleton(
        tuple(names[n] for n in order),
        np.array(parents),
        np.array([bones[n][1] for n in order], dtype=np.float64),
        quat.identity(len(order)),
        np.array([bones[n][2] for n in order], dtype=np.float64),
    )
    return Rig(table, skeleton, {names[n]: n for n in order})


def _bones(of: Rig) -> _Bones:
    s = of.skeleton
    return {
        of.original[n]: (
            None if s.parents[i] < 0 else of.original[s.names[s.parents[i]]],
            s.rest_positions[i],
            s.rest_tails[i],
        )
        for i, n in enumerate(s.names)
    }


def nameless(of: Rig) -> Rig:
    """Return the rig with bones called ``joint1``, ``joint2`` … in an order that says nothing."""
    bones = _bones(of)
    numbers = np.random.default_rng(0).permutation(len(bones)) + 1
    return _build(bones, of.table, {n: f"joint{k}" for n, k in zip(bones, numbers, strict=True)})


def bent(of: Rig, amount: float, seed: int) -> Rig:
    """Return the rig with its rest bent at every bone, see `skeletons.bent`."""
    return replace(of, skeleton=skeletons.bent(of.skeleton, amount, seed))


# --- clutter ---


def _chain(bones: _Bones, stem: str, parent: str, start: np.ndarray, step: np.ndarray, count: int) -> None:
    above = parent
    for i in range(count):
        name = f"{stem}{i + 1}"
        bones[name] = (above, start + i * step, start + (i + 1) * step)
        above = name


def _segments(of: Rig, *joints: tuple[str, str]) -> Iterator[tuple[str, str, np.ndarray, np.ndarray]]:
    truth, bones = of.table["ground_truth"]["canonical"], _bones(of)
    for side in ("left", "right"):
        for a, b in joints:
            if side + a in truth and side + b in truth:
                top, end = truth[side + a], truth[side + b]
                yield ("l" if side == "left" else "r"), top, bones[top][1], bones[end][1]


def _twist(of: Rig, bones: _Bones, _: float) -> None:
    limbs = (("UpperArm", "LowerArm"), ("LowerArm", "Hand"), ("UpperLeg", "LowerLeg"), ("LowerLeg", "Foot"))
    for side, top, start, end in _segments(of, *limbs):
        step = (end - start) / 3.0
        for i in (1, 2):
            bones[f"{top}_twist{i}_{side}"] = (top, start + i * step, start + (i + 1) * step)


def _hair(of: Rig, bones: _Bones, size: float) -> None:
    head = of.table["ground_truth"]["canonical"].get("head")
    if head:
        start = bones[head][1] + size * np.array([0.0, 0.03, 0.1])
        for side, x in (("l", 0.04), ("r", -0.04), ("b", 0.0)):
            _chain(
                bones,
                f"hair_{side}_",
                head,
                start + size * np.array([x, 0, 0]),
                size * np.array([x / 4, 0.01, -0.05]),
                4,
            )


def _tail(of: Rig, bones: _Bones, size: float) -> None:
    hips = of.table["ground_truth"]["canonical"]["hips"]
    _chain(
        bones,
        "tail_",
        hips,
        bones[hips][1] + size * np.array([0, 0.05, 0.0]),
        size * np.array([0.0, 0.06, -0.03]),
        6,
    )


def _skirt(of: Rig, bones: _Bones, size: float) -> None:
    hips = of.table["ground_truth"]["canonical"]["hips"]
    for i, (x, y) in enumerate(((0.09, 0.0), (-0.09, 0.0), (0.05, -0.07), (-0.05, -0.07), (0.05, 0.07), (-0.05, 0.07))):
        start = bones[hips][1] + size * np.array([x, y, -0.02])
        _chain(bones, f"skirt_{'l' if x > 0 else 'r'}{i // 2}_", hips, start, size * np.array([x / 4, y / 4, -0.08]), 3)


def _ik(of: Rig, bones: _Bones, size: float) -> None:
    root = next(n for n, (parent, _, _) in bones.items() if parent is None)
    for side, _, _, end in _segments(of, ("LowerArm", "Hand")):
        bones[f"ik_hand_{side}"] = (root, end, end + size * np.array([0, -0.05, 0]))
    for side, _, start, end in _segments(of, ("LowerLeg", "Foot")):
        bones[f"ik_foot_{side}"] = (root, end, end + size * np.array([0, -0.08, 0]))
        bones[f"pole_knee_{side}"] = (
            root,
            start + size * np.array([0, -0.4, 0]),
            start + size * np.array([0, -0.45, 0]),
        )


def _weapon(of: Rig, bones: _Bones, size: float) -> None:
    truth = of.table["ground_truth"]["canonical"]
    chest = next(truth[j] for j in ("upperChest", "chest", "spine", "hips") if j in truth)
    _chain(
        bones,
        "sword_",
        chest,
        bones[chest][1] + size * np.array([0.1, 0.08, 0.1]),
        size * np.array([-0.06, 0, -0.12]),
        3,
    )
    if "rightHand" in truth:
        hand = truth["rightHand"]
        _chain(
            bones, "weapon_", hand, bones[hand][1] + size * np.array([0, -0.02, 0]), size * np.array([0, -0.2, 0]), 2
        )


CLUTTER: Mapping[str, Callable[[Rig, _Bones, float], None]] = {
    "twist": _twist,
    "hair": _hair,
    "tail": _tail,
    "skirt": _skirt,
    "ik": _ik,
    "weapon": _weapon,
}


def cluttered(of: Rig, *kinds: str) -> Rig:
    """Return the rig with bones added that are no part of the body."""
    bones = _bones(of)
    size = float(np.ptp(np.array([head for _, head, _ in bones.values()]), axis=0)[2])
    for kind in kinds:
        CLUTTER[kind](of, bones, size)
    return _build(bones, of.table)


# --- scores ---


@dataclass
class Score:
    """How a humanoid's joints compare with the truth."""

    right: int = 0
    wrong: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    claimed: list[str] = field(default_factory=list)
    """Joints found that the truth says are absent."""
    swapped: list[str] = field(default_factory=list)
    """Of the wrong ones, those that are the other side's."""

    @property
    def known(self) -> int:
        """Joints that the truth has."""
        return self.right + len(self.wrong) + len(self.missing)

    @property
    def faults(self) -> list[str]:
        """All that is not right."""
        return [*self.wrong, *(f"no {j}" for j in self.missing), *(f"claims {j}" for j in self.claimed)]

    def add(self, other: "Score") -> None:
        """Count another rig's joints as well."""
        self.right += other.right
        for name in ("wrong", "missing", "claimed", "swapped"):
            getattr(self, name).extend(getattr(other, name))


def find(of: Rig) -> Character:
    """Return what the analysis makes of a rig."""
    return analyze(of.skeleton)


def score_joints(of: Rig, found: Character) -> Score:
    """Return how the joints of a humanoid compare with the truth; alternates that the table accepts are right."""
    truth = of.table["ground_truth"]
    bones = {joint: of.original[match.bone] for joint, match in found.joints.items()}
    out = Score()
    for joint, bone in truth["canonical"].items():
        own = bones.get(joint)
        accepted = {bone, *truth["acceptable_alternates"].get(joint, [])}
        if own is None:
            out.missing.append(joint)
        elif own in accepted:
            out.right += 1
        else:
            out.wrong.append(f"{joint} is {own}")
            if own == truth["canonical"].get(mirrored(joint)):
                out.swapped.append(joint)
    for joint, bone in bones.items():
        if joint not in truth["canonical"] and bone not in truth["acceptable_alternates"].get(joint, []):
            out.claimed.append(f"{joint} is {bone}")
    return out


@dataclass
class Tally:
    """True and false positives, and misses, of one capability."""

    hit: int = 0
    extra: int = 0
    missed: int = 0

    @property
    def f1(self) -> float:
        """Harmonic mean of precision and recall; 1 when there was nothing to find."""
        total = 2 * self.hit + self.extra + self.missed
        return 2 * self.hit / total if total else 1.0


def score_capabilities(of: Rig, found: Character, tallies: dict[str, Tally]) -> None:
    """Count a creature's capabilities against the truth."""
    truth = of.table["capabilities"]
    tagged: dict[str, set[str]] = {}
    for bone, own in found.capabilities.items():
        for capability in own:
            tagged.setdefault(capability.value, set()).add(of.original[bone])
    feet = [{leg["foot"], *leg["foot_acceptable"]} for leg in truth["legs"]]
    hits = sum(bool(tagged.get("foot", set()) & accepted) for accepted in feet)
    extra = sum(not any(bone in accepted for accepted in feet) for bone in tagged.get("foot", set()))
    _count(tallies, "foot", hits, extra, len(feet) - hits)
    expected = {
        "spine": set(truth["spine"]),
        "head": {truth["head"]} - {None},
        "tail": set(truth.get("tail") or []),
        "grasper": set(truth["graspers"]),
    }
    for capability, bones in expected.items():
        own = tagged.get(capability, set())
        _count(tallies, capability, len(bones & own), len(own - bones), len(bones - own))


def _count(tallies: dict[str, Tally], capability: str, hit: int, extra: int, missed: int) -> None:
    tally = tallies.setdefault(capability, Tally())
    tally.hit += hit
    tally.extra += extra
    tally.missed += missed
