"""The shader pack that draws effects, made from SAPIEN's own, and the GLSL that is put into it."""
