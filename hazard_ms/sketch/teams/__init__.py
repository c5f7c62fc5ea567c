"""Rescues by teams of robots in the sketch: their clocks, their policies, and plans that divide the work."""
