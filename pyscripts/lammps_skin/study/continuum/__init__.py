"""The paper's continuum equation beside runs: its terms, measured, and its solutions."""
