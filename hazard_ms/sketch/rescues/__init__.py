"""N rescues at once: their scenes, their state, and what the robot sees, can choose and can reach."""
