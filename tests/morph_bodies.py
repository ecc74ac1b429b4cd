"""Characters as bare bodies, for tests of contexts, movement modes and binding; and the real rigs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from morph_retarget.core import quat
from morph_retarget.core.arrays import Array
from morph_retarget.core.character.character import Character
from morph_retarget.core.character.morphology import Capability
from morph_retarget.core.morph.bodies import Bodies
from tests import truth

MIRROR = np.array([-1.0, 1.0, 1.0])
"""Takes a point to its mirror image."""
MIRROR_TURN = np.array([1.0, 1.0, -1.0, -1.0])
"""Takes a rotation to its mirror image."""
CAPABILITIES = tuple(Capability)
UNLIKE = (
    *("cesium_man", "daz_genesis8", "kaykit_adventurer", "makehuman_default", "quaternius_cyberpunk_ikfeet"),
    *("rokoko_mixamo_preset_bvh", "secondlife_bento", "sketchbook_boxman", "unreal_ue5_manny"),
    *("khronos_fox", "m2m_bird", "m2m_kaiju", "m2m_snake", "m2m_spider", "quaternius_bee", "quaternius_frog"),
    *("quaternius_trex", "rigify_cat"),
)
"""Real rigs from few bones to many: with twists, faces, wings, tails, many legs, none, and feet that hang elsewhere."""


@dataclass(frozen=True)
class Body:
    """One body of a character written down by hand."""

    name: str
    place: tuple[float, float, float]
    capabilities: tuple[Capability, ...] = ()
    parent: str | None = None


def bodies_of(rows: Sequence[Body], low: Sequence[float] | None = None, high: Sequence[float] | None = None) -> Bodies:
    """Return bodies with the character's own axes; bounds are those of the bodies unless given."""
    number = {row.name: i for i, row in enumerate(rows)}
    places = np.array([row.place for row in rows], dtype=np.float64)
    return Bodies(
        tuple(number),
        np.array([-1 if row.parent is None else number[row.parent] for row in rows], dtype=np.intp),
        places,
        quat.identity(len(rows)),
        [frozenset(row.capabilities) for row in rows],
        places.min(axis=0) if low is None else np.array(low, dtype=np.float64),
        places.max(axis=0) if high is None else np.array(high, dtype=np.float64),
    )


def names_of(bodies: Bodies, chosen: Sequence[int]) -> list[str]:
    """Return the names of some bodies."""
    return [bodies.names[body] for body in chosen]


def random_bodies(rng: np.random.Generator, count: int = 12) -> Bodies:
    """Return a character that no player would build: any tree, any places above the ground, any axes."""
    places = rng.uniform([-1.0, -1.5, 0.0], [1.0, 1.5, 2.0], (count, 3)) * 10.0 ** rng.uniform(-2.0, 2.0)
    parents = np.array([-1, *(rng.integers(i) for i in range(1, count))], dtype=np.intp)
    tags = [frozenset(c for c in CAPABILITIES if rng.random() < 0.25) for _ in range(count)]
    tags[0] |= {Capability.ROOT, Capability.SPINE}
    names = tuple(f"body {i}" for i in range(count))
    axes = quat.normalize(rng.normal(size=(count, 4)))
    return Bodies(names, parents, places, axes, tags, places.min(axis=0), places.max(axis=0))


def symmetric_bodies(rng: np.random.Generator, pairs: int = 5) -> tuple[Bodies, Array]:
    """Return a character whose bodies are a root and pairs of mirror images, and the partner of each body."""
    half = random_bodies(rng, pairs + 1)
    left = np.arange(1, pairs + 1)
    places = half.positions * np.where(np.arange(pairs + 1)[:, None] == 0, [0.0, 1.0, 1.0], 1.0)
    axes = half.axes.copy()
    axes[0] = quat.IDENTITY
    above = half.parents[left]
    positions = np.concatenate([places, places[left] * MIRROR])
    partner = np.concatenate([[0], left + pairs, left])
    return (
        Bodies(
            (*half.names, *(f"{half.names[b]} mirrored" for b in left)),
            np.concatenate([half.parents, np.where(above == 0, 0, above + pairs)]),
            positions,
            np.concatenate([axes, axes[left] * MIRROR_TURN]),
            [*half.capabilities, *(half.capabilities[b] for b in left)],
            positions.min(axis=0),
            positions.max(axis=0),
        ),
        partner,
    )


def mirrored(bodies: Bodies) -> Bodies:
    """Return the character's mirror image."""
    return replace(
        bodies,
        positions=bodies.positions * MIRROR,
        axes=bodies.axes * MIRROR_TURN,
        low=np.array([-bodies.high[0], *bodies.low[1:]]),
        high=np.array([-bodies.low[0], *bodies.high[1:]]),
    )


def shuffled(bodies: Bodies, rng: np.random.Generator) -> Bodies:
    """Return the same character with its bodies in another order; parents still stand before their children."""
    order = list(bodies.tree.roots)
    waiting = [child for root in order for child in bodies.tree.children[root]]
    while waiting:
        body = waiting.pop(int(rng.integers(len(waiting))))
        order.append(body)
        waiting.extend(bodies.tree.children[body])
    place = {body: i for i, body in enumerate(order)}
    return replace(
        bodies,
        names=tuple(bodies.names[b] for b in order),
        parents=np.array([place.get(int(bodies.parents[b]), -1) for b in order], dtype=np.intp),
        positions=bodies.positions[order],
        axes=bodies.axes[order],
        capabilities=[bodies.capabilities[b] for b in order],
    )


@cache
def real_characters(data: Path) -> Mapping[str, Character]:
    """Return all real rigs by name, analysed."""
    return {str(table["id"]): truth.find(truth.rig(data, table)) for table in truth.tables(data)}


def unlike_characters(data: Path) -> Mapping[str, Character]:
    """Return those of the real rigs that differ in kind, for laws of the solver, to which the others are alike."""
    return {name: character for name, character in real_characters(data).items() if name in UNLIKE}


@cache
def real_bodies(data: Path) -> Mapping[str, Bodies]:
    """Return the bodies of all real rigs by name."""
    return {name: Bodies.of(character) for name, character in real_characters(data).items()}
