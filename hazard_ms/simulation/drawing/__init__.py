"""Drawing apart from the bodies of scenes: lights, boxes with textures, and the view of films."""
