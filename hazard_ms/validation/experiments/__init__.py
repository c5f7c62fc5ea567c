"""Experiments that validation cases run: rooms, tanks and yards, and correlations that tell what they must give."""
