"""The things that mitigation acts on: tools and their charge, and doors that turn."""
