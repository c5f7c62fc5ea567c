"""The machine below: drivers, renderers and the cache folder, and a diagnosis where something does not start."""
