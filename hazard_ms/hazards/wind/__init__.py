"""Wind: air that pushes and turns what stands in it, gusts, and shelter behind things."""
