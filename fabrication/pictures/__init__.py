"""Pictures drawn without a display: the preview with its close-up, and movements in color."""
