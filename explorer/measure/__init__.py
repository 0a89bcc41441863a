"""How likely a state is to come near flat: densities, tubes near F, the constant C, and its tests."""
