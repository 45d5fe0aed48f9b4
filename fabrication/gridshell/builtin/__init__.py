"""The built-in example as a project file."""
