"""The flood of the preset `realistic`: shallow water on the floor's grid."""
