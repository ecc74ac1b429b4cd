"""What fuzz tests share: a corpus of small files, ways to spoil them, and how many examples are tried.

``MORPH_RETARGET_FUZZ=5000`` tries so many examples of each law, other ones every time; without it, few and always the
same. What was found is kept in ``tests/corpus`` and tried every time.
"""

import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import hypothesis
from hypothesis import HealthCheck
from hypothesis import strategies as st

from morph_retarget.core.errors import MorphError

CORPUS = Path(__file__).resolve().parent / "corpus"
EXAMPLES = int(os.environ.get("MORPH_RETARGET_FUZZ", "0"))
"""Of each law; 0 for the few of the test suite."""
_NASTY = (
    b"", b"\x00", b"\xff", b"\n", b"\r", b'"', b"'", b"\\", b"[", b"]", b"{", b"}", b"<", b">", b"&", b"=", b",", b":",
    b"-", b".", b"/", b"../", b"#", b"*", b"%s", b"{0}", b"{action}", b"nan", b"inf", b"-1", b"0", b"1e999", b"9" * 400,
    b"true", b"null", b"[[", b"]]", b'"""', b"\xc3\xa9", b"\xed\xb3\xbf", b"\xe2\x80\xae", b"\xf0\x9f\x98\x80", b" ",
)  # fmt: skip
"""What is put into files to spoil them."""
_T = TypeVar("_T")


def fuzzed(few: int) -> Callable[[_T], _T]:
    """Return a decorator for laws that spoilt input is put to; ``few`` is the number of examples in the suite."""
    return hypothesis.settings(
        max_examples=EXAMPLES or few,
        derandomize=not EXAMPLES,
        deadline=None,
        database=None,
        suppress_health_check=list(HealthCheck),
    )


def corpus(kind: str) -> list[Path]:
    """Return the files of a kind: a folder of the corpus."""
    found = sorted(path for path in (CORPUS / kind).iterdir() if path.is_file())
    assert found, f"the corpus has nothing of the kind {kind}"
    return found


def contents(kind: str) -> list[bytes]:
    """Return what is in the files of a kind."""
    return [path.read_bytes() for path in corpus(kind)]


_Edit = tuple[str, float, float, bytes]
_EDITS = st.lists(
    st.tuples(
        st.sampled_from(("put", "replace", "drop", "twice", "end", "flip")),
        st.floats(0.0, 1.0, exclude_max=True),
        st.floats(0.0, 1.0, exclude_max=True),
        st.sampled_from(_NASTY) | st.binary(max_size=4),
    ),
    min_size=0,
    max_size=5,
)


def spoilt(whole: Sequence[bytes]) -> st.SearchStrategy[bytes]:
    """Return a strategy of contents of files with a few places spoilt, or of noise."""
    return st.builds(_edited, st.sampled_from(whole), _EDITS) | st.binary(max_size=60)


def _edited(content: bytes, edits: Sequence[_Edit]) -> bytes:
    for kind, where, length, text in edits:
        at = int(where * (len(content) + 1))
        end = min(at + 1 + int(length**3 * len(content)), len(content))
        match kind:
            case "put":
                content = content[:at] + text + content[at:]
            case "replace":
                content = content[:at] + text + content[min(at + max(len(text), 1), len(content)) :]
            case "drop":
                content = content[:at] + content[end:]
            case "twice":
                content = content[:end] + content[at:end] + content[end:]
            case "end":
                content = content[:at]
            case _:
                content = (
                    content[:at] + bytes(b ^ 1 << int(8 * length) for b in content[at : at + 1]) + content[at + 1 :]
                )
    return content


def refusal(read: Callable[[], object]) -> str | None:
    """Return why something was not read, None where it was; other errors than ours are not caught."""
    try:
        read()
    except MorphError as error:
        return str(error)
    return None


def as_text(content: bytes) -> str:
    """Return content as the text that a lenient reader would hand on."""
    return content.decode("utf-8", "replace")


def values(words: Sequence[str]) -> st.SearchStrategy[Any]:
    """Return a strategy of plain data, as JSON has it, in which some words stand for keys and texts."""
    text = st.sampled_from([*words, "", "../x", "{action}", "\x00", "😀"]) | st.text(max_size=4)
    leaves = st.none() | st.booleans() | st.integers() | st.floats() | text
    return st.recursive(
        leaves, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(text, inner, max_size=5), max_leaves=12
    )


def scratch() -> Path:
    """Return a folder for files that are read, one for each process."""
    if not _folder:
        _folder.append(tempfile.TemporaryDirectory(prefix="fuzz_"))
    return Path(_folder[0].name)


_folder: list[tempfile.TemporaryDirectory[str]] = []
