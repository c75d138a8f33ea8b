//! Scene, meshes, shapes, materials, lights, cameras, animation.
