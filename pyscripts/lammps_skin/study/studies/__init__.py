"""Studies: a scene, what is varied of it, and seeds; from a question to an answer."""
