"""The six actions of the original's learner, and its map, in the sketch."""
