"""Plans of rescues: the exact programme, bounds on what any plan can reach, and tree search. Nothing is simulated."""
