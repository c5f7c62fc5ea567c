"""Agents whose choices were learned: the policy, its file, and the agent that asks it."""
