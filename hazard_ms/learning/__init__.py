"""Training of policies over options in the sketch. Nothing here scores an agent."""
