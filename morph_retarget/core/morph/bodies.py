"""Bodies: what selecting and posing need to know about the bones of one character, in its character frame.

The paper's players build a character of bodies with a place, an orientation and capabilities (Hecker 2008 §1.2). A
bone's own axes mean nothing on imported rigs, so a body gets axes of its own here, by what it is: a hand's forward
is where its fingers point, a foot's where its toes point, a head's where its eyes look.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..character.character import Character
from ..character.morphology import Capability, LimbKind
from ..solve import detached
from ..tree import Tree

LEFT: Array = np.array([1.0, 0.0, 0.0])
FORWARD: Array = np.array([0.0, -1.0, 0.0])
UP: Array = np.array([0.0, 0.0, 1.0])

MIDDLE = 0.02
"""A body nearer to the plane of symmetry than this share of the character's size is on neither side."""
THINNEST = 0.1
"""No extent of a character counts for less than this share of its largest, lest flat bodies cannot be scaled by."""
SHORTEST = 0.05
"""No limb counts for shorter than this share of the character's size; bodies of the spine have no limb at all."""
ASKEW = 0.3
"""A head looks where its eyes and mouth are if they lie to its side by this share of their distance, else ahead."""

_TRUNK = {
    Capability.ROOT,
    Capability.SPINE,
    Capability.NECK,
    Capability.HEAD,
    Capability.MOUTH,
    Capability.EYE,
    Capability.EAR,
}


@dataclass(frozen=True, eq=False)
class Bodies:
    """The bodies of one character at rest; parents stand before their children."""

    names: tuple[str, ...]
    parents: Indices
    """Body that each hangs on, -1 for roots, shape (body,)."""
    positions: Array
    """Rest positions of the joints [m], shape (body, 3)."""
    axes: Array
    """Rest orientation of each body's own axes (-Y forward, +Z up), shape (body, 4)."""
    capabilities: Sequence[frozenset[Capability]]
    """What each body can do."""
    low: Array
    """Least corner of the character's bounds [m], shape (3,)."""
    high: Array
    """Greatest corner, shape (3,)."""
    carriers: Indices | None = None
    """Body that carries each when it is posed, shape (body,): its parent, but for feet and hands that hang elsewhere
    the end of their limb. None where it is the parent for all."""

    def __len__(self) -> int:
        return len(self.names)

    @classmethod
    def of(cls, character: Character) -> "Bodies":
        """Return the bodies of an analysed rig."""
        skeleton, place = character.skeleton, character.local_to_character
        heads, tails = place.points(skeleton.rest_positions), place.points(skeleton.rest_tails)
        children = skeleton.tree.children
        ends = tails[[bone for bone in range(len(skeleton)) if not children[bone]]]
        points = np.concatenate([heads, ends])
        tags = _tags(character)
        ahead = np.array([_ahead(bone, heads, children[bone], skeleton.parents, tags) for bone in range(len(skeleton))])
        low, high = points.min(axis=0), points.max(axis=0)
        size = float(np.linalg.norm(high - low))
        axes = _axes(heads, ahead, tags, _usual(character, heads, size), skeleton.tree, size)
        root = next(body for body, own in enumerate(tags) if Capability.ROOT in own)
        carriers = detached.carried(character, root).parents
        return cls(skeleton.names, skeleton.parents, heads, axes, tags, low, high, carriers)

    @cached_property
    def tree(self) -> Tree:
        """Who hangs on whom."""
        return Tree(self.parents)

    @cached_property
    def limb_tree(self) -> Tree:
        """Who carries whom."""
        return self.tree if self.carriers is None else Tree(self.carriers)

    @cached_property
    def size(self) -> float:
        """Diagonal of the bounds [m]."""
        return float(np.linalg.norm(self.high - self.low))

    @cached_property
    def extents(self) -> Array:
        """Size along left, back and up [m], what CreatureSize scales by, shape (3,); see `THINNEST`."""
        extents = self.high - self.low
        return np.maximum(extents, THINNEST * extents.max())

    @cached_property
    def forwards(self) -> Array:
        """Where each body looks or points at rest, unit vectors, shape (body, 3)."""
        return quat.rotate(self.axes, FORWARD)

    @cached_property
    def sides(self) -> Indices:
        """+1 left, -1 right, 0 in the middle, shape (body,)."""
        x = self.positions[:, 0]
        return np.where(np.abs(x) < MIDDLE * self.size, 0, np.sign(x)).astype(np.intp)

    @cached_property
    def spine_segments(self) -> Indices:
        """The nearest body of the spine, from each body upward (itself included), shape (body,).

        Where legs hang beside the hips, on what carries these, it is the hips. Without any spine it is the body's root.
        """
        tree, out = self.limb_tree, np.empty(len(self), dtype=np.intp)
        nearest_last = sorted(self.with_capability(Capability.SPINE), key=lambda b: -len(tree.ancestors[b]))
        carried = {above: segment for segment in nearest_last for above in tree.ancestors[segment]}
        for body in range(len(self)):
            line = [body, *tree.ancestors[body]]
            above = next((b for b in line if self.has(b, Capability.SPINE)), None)
            beside = next((carried[b] for b in line if b in carried), line[-1])
            out[body] = beside if above is None else above
        return out

    @cached_property
    def limb_lengths(self) -> Array:
        """Length of the path to the nearest spine segment [m], shape (body,); see `SHORTEST`. Hecker 2008 §3.2.2."""
        tree, out = self.limb_tree, np.zeros(len(self))
        for body in tree.order:
            parent, segment = int(tree.parents[body]), int(self.spine_segments[body])
            if body == segment or tree.is_below(body, segment):
                continue  # it carries the spine
            start = segment if tree.is_below(parent, segment) else parent
            out[body] = out[start] + np.linalg.norm(self.positions[body] - self.positions[start])
        return np.maximum(out, SHORTEST * self.size)

    def has(self, body: int, capability: Capability) -> bool:
        """Return whether a body has a capability."""
        return capability in self.capabilities[body]

    def with_capability(self, capability: Capability) -> list[int]:
        """Return all bodies that have a capability, in their own order."""
        return [body for body, own in enumerate(self.capabilities) if capability in own]


def _tags(character: Character) -> list[frozenset[Capability]]:
    """Return the capabilities of all bones, with the one root body as a segment of the spine (Hecker 2008 §1.2).

    Rigs often have bones above the hips that only carry them; the body's root is the first that is of the body.
    """
    skeleton = character.skeleton
    tags = [frozenset(character.capabilities.get(name, ())) for name in skeleton.names]
    root = _root(character, tags)
    tags = [own - {Capability.ROOT} for own in tags]
    tags[root] |= {Capability.ROOT} if Capability.HEAD in tags[root] else {Capability.ROOT, Capability.SPINE}
    return tags


def _root(character: Character, tags: Sequence[frozenset[Capability]]) -> int:
    """Return the root body: the hips of what has legs, else the topmost bone that is of the body at all."""
    hips, tree = character.bone("hips"), character.skeleton.tree
    if hips is not None and character.legs:
        return hips
    of_body = [bone for bone, own in enumerate(tags) if own - {Capability.ROOT}]
    return min(of_body or tree.roots, key=lambda bone: len(tree.ancestors[bone]))


def _ahead(
    bone: int, heads: Array, children: Sequence[int], parents: Indices, tags: Sequence[frozenset[Capability]]
) -> Array:
    """Return the way along a bone; where nothing hangs on it, tails are guesses, so it goes on as its parent comes."""
    if children:
        return heads[list(children)].mean(axis=0) - heads[bone]
    if Capability.FOOT in tags[bone] or parents[bone] < 0:
        return FORWARD
    return heads[bone] - heads[parents[bone]]


def _usual(character: Character, heads: Array, size: float) -> Array:
    """Return the direction that each body points in when its character stands with its arms out, shape (body, 3)."""
    usual = np.tile(FORWARD, (len(heads), 1))
    for limb in character.limbs:
        lateral = np.sign(heads[limb.end, 0]) * LEFT if abs(heads[limb.end, 0]) > MIDDLE * size else FORWARD
        line = [*limb.bones, *limb.digits]
        usual[line] = -UP if limb.kind is LimbKind.LEG else lateral
        if limb.kind is LimbKind.LEG:
            usual[[limb.end, *limb.digits]] = FORWARD
    usual[[bone for tail in character.tails for bone in tail]] = -FORWARD
    return usual


def _axes(
    heads: Array, ahead: Array, tags: Sequence[frozenset[Capability]], usual: Array, tree: Tree, size: float
) -> Array:
    """Return every body's own axes at rest, shape (body, 4)."""
    trunk = np.array([bool(own & _TRUNK) for own in tags])
    ahead = np.where(trunk[:, None], FORWARD, ahead)
    for head in [body for body, own in enumerate(tags) if Capability.HEAD in own]:
        face = [b for b in tree.below(head) if tags[b] & {Capability.EYE, Capability.MOUTH}]
        away = heads[face].mean(axis=0) - heads[head] if face else FORWARD
        if abs(away[0]) > ASKEW * float(np.linalg.norm(away)):
            ahead[[head, *face]] = away * np.array([1.0, 1.0, 0.0])
    short = quat.length(ahead) < 1e-6 * size
    ahead = np.where(short[:, None], usual, ahead)
    base = np.where(trunk[:, None], quat.IDENTITY, quat.between(FORWARD, usual))
    back = (usual[:, 1] > 0.5) & ~trunk
    base[back] = (0.0, 0.0, 0.0, 1.0)  # a tail is turned about the vertical, not upside down
    return quat.multiply(quat.between(np.where(trunk[:, None], FORWARD, usual), quat.unit(ahead)), base)
