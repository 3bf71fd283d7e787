"""Many runs: ensembles, what runs cost, and how their numerics compare."""
