"""Skills of agents: generators that yield low-level actions until they are done, and return a Result."""
