"""Ray-traced pictures and cameras: flames, smoke, water and leaves in a ray's way, and the denoiser."""
