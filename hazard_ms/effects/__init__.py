"""The looks of hazards: pictures only. Nothing here changes physics, chance or labels."""
