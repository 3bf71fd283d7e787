"""Epidermal stem cells on a deformable basement membrane and dermis, on stock LAMMPS."""
