"""Pictures of a frame of an episode, rasterised or ray-traced: `hazard-ms render` and `hazard-ms gallery`."""
