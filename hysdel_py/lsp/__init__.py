"""What editors ask about a model, and a server that answers them by the language server protocol."""
