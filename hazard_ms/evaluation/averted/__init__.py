"""The value that an agent keeps from being lost, and the loads that its robot bears meanwhile."""
