"""From a scene to a configuration to the files that LAMMPS reads."""
