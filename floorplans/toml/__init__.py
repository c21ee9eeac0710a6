"""The TOML text of a plan: tables and values read with their place, and written canonically."""
