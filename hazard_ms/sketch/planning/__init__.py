"""Plans of rescues: an exact search, bounds on what any plan can reach, and tree search. Nothing is simulated."""
