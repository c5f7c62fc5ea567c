"""Agents compared over folders of results: scores with intervals, differences, regret, curves, one page."""
