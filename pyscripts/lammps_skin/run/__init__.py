"""One run from begin to end: driven, checkpointed, interrupted, resumed."""
