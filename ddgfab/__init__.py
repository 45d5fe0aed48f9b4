"""ddgfab: discrete parametric surfaces, numpy and scipy only."""
