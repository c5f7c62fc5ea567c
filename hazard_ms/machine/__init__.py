"""The machine below: drivers, renderers and processes, and a diagnosis where something does not start."""
