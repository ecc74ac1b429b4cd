"""A soak: many random operations on random characters, after each of which nothing may be wrong.

``python -m tools.soak --operations 10000 --seed 1``
"""
