"""The largest timesteps of a scene: found by bisection, and estimated from its Hessian."""
