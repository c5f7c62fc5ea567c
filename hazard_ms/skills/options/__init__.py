"""Skills as learners use them: numbered options with masks, features of what is known, a gymnasium environment."""
