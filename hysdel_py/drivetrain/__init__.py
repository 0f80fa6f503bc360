"""Drivetrains with dry friction: components, friction laws, equations of motion, and schemes that simulate them."""
