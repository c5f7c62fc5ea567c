"""The part of a prompt that tasks with mitigations add: rooms, doors, tools, what is hot, and what rises."""
