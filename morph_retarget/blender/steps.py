"""Long work in steps: generators that yield the share done and return what they made."""

from collections.abc import Generator
from typing import TypeVar

_T = TypeVar("_T")


def within(low: float, high: float, steps: Generator[float, None, _T]) -> Generator[float, None, _T]:
    """Run steps as a part of others, from one share done to another, and return what they return."""
    while True:
        try:
            share = next(steps)
        except StopIteration as end:
            return end.value
        yield low + share * (high - low)


def run(steps: Generator[float, None, _T]) -> _T:
    """Run a stepped function to its end and return what it returns."""
    while True:
        try:
            next(steps)
        except StopIteration as done:
            return done.value
