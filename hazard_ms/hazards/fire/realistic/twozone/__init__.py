"""The two zones of the realistic fire: smoke, openings, and heat in walls."""
