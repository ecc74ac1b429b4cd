"""Reading bone names: words, side and numbers, whatever the convention, language or script.

Beyond Feng 2013 §3, which searches for keywords: namespaces and prefixes shared by the whole rig are dropped,
camel case, separators and digits split, and words that run together ("lfemur", "左足首", "rhipjoint") are taken apart
with the table of words.
"""

import re
import unicodedata
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from .words import SENSES, Sense

_LONGEST_WORD = max(map(len, SENSES))
_SIDE_LETTERS = {"l": Sense.LEFT, "r": Sense.RIGHT}
_CHUNKS = re.compile(
    r"[0-9]+"
    r"|[A-Z]+(?![a-z])"  # acronyms: IK, FK, the side letter in L_Hand
    r"|[A-Z]?[a-z]+"
    r"|[^\W\d_A-Za-z]+"  # letters of any other script
)
_LIMBS = (
    Sense.ARM, Sense.UPPER_ARM, Sense.LOWER_ARM, Sense.ELBOW, Sense.WRIST, Sense.HAND, Sense.LEG, Sense.UPPER_LEG,
    Sense.LOWER_LEG, Sense.KNEE, Sense.ANKLE, Sense.FOOT, Sense.PAW,
)  # fmt: skip
_FOR_CONTROLS = {Sense.CONTROL, Sense.MECHANISM}
# A capital side letter glued to a capitalised word: LEye, RHipJoint, MJaw.
_GLUED_CAPITAL = re.compile(r"(?<![A-Za-z])([LR])(?=[A-Z][a-z])")


@dataclass(frozen=True)
class Reading:
    """What one bone name says."""

    words: tuple[str, ...]
    senses: frozenset[Sense]
    side: int
    """+1 left, -1 right, 0 when the name does not say."""
    numbers: tuple[str, ...]
    """Digit groups as written: ``("01", "2")``."""
    known: bool
    """Whether any word has a meaning beyond noise and sides."""

    def has(self, *senses: Sense) -> bool:
        """Return whether any of ``senses`` is among the meanings."""
        return any(s in self.senses for s in senses)


def fold(text: str) -> str:
    """Return ``text`` in the form in which `words.SENSES` is written: narrow forms, lower case, no Latin accents."""
    text = unicodedata.normalize("NFKC", text).replace("ł", "l").replace("Ł", "L")
    out: list[str] = []
    for char in text:
        plain = unicodedata.normalize("NFD", char)
        # Only Latin letters lose their marks: in Japanese or Cyrillic a mark makes another letter.
        out.append(plain[0] if plain[0].isascii() else char)
    return "".join(out).casefold()


def _pieces(name: str) -> list[str]:
    """Return the raw words and digit groups of ``name``, case already folded, namespace removed."""
    name = unicodedata.normalize("NFKC", name)
    # A namespace ends in a colon or a pipe; Maya may stack several.
    name = re.split(r"[:|]", name)[-1] or name
    name = "".join(
        unicodedata.normalize("NFD", c)[0] if unicodedata.normalize("NFD", c)[0].isascii() else c for c in name
    )
    name = _GLUED_CAPITAL.sub(r"\1 ", name)
    return [fold(piece) for piece in _CHUNKS.findall(name)]


@lru_cache(maxsize=4096)
def _split_known(word: str) -> tuple[str, ...] | None:
    """Return ``word`` taken apart into known words (fewest first), or None.

    A side letter may stand at either end when what remains is known.
    """
    best: list[tuple[str, ...] | None] = [None] * (len(word) + 1)
    best[0] = ()
    for end in range(1, len(word) + 1):
        for start in range(max(0, end - _LONGEST_WORD), end):
            left, part = best[start], word[start:end]
            # Short Latin scraps ("el", "pe") are words only when they stand alone.
            if left is None or part not in SENSES or (len(part) < 3 and part.isascii()):
                continue
            if best[end] is None or len(left) + 1 < len(best[end] or ()):
                best[end] = (*left, part)
    if best[-1] is not None:
        return best[-1]
    if len(word) > 3:
        for side, rest in ((word[0], word[1:]), (word[-1], word[:-1])):
            if side in _SIDE_LETTERS and word.isascii():
                inner = (rest,) if rest in SENSES else _split_known(rest) if len(rest) > 3 else None
                if inner is not None:
                    return (side, *inner)
    return None


def _words(piece: str) -> tuple[str, ...]:
    if piece in SENSES or piece.isdigit() or piece in _SIDE_LETTERS:
        return (piece,)
    if len(piece) > 3 and piece.endswith("s") and piece[:-1] in SENSES:
        return (piece[:-1],)
    return _split_known(piece) or (piece,)


def _drop_common_prefix(split: list[list[str]]) -> list[list[str]]:
    """Remove leading words that nearly every bone of the rig shares: ``Bip01``, ``CC Base``, a character's name."""
    for _ in range(4):
        first = Counter(words[0] for words in split if len(words) > 1)
        if not first:
            return split
        word, count = first.most_common(1)[0]
        # A prefix that means something ("tail" on a snake) is no prefix.
        empty = word not in _SIDE_LETTERS and set(SENSES.get(word, ())) <= {Sense.NOISE, Sense.ROOT}
        if count < 0.7 * len(split) or len(split) < 6 or not empty:
            return split
        split = [words[1:] if len(words) > 1 and words[0] == word else words for words in split]
    return split


def _drop_running_number(split: list[list[str]]) -> list[list[str]]:
    """Remove a trailing number that merely counts the bones of the file (``b_LeftLeg01_015``)."""
    last = [words[-1] for words in split if len(words) > 1 and words[-1].isdigit()]
    if len(split) >= 6 and len(last) > 0.8 * len(split) and len({int(n) for n in last}) > 0.9 * len(last):
        return [words[:-1] if len(words) > 1 and words[-1].isdigit() else words for words in split]
    return split


def _corners(rear: str, row_first: bool) -> dict[str, tuple[str, str]]:
    """Return the codes of four legs and what they mean, with a letter for the rear ones."""
    letters = {"front": "f", "rear": rear}
    return {
        letters[row] + side[0] if row_first else side[0] + letters[row]: (side, row)
        for side in ("left", "right")
        for row in letters
    }


_CORNERS = [_corners(rear, row_first) for rear in "rhb" for row_first in (False, True)]
"""lf rf lr rr, fl fr rl rr, lf rf lh rh, …"""


def _spell_corners(split: list[list[str]]) -> list[list[str]]:
    """Write out two-letter codes for the four legs of a rig that has all of them: ``lf`` is left front."""
    here = {word for words in split for word in words}
    spelt = {code: words for corners in _CORNERS if here >= corners.keys() for code, words in corners.items()}
    return [[part for word in words for part in spelt.get(word, (word,))] for words in split] if spelt else split


def _drop_idle_controls(split: list[list[str]]) -> list[list[str]]:
    """Remove words for controls that most limbs of a rig bear (``CTRL_FK_Femur.L``): no other bones are its limbs.

    A name keeps them when another bone has the same name without them: that one is the limb.
    """
    limbs = [set(words) for words in split if any(sense in _LIMBS for word in words for sense in SENSES.get(word, ()))]
    borne = Counter(word for words in limbs for word in words if set(SENSES.get(word, ())) & _FOR_CONTROLS)
    idle = {word for word, count in borne.items() if len(limbs) >= 8 and count > 0.6 * len(limbs)}
    if not idle:
        return split
    plain = [[word for word in words if word not in idle] for words in split]
    taken = Counter(tuple(words) for words in plain)
    return [short if short and taken[tuple(short)] == 1 else words for short, words in zip(plain, split, strict=True)]


def _reading(words: list[str]) -> Reading:
    senses: set[Sense] = set()
    side = 0
    if words and words[-1] in _SIDE_LETTERS:
        # Letters before that are part of some other code: "r_toe.L" is a rear one on the left.
        words = [*(word for word in words[:-1] if word not in _SIDE_LETTERS), words[-1]]
    for word in words:
        found = SENSES.get(word, ())
        if word in _SIDE_LETTERS:
            found = (_SIDE_LETTERS[word],)
        for sense in found:
            if sense in (Sense.LEFT, Sense.RIGHT):
                side = side or (1 if sense is Sense.LEFT else -1)
            else:
                senses.add(sense)
    numbers = tuple(w for w in words if w.isdigit())
    known = bool(senses - {Sense.NOISE, Sense.CENTER, Sense.BIG, Sense.UPPER, Sense.LOWER})
    return Reading(tuple(words), frozenset(senses), side, numbers, known)


def read_names(names: Sequence[str]) -> tuple[Reading, ...]:
    """Read all bone names of one rig together (prefixes and numbering are habits of the whole rig).

    Returns:
        One `Reading` per name, in order.
    """
    return _read(tuple(names))


@lru_cache(maxsize=64)  # rigs whose characters are at work; all that plays on one asks again
def _read(names: tuple[str, ...]) -> tuple[Reading, ...]:
    split = [[w for piece in _pieces(name) for w in _words(piece)] for name in names]
    split = _drop_running_number(_drop_common_prefix(_drop_running_number(split)))
    split = _drop_idle_controls(_spell_corners(split))
    readings = [_reading(words) for words in split]
    # One-sided side letters are part of some other code ("R_Rig_Spine"): a body has both sides.
    sides = Counter(r.side for r in readings if r.side)
    if min(sides.get(1, 0), sides.get(-1, 0)) == 0 and sum(sides.values()) > 3:
        readings = [Reading(r.words, r.senses, 0, r.numbers, r.known) for r in readings]
    return tuple(readings)
