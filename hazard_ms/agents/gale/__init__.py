"""Agents in a wind that turns: their knowledge and beliefs of it, and the places where it leaves things alone."""
