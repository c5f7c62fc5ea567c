"""Agents of teams whose robots divide the work: by auctions, and by plans that are made together."""
