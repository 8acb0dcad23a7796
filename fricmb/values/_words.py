"""Numbers with the words that they count."""

from __future__ import annotations


def counted(number: int, word: str, words: str = "") -> str:
    """"1 contact", "2 contacts"; ``words``: the plural, where it is not the word and an s."""
    return f"{number} {word if number == 1 else words or f'{word}s'}"
