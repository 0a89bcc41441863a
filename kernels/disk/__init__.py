"""The disk and what is known of its motion without a method: field, constants, the falling set."""
