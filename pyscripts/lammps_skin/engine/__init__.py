"""LAMMPS, in this process or on several MPI ranks."""
