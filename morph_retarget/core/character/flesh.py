"""What of a rig is the body: not hair, clothes, props and controls, and not what only carries it."""

import numpy as np

from ..arrays import Indices
from ..tree import Tree
from .character import Character
from .joint_names import is_thing
from .morphology import Capability
from .names import read_names


def body(character: Character, tree: Tree, root: int) -> Indices:
    """Return the root and all of the body that it carries, shape (n,).

    Hair, clothes, props and controls, as their names say it, are none of the body unless they carry some of it.

    Args:
        character: What the rig is.
        tree: What carries what.
        root: What carries all of the body.
    """
    known = {root, *_known(character)}
    known |= {above for bone in known for above in tree.ancestors[bone]}
    readings = enumerate(read_names(character.skeleton.names))
    things = {bone for bone, reading in readings if bone not in known and is_thing(reading)}
    own = [b for b in tree.below(root) if things.isdisjoint((b, *tree.ancestors[b]))]
    return np.array([root, *own], dtype=np.intp)


def flesh(character: Character, tree: Tree, root: int) -> Indices:
    """Return the same without what only carries the body, as bones on the ground between the feet do, shape (n,)."""
    index = character.skeleton.index
    parts = {index[name] for name, tags in character.capabilities.items() if {*tags} - {Capability.ROOT}}
    parts |= {index[match.bone] for match in character.joints.values()}
    own: list[int] = body(character, tree, root).tolist()
    kept = [bone for bone in own if not parts.isdisjoint((bone, *tree.ancestors[bone]))]
    return np.array(kept or own, dtype=np.intp)


def _known(character: Character) -> set[int]:
    """Return the bones that are a joint or can do something."""
    index = character.skeleton.index
    return {index[match.bone] for match in character.joints.values()} | {index[name] for name in character.capabilities}
