//! A bounding volume hierarchy: which triangle, or which box, does a ray meet first?
