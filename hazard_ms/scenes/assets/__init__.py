"""Models and textures: the index of what is shipped, the user's own, and how models are taken in."""
