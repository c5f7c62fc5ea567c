"""Categories that stand in the original benchmark's scenes and in none of ours: rows of the catalogue, in its format.

HAZARD publishes no value and no resistance to fire and water for them (they are never targets): the low value, and the
properties of their usual material, are ours. Ignition temperatures are the commonest of the category's models.
"""

OBJECTS = (
    # name, HAZARD's name, high value, flammable, waterproof, ignition C, density kg/m3, drag, wind resistance, sources
    ("beverage", "beverage", 0, 0, 1, 100, 700, 0.74, 0, "OOOTMDO"),
    ("bread", "bread", 0, 1, 0, 100, 300, 0.82, 0, "OOOTMDO"),
    ("carving_fork", "carving fork", 0, 0, 1, 1000, 3000, 0.82, 0, "OOOTMDO"),
    ("coaster", "coaster", 0, 1, 1, 1000, 600, 1.17, 0, "OOOTMDO"),
    ("coin", "coin", 0, 0, 1, 1000, 8000, 1.17, 0, "OOOTMDO"),
    ("fork", "fork", 0, 0, 1, 1000, 3000, 0.82, 0, "OOOTMDO"),
    ("jar", "jar", 0, 0, 1, 1000, 900, 0.74, 0, "OOOTMDO"),
    ("jug", "jug", 0, 0, 1, 200, 500, 0.74, 0, "OOOTMDO"),
    ("kitchen_utensil", "kitchen utensil", 0, 1, 1, 500, 700, 0.82, 0, "OOOTMDO"),
    ("pepper_mill", "pepper mill, pepper grinder", 0, 1, 1, 500, 700, 0.74, 0, "OOOTMDO"),
    ("pot", "pot", 0, 0, 1, 3000, 400, 0.82, 2, "OOOTMDO"),
    ("saltshaker", "saltshaker, salt shaker", 0, 0, 1, 500, 1200, 0.74, 0, "OOOTMDO"),
    ("soap_dispenser", "soap dispenser", 0, 0, 1, 200, 800, 0.74, 0, "OOOTMDO"),
    ("spoon", "spoon", 0, 0, 1, 500, 3000, 0.82, 0, "OOOTMDO"),
    ("teakettle", "teakettle", 0, 0, 1, 500, 300, 0.82, 2, "OOOTMDO"),
    ("toaster", "toaster", 0, 0, 0, 2000, 300, 1.05, 3, "OOOTMDO"),
)

FIXTURES = (
    ("bookshelf", "bookshelf", 0, 1, 1, 200, 100, 1.05, 11, "OOOTMDO"),
    ("dining_table", "dining table", 0, 1, 1, 300, 80, 1.17, 11, "OOOTMDO"),
    ("dishwasher", "dishwasher", 0, 0, 0, 2000, 250, 1.05, 11, "OOOTMDO"),
    ("microwave_oven", "microwave, microwave oven", 0, 0, 0, 2000, 350, 1.05, 11, "OOOTMDO"),
    ("framed_picture", "picture", 0, 1, 0, 200, 300, 1.17, 11, "OOOTMDO"),
    ("radiator", "radiator", 0, 0, 1, 3000, 1000, 1.05, 11, "OOOTMDO"),
    ("water_faucet", "water faucet", 0, 0, 1, 400, 3000, 0.82, 11, "OOOTMDO"),
)
