"""Episodes of teams of robots: they are played, recorded and played again as those of one robot are."""
