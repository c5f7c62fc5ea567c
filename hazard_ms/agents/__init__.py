"""Agents: the contract, the registry, and the baselines of the paper."""
