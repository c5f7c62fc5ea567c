"""Fire: flames that spread over floor and things, heat, smoke; as the benchmark has it, and as engineers know it."""
