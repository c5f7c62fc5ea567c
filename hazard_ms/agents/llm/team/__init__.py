"""The part of language models that teams add: the radio as a model is told of it, and a rule in its place."""
