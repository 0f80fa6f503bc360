"""The simulation methods: one module each, one signature, one trajectory."""
