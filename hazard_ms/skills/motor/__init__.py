"""Skills of the body: finding a way, walking, reaching, grasping, putting away."""
