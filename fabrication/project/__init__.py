"""What the project files of both products share: reading TOML, strict sections, error messages."""
