"""What a step has missed between its stages: laws, loads and elements that bend, jump or turn."""
