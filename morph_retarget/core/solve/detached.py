"""Feet and hands that do not hang on their limbs: where inverse kinematics was baked, they hang on the root bone.

Such a body is solved as if its limb carried it, so it has all that other feet and hands have. What is special is how
it is written: moved as well as turned, since what it really hangs on does not bring it there. The same goes for thighs
that hang beside the hips, on what carries these, and for the half of a body whose other half is a tree of its own.
"""

from collections.abc import Collection
from itertools import pairwise

from ..character.character import Character
from ..tree import Tree

GAP = 0.01
"""Share of a limb's length by which such a body leaves the end of its limb for a goal: a little more than limbs slow
down by within their own lengths. Where these end, it stays with its limb, which must not fall apart."""
KNEED = 3
"""Bones of a leg that has a knee, its foot among them."""


def carried(character: Character, root: int, fixed: Collection[int] = ()) -> Tree:
    """Return what carries which body when it is solved: parents do, limbs their feet and hands, and the root its legs.

    Args:
        character: What the rig is.
        root: The body that carries all others; it stays where it hangs, and so do those above it.
        fixed: Bodies whose joints cannot move off where their parents hold them.
    """
    tree = character.skeleton.tree
    out = _with_halves(character, tree, root, fixed)
    bones = {bone for limb in character.limbs for bone in limb.bones}
    stays = {root, *tree.ancestors[root], *fixed}
    for limb in character.limbs:
        for above, bone in pairwise(limb.bones):
            # What hangs on a limb is carried by it, even by another one.
            is_free = bone not in stays and bones.isdisjoint(tree.ancestors[bone])
            if is_free and not out.is_below(bone, above):
                # A paw that hangs on nothing but controls, as a wolf's, goes with all of them, which skins hold on to:
                # up to those that carry the limb as well, which would else hang on themselves.
                top = out.top_of(bone, above)
                line = [bone, *out.ancestors[bone]]
                parents = out.parents.copy()
                parents[bone if stays & {*line[: line.index(top) + 1]} else top] = above
                out = Tree(parents)
    return _with_legs(character, out, root, stays)


def _with_halves(character: Character, tree: Tree, root: int, fixed: Collection[int]) -> Tree:
    """Return the tree with what has other bones of the middle hung on those before them, all of it with the root."""
    middle = [*character.spine, *character.neck, *([] if character.head is None else [character.head])]
    before = root
    for body in middle:
        line = [body, *tree.ancestors[body]]
        if root in line or body in tree.ancestors[root]:
            before = body if root in line else before
        elif tree.parents[line[-1]] < 0 and line[-1] not in {*tree.ancestors[root], *fixed}:
            parents = tree.parents.copy()
            parents[line[-1]] = before
            tree, before = Tree(parents), body
    return tree


def _with_legs(character: Character, tree: Tree, root: int, stays: Collection[int]) -> Tree:
    """Return the tree with legs that hang beside the root, on what carries it, hung on it: hips take thighs along.

    Legs without knees stay where they are: nothing could make up for what the hips do.
    """
    above = {*tree.ancestors[root]}
    for leg in character.legs:
        first = leg.bones[0]
        is_carried = first == root or tree.is_below(root, first)
        if is_carried or len(leg.bones) < KNEED or above.isdisjoint(tree.ancestors[first]):
            continue
        top = next(b for b in (first, *tree.ancestors[first]) if tree.parents[b] in above)
        if not {top, first} & {*stays}:
            parents = tree.parents.copy()
            parents[top] = root
            tree = Tree(parents)
    return tree
