"""Observables as pure functions of arrays: one family, one file.

Lengths and times are the reduced units of the model, heights are z. Positions may be wrapped or
not: x and y are periodic with the sides of the box, z is open.
"""
