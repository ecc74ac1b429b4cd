"""Releases: version and changelog, the extensions platform's rules, and trying the built zip in an empty profile."""


class ReleaseError(Exception):
    """Something is not fit to be released; its text says what, and what to do."""
