"""What is simulated: the potentials, the parameter sets, the scene and its numerics."""
