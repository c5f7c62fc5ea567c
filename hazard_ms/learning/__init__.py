"""Training of policies in the sketch, and many environments at once for learners. Nothing here scores an agent."""
