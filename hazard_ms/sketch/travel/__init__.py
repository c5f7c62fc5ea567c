"""The shortest ways over the floor of a scene, and how many frames a robot takes to drive them."""
