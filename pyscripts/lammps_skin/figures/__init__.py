"""Pictures of runs and curves of ensembles: one figure, one file."""
