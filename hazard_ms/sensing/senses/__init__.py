"""Sensors in the hazard: what a thermal camera shows, and what smoke, rain and water leave of colour and depth."""
