"""The town that surrounds a place in the open. It is only seen: it has no collision, no labels and no depth."""
