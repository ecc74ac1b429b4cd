"""Binding: whether and how an action plays on a character, found once before it plays (Hecker 2008 §4.1)."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from .. import quat
from ..arrays import Array, Indices
from ..errors import listed
from . import movement
from .bodies import Bodies
from .branch import Branch
from .channels import Channel, MirrorRule, TargetKind
from .context import TIE, select_each
from .movement import Frames
from .variants import Group, variant_product

NONE = -1


@dataclass(frozen=True)
class GeneralizedAction:
    """What an animator authors besides curves: the channels, and which characters they are for."""

    name: str
    channels: tuple[Channel, ...]
    branch: Branch = field(default_factory=Branch)


@dataclass(frozen=True)
class Entry:
    """One body that one channel poses."""

    channel: int
    body: int
    mirrored: bool
    target: int
    """Body that is its target, NONE for an external target or none."""
    position: bool
    """Whether the channel has, or shares, the body's position."""
    rotation: bool


@dataclass(frozen=True, eq=False)
class Binding:
    """An action on a character, in one variant."""

    action: GeneralizedAction
    bodies: Bodies
    variants: tuple[tuple[int, ...], ...]
    """All ways in which it can play, each a body for every varying group; empty when nothing varies."""
    variant: int
    """The one that plays."""
    entries: tuple[Entry, ...]
    selected: tuple[tuple[int, ...], ...]
    """Bodies of each channel in this variant, whoever owns them."""
    problems: tuple[str, ...]
    """What the animator should know, in words."""

    @cached_property
    def plan(self) -> "Plan":
        """What evaluation needs of it, as arrays."""
        return Plan(self)

    def target_of(self, channel: Channel, body: int) -> int | None:
        """Return the body that a channel's body moves relative to, None where there is none."""
        found = _target(channel, body, self.action.channels, self.selected, self.bodies)
        return None if found == NONE else found

    def without_followers(self) -> "Binding":
        """Return the binding without what is posed relative to other bodies, as far as those depend on it."""
        return replace(self, entries=tuple(e for e in self.entries if e.target == NONE))

    def untargeted(self) -> "Binding":
        """Return the binding without what has a target of any kind."""
        channels = self.action.channels
        return replace(self, entries=tuple(e for e in self.entries if not channels[e.channel].has_target))


class Plan:
    """A binding as arrays: prepared once, evaluated often."""

    def __init__(self, binding: Binding) -> None:
        """Gather what `specialize` reads."""
        channels, entries = binding.action.channels, binding.entries
        own = [channels[e.channel] for e in entries]
        self.channel = np.array([e.channel for e in entries], dtype=np.intp)
        """Channel of each entry, shape (entry,)."""
        self.body = np.array([e.body for e in entries], dtype=np.intp)
        """Body of each entry."""
        self.target = np.array([e.target for e in entries], dtype=np.intp)
        """Body that is the target of each entry, NONE for external targets and none."""
        self.follows_bodies = bool((self.target != NONE).any())
        """Whether something is posed relative to other bodies, which have to be posed before it."""
        self.external = tuple(
            (i, e.channel)
            for i, (e, channel) in enumerate(zip(entries, own, strict=True))
            if channel.target is TargetKind.EXTERNAL and channel.has_target and (e.position or e.rotation)
        )
        """Entries with an external target, and their channels."""
        mirrored = np.array([e.mirrored for e in entries], dtype=bool)
        frames = movement.frames(binding.bodies, self.body, [c.movement for c in own], mirrored)
        away = quat.multiply(frames.base.rotations, quat.conjugate(binding.bodies.axes[self.body]))
        self.frames = replace(frames, base=movement.Base.of(away))
        """Frames of the entries while targets are straight ahead; they hold turns from rest, not orientations."""
        self.goals = np.array(sorted({e.body for e in entries}), dtype=np.intp)
        """Bodies that get a goal, shape (goal,)."""
        self.position_weights = np.array([c.position_weight for c in own])
        self.rotation_weights = np.array([c.rotation_weight for c in own])
        own_goal = np.array([e.body for e in entries], dtype=np.intp) == self.goals[:, None]
        self.places = (own_goal & np.array([e.position for e in entries], dtype=bool)).astype(np.float64)
        """1 where an entry has a share in the position of a goal, else 0, shape (goal, entry)."""
        self.turns = (own_goal & np.array([e.rotation for e in entries], dtype=bool)).astype(np.float64)
        """The same for rotations."""
        of_goal = {body: int(row.argmax()) for body, row in zip(self.goals.tolist(), self.turns, strict=True)}
        first = np.array([of_goal[e.body] for e in entries], dtype=np.intp)
        self.later: Indices = np.flatnonzero(first != np.arange(len(entries)))
        """Entries for bodies that others turn before them, shape (later,)."""
        self.first: Indices = first[self.later]
        """For each of these the first entry that turns its body."""
        self._last: tuple[bytes, Frames] | None = None

    def toward(self, targets: Array) -> Frames:
        """Return the frames turned toward targets [m], shape (frame, entry, 3).

        Those of a single frame are kept for the next one: most targets stand still while keys are edited.
        """
        if len(targets) > 1:
            return self.frames.toward(targets)
        told = targets.tobytes()
        if self._last is None or self._last[0] != told:
            self._last = told, self.frames.toward(targets)
        return self._last[1]


def bind(
    action: GeneralizedAction, bodies: Bodies, variant: int = 0, missing: Collection[int] = frozenset()
) -> Binding:
    """Return how an action plays on a character; what cannot play is left out and told in `Binding.problems`.

    Args:
        action: The action.
        bodies: Of the character.
        variant: Which way to play; counted round where there are fewer.
        missing: Channels whose external target is not there.
    """
    problems = [f"the action is not for this character: {why}" for why in action.branch.refusals(bodies)]
    if problems:
        empty = tuple(() for _ in action.channels)
        return Binding(action, bodies, (), 0, (), empty, tuple(problems))
    channels = action.channels
    found = [select_each(channel.context, bodies) for channel in channels]
    groups = _varying(channels)
    variants, leads = _variants(channels, groups, found, bodies, problems)
    variant %= max(len(variants), 1)
    chosen = dict(zip(leads, variants[variant], strict=True)) if variants else {}
    for lead, members in groups.items():
        leading = found[lead]
        for member in members:
            found[member] = _covary(leading, found[member], chosen[lead]) if lead in chosen else ()
    selected = [tuple(dict.fromkeys(body for _, body in pairs)) for pairs in found]
    unfit = {member for lead in leads if lead not in chosen for member in groups[lead]}
    idle = [repr(c.name) for i, c in enumerate(channels) if not selected[i] and i not in unfit]
    if idle:
        verb = "channels {} select" if len(idle) > 1 else "channel {} selects"
        problems.append(f"{verb.format(listed(idle))} nothing on this character: change the context if that is wrong")
    turned = _variant_is_mirrored(channels, selected, leads, bodies)
    playable = _playable(channels, selected, missing, problems)
    entries = list(_entries(channels, selected, playable, turned, bodies, problems))
    return Binding(action, bodies, tuple(variants), variant, tuple(entries), tuple(selected), tuple(problems))


def _varying(channels: Sequence[Channel]) -> dict[int, list[int]]:
    """Return the channels that vary together, by the first of each group."""
    out: dict[int, list[int]] = {}
    named: dict[str, int] = {}
    for i, channel in enumerate(channels):
        if channel.varies:
            lead = named.setdefault(channel.variant_group, i) if channel.variant_group else i
            out.setdefault(lead, []).append(i)
    return out


def _variants(
    channels: Sequence[Channel],
    groups: dict[int, list[int]],
    found: Sequence[tuple[tuple[int, int], ...]],
    bodies: Bodies,
    problems: list[str],
) -> tuple[list[tuple[int, ...]], list[int]]:
    """Return the variants, and the first channel of each group in them; groups that select nothing take no part."""
    leads = [lead for lead in groups if found[lead]]
    choices = [Group(tuple(body for body, _ in found[lead]), channels[lead].side) for lead in leads]
    variants = variant_product(choices, bodies.sides.tolist())
    if leads and not variants:
        names = listed([repr(channels[lead].name) for lead in leads])
        problems.append(f"channels {names} find no bodies that fit together: loosen their side constraints")
    return variants, leads


def _covary(
    leading: Sequence[tuple[int, int]], own: Sequence[tuple[int, int]], body: int
) -> tuple[tuple[int, int], ...]:
    """Return what a channel selects when its group chooses ``body``: the same, or the one in the same place."""
    same = [pair for pair in own if pair[0] == body]
    if same:
        return tuple(same)
    place = [pair[0] for pair in leading].index(body)
    return (own[place],) if len(own) == len(leading) else ()


def _variant_is_mirrored(
    channels: Sequence[Channel], selected: Sequence[tuple[int, ...]], leads: Sequence[int], bodies: Bodies
) -> bool:
    """Return whether the first varying channel that mirrors by side is mirrored."""
    for lead in leads:
        rule = channels[lead].mirror
        if rule in (MirrorRule.LEFT, MirrorRule.RIGHT) and selected[lead]:
            return _mirrored(rule, int(bodies.sides[selected[lead][0]]), turned=False)
    return False


def _mirrored(rule: MirrorRule, side: int, turned: bool) -> bool:
    if rule is MirrorRule.VARIANT:
        return turned
    return (rule is MirrorRule.LEFT and side < 0) or (rule is MirrorRule.RIGHT and side > 0)


def _playable(
    channels: Sequence[Channel],
    selected: Sequence[tuple[int, ...]],
    missing: Collection[int],
    problems: list[str],
) -> list[int]:
    """Return the channels that can play, in the order in which they take bodies."""
    out: list[int] = []
    for i, channel in enumerate(channels):
        if i in missing and channel.has_target:
            problems.append(f"channel {channel.name!r} has no target on this character: choose one")
        elif channel.movement.has_target and channel.target is TargetKind.NONE:
            problems.append(f"channel {channel.name!r} moves relative to a target and has none: choose its kind")
        elif selected[i]:
            out.append(i)
    return sorted(out, key=lambda i: -channels[i].priority)


def _entries(
    channels: Sequence[Channel],
    selected: Sequence[tuple[int, ...]],
    order: Sequence[int],
    turned: bool,
    bodies: Bodies,
    problems: list[str],
) -> list[Entry]:
    """Return who poses what. The first to select a body owns it, each degree of freedom for itself (§3.2.3)."""
    owners: dict[tuple[int, str], int] = {}
    out: list[Entry] = []
    for i in order:
        channel = channels[i]
        lost: list[str] = []
        for body in selected[i]:
            target = _target(channel, body, channels, selected, bodies)
            if target is None:
                problems.append(f"channel {channel.name!r} finds no target for {bodies.names[body]!r}")
                continue
            gets: dict[str, bool] = {}
            for what, wanted in (("position", channel.poses_position), ("rotation", channel.poses_rotation)):
                owner = channels[owners.setdefault((body, what), i)] if wanted else channel
                shares = owner is channel or bool(channel.blend_group and channel.blend_group == owner.blend_group)
                gets[what] = wanted and shares
                if wanted and not shares:
                    lost.append(f"the {what} of {bodies.names[body]!r} to {owner.name!r}")
            if not any(gets.values()):
                target = NONE  # only its deforms play
            mirrored = _mirrored(channel.mirror, int(bodies.sides[body]), turned)
            out.append(Entry(i, body, mirrored, target, gets["position"], gets["rotation"]))
        if lost:
            problems.append(
                f"channel {channel.name!r} loses {listed(lost, 3)}: give both the same blend group to share"
            )
    return out


def _target(
    channel: Channel, body: int, channels: Sequence[Channel], selected: Sequence[tuple[int, ...]], bodies: Bodies
) -> int | None:
    """Return the body that a channel's body moves relative to, NONE without, None where there should be one."""
    if not channel.has_target or channel.target is TargetKind.EXTERNAL:
        return NONE
    if channel.secondary is None:
        return None
    chosen = [
        own for c, own in zip(channels, selected, strict=True) if c.varies and c.context == channel.secondary and own
    ]
    found = chosen[0] if chosen else tuple(b for _, b in select_each(channel.secondary, bodies))
    others = [b for b in dict.fromkeys(found) if b != body]
    if not others:
        return None
    away = quat.length(bodies.positions[others] - bodies.positions[body])
    steps: list[float] = np.round(away / (TIE * bodies.size)).tolist()
    return min(zip(steps, [bodies.names[b] for b in others], others, strict=True))[2]
