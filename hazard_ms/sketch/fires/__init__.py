"""Fires in the sketch that robots can put out: what each would do alone, what is seen of it, and what is averted."""
