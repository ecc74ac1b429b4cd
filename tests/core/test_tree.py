"""Ways through a tree of bones."""

import numpy as np

from morph_retarget.core.tree import Tree

#     0        6
#    / \
#   1   4
#  / \   \
# 2   3   5
TREE = Tree(np.array([-1, 0, 1, 1, 0, 4, -1]))


def test_children_and_ancestors() -> None:
    assert TREE.children[1] == [2, 3]
    assert TREE.ancestors[5] == [4, 0]
    assert TREE.roots == [0, 6]
    assert TREE.below(0) == [1, 2, 3, 4, 5]
    assert TREE.is_below(0, 5)
    assert not TREE.is_below(5, 5)


def test_parents_come_before_children_in_any_numbering() -> None:
    tree = Tree(np.array([2, 0, -1, 1]))
    assert tree.order == [2, 0, 1, 3]
    assert [level.tolist() for level in tree.levels] == [[2], [0], [1], [3]]


def test_paths_lead_down_and_are_empty_across() -> None:
    assert TREE.path(0, 3) == [0, 1, 3]
    assert TREE.path_between(0, 3) == [1]
    assert TREE.path(1, 5) == []
    assert TREE.path(3, 3) == [3]


def test_ways_lead_over_the_meeting() -> None:
    assert TREE.meeting([2, 3]) == 1
    assert TREE.meeting([2, 5]) == 0
    assert TREE.meeting([2, 6]) is None
    assert TREE.way(2, 5) == [2, 1, 0, 4, 5]
    assert TREE.way(2, 6) == []
    assert TREE.top_of(2, beside=5) == 1
