"""Answers of the analyses in the words of the source."""
