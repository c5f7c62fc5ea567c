"""Scores, results, videos and pages of episodes."""
