"""The page of `hazard-ms serve`: rescues to play, to watch and to compare, for a browser on this machine."""
