"""What was found, for people and programs: findings, fits, curves, tables, words."""
