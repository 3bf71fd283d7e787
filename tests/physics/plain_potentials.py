"""Scalar potentials, written out once more for the tests of the numpy model."""


def plain_phi(x: float) -> float:
    """Return phi of a plain number."""
    return 1 / (12 * x**12) - 1 / (6 * x**6)


def table_dermis_dermis(x: float) -> float:
    """Return the dermal potential as the table prints it."""
    if x < 0.8:
        return 0.0625 * (x - 1) ** 2 + plain_phi(x + 0.2) - plain_phi(1.4)
    if x < 1:
        return 0.0625 * (x - 1) ** 2 + plain_phi(1) - plain_phi(1.4)
    return plain_phi(x) - plain_phi(1.4) if x < 1.4 else 0.0
