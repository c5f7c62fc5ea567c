"""What an agent averts: value lost at the end with and without it, and the loads that it bears meanwhile."""
