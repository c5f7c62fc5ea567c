"""The things that mitigation acts on: tools and their charge, doors that turn; and grips on doors and carts."""
