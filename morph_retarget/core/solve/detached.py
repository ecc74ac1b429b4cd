"""Feet and hands that do not hang on their limbs: where inverse kinematics was baked, they hang on the root bone.

Such a body is solved as if its limb carried it, so it has all that other feet and hands have. What is special is how
it is written: moved as well as turned, since what it really hangs on does not bring it there.
"""

from collections.abc import Collection
from itertools import pairwise

from ..character.character import Character
from ..tree import Tree

GAP = 0.01
"""Share of a limb's length by which such a body leaves the end of its limb for a goal: a little more than limbs slow
down by within their own lengths. Where these end, it stays with its limb, which must not fall apart."""


def carried(character: Character, root: int, fixed: Collection[int] = ()) -> Tree:
    """Return what carries which body when it is solved: parents do, and limbs carry their feet and hands.

    Args:
        character: What the rig is.
        root: The body that carries all others; it stays where it hangs, and so do those above it.
        fixed: Bodies whose joints cannot move off where their parents hold them.
    """
    out = tree = character.skeleton.tree
    bones = {bone for limb in character.limbs for bone in limb.bones}
    stays = {root, *tree.ancestors[root], *fixed}
    for limb in character.limbs:
        for above, bone in pairwise(limb.bones):
            # What hangs on a limb is carried by it, even by another one.
            is_free = bone not in stays and bones.isdisjoint(tree.ancestors[bone])
            if is_free and not out.is_below(bone, above):
                # A paw that hangs on nothing but controls, as a wolf's, goes with all of them, which skins hold on to.
                line = [bone, *tree.ancestors[bone]]
                parents = out.parents.copy()
                parents[bone if stays & {*line} else line[-1]] = above
                out = Tree(parents)
    return out
