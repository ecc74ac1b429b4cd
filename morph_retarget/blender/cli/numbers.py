"""Numbers on the command line, as argparse reads them."""

import argparse


def frames(text: str) -> tuple[int, int]:
    """Return the first and last frame of a range such as 1:240."""
    first, _, last = text.partition(":")
    try:
        found = int(first), int(last)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no range: write it as 1:240") from None
    if found[0] > found[1]:
        raise argparse.ArgumentTypeError(f"{text!r} ends before it starts: write it as 1:240")
    return found


def share(text: str) -> float:
    """Return a number from 0 to 1."""
    value = _number(text)
    if not 0.0 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"{text!r} is no share: use a number from 0 to 1")
    return value


def within(text: str, least: float, most: float) -> float:
    """Return a number from ``least`` to ``most``."""
    value = _number(text)
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"{text!r} is too small or too large: use a number from {least:g} to {most:g}")
    return value


def above_zero(text: str) -> float:
    """Return a number above zero that is not absurdly large."""
    value = _number(text)
    if not 0.0 < value < 32767.0:
        raise argparse.ArgumentTypeError(f"{text!r} is too small or too large: use a number above 0")
    return value


def from_zero(text: str) -> float:
    """Return a number that is not below zero."""
    return within(text, 0.0, 1e9)


def count(text: str) -> int:
    """Return a whole number above zero."""
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of things: use a whole number above 0")
    return int(text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from None
