"""Feet that do not step on each other: a foot that lands too near to one that stands is put down beside it."""

import numpy as np

from ... import quat
from ...arrays import Array
from ..moving import LEFT
from .contacts import Contacts
from .reaching import room
from .sizes import Sizes


def apart(places: Array, turned: Array, contacts: Contacts, sizes: Sizes) -> Array:
    """Return places of plants [m], shape (leg, cycle, 3), with room between the feet.

    Args:
        places: Where the feet would be put, likewise.
        turned: Of the body, for each plant, shape (leg, cycle, 4).
        contacts: When feet stand.
        sizes: Of the feet.
    """
    out, level = places.copy(), sizes.homes[:, None, :2] - sizes.homes[None, :, :2]
    least = room(quat.length(level), sizes.lengths[:, None])
    np.fill_diagonal(least, 0.0)
    legs = np.arange(len(sizes.lengths))
    for leg in legs.tolist():
        count = int(contacts.counts[leg])
        touch = contacts.touch[leg, :count]
        cycle = contacts.cycles(touch)
        others = places[legs, cycle]
        stands = (touch[:, None] > contacts.touch[legs, cycle]) & (touch[:, None] < contacts.lift[legs, cycle])
        away = places[leg, :count, None, :2] - others[..., :2]
        distance = quat.length(away)
        # Who would land right on another steps to its own side.
        aside = quat.rotate(turned[leg, :count], LEFT)[:, None, :2] * np.sign(level[leg, :, :1] + 1e-12)
        way = np.where((distance > 1e-6)[..., None], away / np.maximum(distance, 1e-12)[..., None], aside)
        missing = np.where(stands, np.maximum(least[leg] - distance, 0.0), 0.0)
        out[leg, :count, :2] += (missing[..., None] * way).sum(axis=1)
    return out
