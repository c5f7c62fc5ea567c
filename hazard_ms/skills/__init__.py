"""What an agent can do: skills are generators that yield low-level actions until they are done, and return a Result."""
