"""How likely a state is to come near flat: densities, tubes beside F, the constant C, and its tests."""
