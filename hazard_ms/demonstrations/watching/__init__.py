"""Watchers that take an episode down while it is played, and the labels that they give it."""
