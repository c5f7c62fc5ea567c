"""What a language model that directs one robot of a team is told of the others, and a rule in its place."""
