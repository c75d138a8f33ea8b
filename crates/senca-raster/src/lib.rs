//! Tiled and scan-line rasterizers.
