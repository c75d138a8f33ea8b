//! Readers and writers of scenes, meshes and pictures.
