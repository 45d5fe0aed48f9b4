"""The job of a product: parts made, checked and written."""
