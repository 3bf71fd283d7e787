"""A run as one page for a browser, and a run as it is watched."""
