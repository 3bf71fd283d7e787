"""Conditions side by side: runs, ensembles and points of studies."""
