"""Rescues without a simulator: for planning, training and analysis; it never scores an agent."""
