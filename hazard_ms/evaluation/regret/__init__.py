"""Regret: the value that each decision of an episode gave away, and why."""
