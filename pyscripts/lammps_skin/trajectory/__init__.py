"""Trajectories with births and deaths: the dump of a run, HDF5, MDAnalysis."""
