"""The fire of the preset `realistic`: heat release, radiation, ignition, a smoke layer and what people can bear."""
