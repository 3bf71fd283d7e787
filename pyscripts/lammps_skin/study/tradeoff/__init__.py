"""What a choice of numerics costs and what it changes: measured for a grid of choices."""
