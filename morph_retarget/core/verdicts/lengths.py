"""Whether bones keep their lengths."""

import numpy as np

from .. import quat
from .performance import Performance
from .verdict import Found


def changed(performance: Performance) -> Found:
    """Return by how much a bone gets longer or shorter than it may [shares of the character's size].

    Measured from what carries a body to the body, so that a leg which falls apart shows as well.
    """
    parents = performance.hierarchy.tree.parents
    own = np.array([body for body in performance.body.tolist() if body != performance.root], dtype=np.intp)
    if not len(own):
        return Found(0.0)
    above = parents[own]
    now = quat.length(performance.places[:, own] - performance.places[:, above])
    rest = quat.length(performance.rest[own] - performance.rest[above])
    slack = np.array([performance.slack.get(int(body), 0.0) for body in own])
    over = np.abs(now - rest) - slack
    return Found.worst(np.maximum(over, 0.0) / performance.size, [performance.names[int(body)] for body in own])
