"""Gear shifts of a brake-impulse shift transmission: its plant, its controllers, and the supervisor above them."""
