"""Typed model to Dha, Dha to Mld."""
